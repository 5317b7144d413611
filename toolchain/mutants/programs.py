# SPDX-License-Identifier: MIT
"""The tests of a build: which there are, which mutants each passes, and whether they notice one."""
import os
import resource
import subprocess
import time

MEMORY_BYTES = 4 << 30


class Case:
    def __init__(self, program, name):
        self.program, self.name, self.seconds, self.reached, self.passed = program, name, 0.0, set(), False


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(command, seconds, **environment):
    """Whether it ended well within its time."""
    started = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
                               env=os.environ | environment, preexec_fn=limit, start_new_session=True)
    try:
        status = process.wait(seconds)
    except subprocess.TimeoutExpired:
        status = None
    if status is None:
        os.killpg(process.pid, 9)
        process.wait()
    return status == 0, time.monotonic() - started


def cases_of(program):
    listed = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
    suite, cases = "", []
    for line in listed.splitlines():
        name = line.split("#")[0].rstrip()
        if line.startswith("  "):
            cases.append(Case(program, suite + name.strip()))
        elif name.endswith("."):
            suite = name
    return [case for case in cases if "DISABLED_" not in case.name]


def measure(case, log, seconds):
    """What the case reaches and how long it takes while no mutant lives."""
    log.unlink(missing_ok=True)
    case.passed, case.seconds = run([case.program, "--gtest_filter=" + case.name], seconds, ARMSIG_MUTANTS_REACHED=str(log))
    if case.passed and log.exists():
        case.reached = {int(line) for line in log.read_text().split()}


def killed_by(number, cases, budget):
    """The test program that notices the mutant, "time" where it hangs, nothing where all that reach it pass. The quickest
    cases first, until they have taken the budget."""
    groups, spent = {}, 0.0
    for case in sorted(cases, key=lambda case: case.seconds):
        if spent + case.seconds > budget and groups:
            break
        spent += case.seconds
        groups.setdefault(case.program, []).append(case)
    for program, group in sorted(groups.items(), key=lambda item: sum(case.seconds for case in item[1])):
        allowed = 10 + 5 * sum(case.seconds for case in group)
        chosen = ":".join(case.name for case in group)
        well, took = run([program, "--gtest_filter=" + chosen, "--gtest_fail_fast"], allowed, ARMSIG_MUTANT=str(number))
        if not well:
            return "time" if took >= allowed else os.path.basename(program)
    return None
