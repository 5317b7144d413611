# SPDX-License-Identifier: MIT
"""toolchain/mutate: see there."""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import pickle
import re
import subprocess
import sys

import programs
import schemata
import sites
import source

ROOT = pathlib.Path("build/mutants/source")
BUILD = ROOT / "build/dev"
KILLED = pathlib.Path("build/mutants/killed.json")
SITES = pathlib.Path("build/mutants/sites")
JOBS = int(os.environ.get("ARMSIG_JOBS", "2"))
EQUIVALENT = pathlib.Path("host_tests/mutants/equivalent.txt")
# Each room with the folders of host_tests that are its tests.
ROOMS = {"firmware/controller": ("controller", "unit_daemon"), "hal": ("unit_hal", "transcript", "controller"),
         **dict.fromkeys(("core", "firmware/analysis"), ("unit", "property"))}
NOT_PORTABLE = ("hal/linux/", "hal/r5f/", "hal/simulated/")
# Tests of this machine's clock.
LEFT_OUT = ("soak_test", "servo_time_test")
# Of the folders of which not all is built.
PROGRAMS = {"unit_daemon": ("daemon_configuration_test", "attendance_test")}
BUDGET_S = 60
ROUNDS = 12


def listed(*paths):
    return subprocess.run(["git", "ls-files", *paths], check=True, capture_output=True, text=True).stdout.split()


def write(path, text):
    """Only what is new, so that the next build is short."""
    if not path.exists() or path.read_bytes() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text)


def read_once(room, texts):
    """The sites of a room, kept: clang takes a minute for them."""
    read = hashlib.sha256(repr(sorted(texts.items())).encode())
    for module in (sites, source):
        read.update(pathlib.Path(module.__file__).read_bytes())
    kept = SITES / read.hexdigest()
    if not kept.exists():
        found = sites.find(room, sorted(texts))
        SITES.mkdir(parents=True, exist_ok=True)
        kept.write_bytes(pickle.dumps(found))
    return pickle.loads(kept.read_bytes())


def sites_of(files):
    found = {}
    for room in ROOMS:
        paths = [path for path in listed(room) if path.endswith((".cpp", ".hpp")) and not path.startswith(NOT_PORTABLE)]
        wanted = [path for path in paths if not files or any(path.startswith(name) for name in files)]
        if wanted:
            texts = {path: pathlib.Path(path).read_bytes() for path in wanted}
            found[room] = [site for site in read_once(room, texts) if schemata.can_be_written(site, texts[site.path])]
    return found


def write_sources(mutants):
    by_path = collections.defaultdict(list)
    for mutant in mutants:
        by_path[mutant.site.path].append(mutant)
    for path in listed():
        text = pathlib.Path(path)
        if text.is_file():
            write(ROOT / path, schemata.mutated(path, by_path[path]).encode() if path in by_path else text.read_bytes())
    write(ROOT / "core/mutant.hpp", pathlib.Path("toolchain/mutants/mutant.hpp").read_bytes())
    shared = ROOT.parent / "shared"
    if not shared.exists() and pathlib.Path("../shared").exists():
        shared.symlink_to(pathlib.Path("../shared").resolve())


def build(targets):
    """What the compiler said where it failed."""
    # Clang stops at the twentieth mutant that it refuses, unless told.
    settings = ["-DCMAKE_BUILD_TYPE=Release", "-DARMSIG_UNITY=ON", "-DCMAKE_CXX_COMPILER=clang++-19",
                "-DCMAKE_CXX_FLAGS=-ferror-limit=0"]
    configured = subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", *settings], capture_output=True, text=True)
    if configured.returncode:
        raise SystemExit(configured.stdout + configured.stderr)
    done = subprocess.run(["ninja", "-C", BUILD, "-k0", "-j", str(JOBS), *targets], capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stdout


def without_refused(mutants, said):
    """The mutants but those in whose lines the compiler found an error: constants of the compiler, mostly."""
    refused = set()
    for path, line in re.findall(r"(\S+?):(\d+):\d+: (?:error|note):", said):
        name = re.sub(r"^.*?((?:core|hal|firmware)/)", r"\1", path)
        refused.add((name, int(line)))
    kept = []
    for mutant in mutants:
        last = mutant.site.line + mutant.site.lines - 1
        if not any((mutant.site.path, line) in refused for line in range(mutant.site.line, last + 1)):
            kept.append(mutant)
    if len(kept) == len(mutants):
        raise SystemExit("mutate: the build failed, and not by a mutant:\n" + said[-4000:])
    return kept


def built(mutants, folders):
    libraries = [room + "/all" for room in ROOMS if any(mutant.site.path.startswith(room) for mutant in mutants)]
    tests = [target for folder in folders for target in PROGRAMS.get(folder, (f"host_tests/{folder}/all",))]
    for targets in (libraries, tests):
        for _ in range(ROUNDS):
            write_sources(mutants)
            said = build(targets)
            if not said:
                break
            mutants = without_refused(mutants, said)
        else:
            raise SystemExit("mutate: the mutants do not compile")
    return mutants


def known_equivalents():
    known = {}
    for line in EQUIVALENT.read_text().splitlines():
        if line and not line.startswith("#"):
            path, text, what, reason = line.split(" | ")
            known[path, text, what] = reason
    return known


def measured(folders):
    cases = []
    for folder in folders:
        for program in sorted((BUILD / "host_tests" / folder).glob("*_test")):
            if program.name not in LEFT_OUT:
                cases += programs.cases_of(str(program.resolve()))
    log = (BUILD / "reached.txt").resolve()
    for case in cases:
        programs.measure(case, log, BUDGET_S)
    for case in cases:
        if not case.passed:
            print(f"not used, it fails or takes too long without a mutant: {case.name}")
    return [case for case in cases if case.passed]


def judge(mutants, cases, before):
    """Who kills each mutant, or nobody; before: what the time before told."""
    def verdict(mutant):
        reaching = [case for case in cases if mutant.number in case.reached]
        killer = before.get(" | ".join(mutant.key())) or programs.killed_by(mutant.number, reaching, BUDGET_S)
        print(f"killed: {mutant}" if killer else f"survived ({len(reaching)} tests): {mutant}", flush=True)
        return killer
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        return dict(zip(mutants, pool.map(verdict, mutants)))


def report(verdicts):
    equivalents = known_equivalents()
    by_path = collections.defaultdict(lambda: [0, 0, 0])
    for mutant, killer in verdicts.items():
        column = 0 if killer else 1 if mutant.key() in equivalents else 2
        for name in (mutant.site.path, "all of " + next(room for room in ROOMS if mutant.site.path.startswith(room)), "all"):
            by_path[name][column] += 1
    print(f"\n{'killed':>7} {'same':>5} {'lived':>6}  file")
    for name in sorted(by_path, key=lambda name: (name.startswith("all"), name)):
        print("{:7} {:5} {:6}  {}".format(*by_path[name], name))
    print()
    for mutant, killer in verdicts.items():
        if not killer:
            print(f"{'the same program' if mutant.key() in equivalents else 'SURVIVED'}: {mutant} | {mutant.site.source_line}")
    killed, same, lived = by_path["all"]
    return killed / max(killed + lived, 1)


def main():
    parser = argparse.ArgumentParser(prog="toolchain/mutate")
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--tests", nargs="+", help="folders of host_tests, instead of all of the rooms that were drawn from")
    parser.add_argument("--again", action="store_true", help="only what survived the time before; for use while tests are written")
    asked = parser.parse_args()
    found = sites_of(asked.files)
    folders = asked.tests or sorted({folder for room in found for folder in ROOMS[room]})
    mutants = built(schemata.sample(found, asked.count, asked.seed), folders)
    print(f"{len(mutants)} mutants of {sum(len(of) for of in found.values())} sites", flush=True)
    cases = measured(folders)
    before = json.loads(KILLED.read_text()) if asked.again and KILLED.exists() else {}
    verdicts = judge(mutants, cases, before)
    killed = {" | ".join(mutant.key()): killer for mutant, killer in verdicts.items() if killer}
    KILLED.write_text(json.dumps(before | killed, indent=1))
    share = report(verdicts)
    print(f"{share:.1%} killed")
    return 0 if share >= 0.9 else 1


if __name__ == "__main__":
    sys.exit(main())
