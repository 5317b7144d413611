"""Branches of core, portable hal and firmware/controller in GCC's counters below a folder: toolchain/branches.py FOLDER."""
import collections
import json
import pathlib
import subprocess
import sys

ROOMS = ("core/", "hal/", "firmware/controller/")
NOT_PORTABLE = ("hal/linux/", "hal/r5f/", "hal/simulated/")


def taken_branches(folder):
    """(file, line, which of the line's) -> how often any program took it."""
    root = pathlib.Path.cwd()
    counts = collections.Counter()
    for counters in sorted(folder.rglob("*.gcda")):
        # A header of another room is counted with that room's own sources.
        own = next(room for room in ROOMS if str(counters.relative_to(folder)).startswith(room))
        told = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", counters.name],
                              cwd=counters.parent, capture_output=True, check=True).stdout
        for document in told.splitlines():
            found = json.loads(document)
            where = pathlib.Path(found["current_working_directory"])
            for file in found["files"]:
                path = (where / file["file"]).resolve()
                if not path.is_relative_to(root):
                    continue
                name = str(path.relative_to(root))
                if not name.startswith(own) or name.startswith(NOT_PORTABLE):
                    continue
                for line in file["lines"]:
                    for index, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            counts[name, line["line_number"], index] += branch["count"]
    return counts


def main():
    sums = collections.defaultdict(lambda: [0, 0])
    untaken = collections.defaultdict(int)
    texts = {}
    for (path, line, _), count in taken_branches(pathlib.Path(sys.argv[1])).items():
        texts.setdefault(path, pathlib.Path(path).read_text(encoding="utf-8").splitlines())
        # The way of a broken precondition ends the program.
        if texts[path][line - 1].lstrip().startswith("ARMSIG_CHECK"):
            continue
        room = next(room for room in ROOMS if path.startswith(room))
        for name in (path, "all of " + room):
            sums[name][0] += count > 0
            sums[name][1] += 1
        if count == 0:
            untaken[path, line] += 1
    for (path, line), ways in sorted(untaken.items()):
        print(f"{path}:{line}: {ways} never taken: {texts[path][line - 1].strip()}")
    for name in sorted(sums, key=lambda name: (name.startswith("all"), name)):
        taken, of = sums[name]
        print(f"{taken:5} of {of:5}  {100 * taken / of:5.1f} %  {name}")


if __name__ == "__main__":
    main()
