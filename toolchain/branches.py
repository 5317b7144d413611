# SPDX-License-Identifier: MIT
"""Branches of a room in clang's counters: toolchain/branches.py ROOM PROFILE OBJECTS AND PROGRAMS; see toolchain/coverage."""
import collections
import json
import pathlib
import re
import subprocess
import sys

NOT_PORTABLE = ("hal/linux/", "hal/r5f/", "hal/simulated/")
LISTED = pathlib.Path("host_tests/coverage/untaken.txt")
WAYS = ("true", "false")

Place = collections.namedtuple("Place", "path line column end_line end_column")


class Source:
    def __init__(self):
        self.files = {}

    def line(self, place):
        if place.path not in self.files:
            self.files[place.path] = pathlib.Path(place.path).read_text(encoding="utf-8").splitlines()
        return self.files[place.path][place.line - 1]

    def text(self, place):
        """What stands there, to the end of its line."""
        line = self.line(place)
        return line[place.column - 1 : place.end_column - 1 if place.end_line == place.line else None].strip()

    def before(self, place):
        return self.line(place)[: place.column - 1]


def functions(profile, objects):
    done = subprocess.run(["llvm-cov-19", "export", f"-instr-profile={profile}", objects[0],
                           *(f"-object={name}" for name in objects[1:])], capture_output=True)
    # It warns of inline functions that an object does not use.
    if done.returncode:
        raise SystemExit(done.stderr.decode())
    return json.loads(done.stdout)["data"][0]["functions"]


def branches(function, room):
    """(place, what of a macro's text, taken as true, taken as false, whether it was reached): a branch within a macro
    stands where the macro is used."""
    used = {region[6]: region for region in function["regions"] if region[7] == 1}
    code = [region for region in function["regions"] if region[7] == 0]
    for branch in function["branches"]:
        start, end, file = tuple(branch[:2]), tuple(branch[2:4]), branch[6]
        # That of "a && b" as a whole, beside those of its parts: a matter of whether clang cleans up behind it.
        if any(file == other[6] and branch[:4] != other[:4] and start <= tuple(other[:2]) and tuple(other[2:4]) <= end
               for other in function["branches"]):
            continue
        around = [region for region in code if region[5] == file and tuple(region[:2]) <= start < tuple(region[2:4])]
        reached = max(around, key=lambda region: tuple(region[:2]))[4] if around else branch[4] + branch[5]
        place, within = branch[:4], ()
        while file in used:
            within += start
            place, file = used[file][:4], used[file][5]
        path = function["filenames"][file].removeprefix(str(pathlib.Path.cwd()) + "/")
        if path.startswith(room + "/") and not path.startswith(NOT_PORTABLE):
            yield Place(path, *place), within, branch[4], branch[5], reached > 0


def counted(found, room, source):
    """(place, within, way) -> how often it was taken, by any instance of a template."""
    counts = collections.Counter()
    for function in found:
        for place, within, *taken, reached in branches(function, room):
            before = source.before(place)
            # What the compiler decides has no counts though it is reached. A switch without default names every enumerator.
            if (reached and not any(taken)) or before.endswith(("if constexpr (", "switch (")):
                continue
            if "ARMSIG_CHECK" in before + source.text(place) or source.line(place).endswith("= default;"):
                continue
            is_case = re.match(r"(case\b|default:)", source.text(place))
            for way, count in zip(WAYS[:1] if is_case else WAYS, taken):
                counts[place, within, way] += count
    return counts


def listed():
    """What is known to be taken by no test: (file, line of the source, condition and way)."""
    lines = LISTED.read_text(encoding="utf-8").splitlines()
    return {tuple(line.split(" | ")[:3]) for line in lines if line and not line.startswith("#")}


def main():
    room, profile, *objects = sys.argv[1:]
    source = Source()
    sums = collections.defaultdict(lambda: [0, 0])
    untaken = {}
    for (place, _, way), count in sorted(counted(functions(profile, objects), room, source).items()):
        for name in (place.path, "all of " + room):
            sums[name][0] += count > 0
            sums[name][1] += 1
        if count == 0:
            key = (place.path, source.line(place).strip(), f"{source.text(place)} never {way}")
            untaken.setdefault(key, place.line)
    known = {key for key in listed() if key[0].startswith(room + "/")}
    for key, line in sorted(untaken.items(), key=lambda item: (item[0][0], item[1])):
        if key not in known:
            print(f"{key[0]}:{line}: {key[2]}: {key[1]}")
    for key in sorted(known - untaken.keys()):
        print(f"in {LISTED}, and taken or gone: {' | '.join(key)}")
    for name in sorted(sums, key=lambda name: (name.startswith("all"), name)):
        taken, of = sums[name]
        print(f"{taken:5} of {of:5}  {100 * taken / of:5.1f} %  {name}")


if __name__ == "__main__":
    main()
