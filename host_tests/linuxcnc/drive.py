# SPDX-License-Identifier: MIT
"""The last program of a LinuxCNC session: homes the arm, moves it as plan.json says, and keeps what
the joints were commanded to at every servo period.

drive.py PLAN.json RESULT.json
"""
import json
import subprocess
import sys
import time

import linuxcnc

LONGEST_S = 60  # a starved host takes its time


class Session:
    def __init__(self):
        self.stat, self.command, self.errors = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
        self.said = []

    def listen(self):
        while True:
            error = self.errors.poll()
            if not error:
                return
            self.said.append(error[1])

    def until(self, condition, what):
        end = time.monotonic() + LONGEST_S
        while time.monotonic() < end:
            self.stat.poll()
            self.listen()
            if condition(self.stat):
                return
            time.sleep(0.01)
        raise TimeoutError(what)

    def begin(self):
        self.command.state(linuxcnc.STATE_ESTOP_RESET)
        self.until(lambda s: s.task_state == linuxcnc.STATE_ESTOP_RESET, "reset of the emergency stop")
        self.command.state(linuxcnc.STATE_ON)
        self.until(lambda s: s.task_state == linuxcnc.STATE_ON, "power")
        self.command.mode(linuxcnc.MODE_MANUAL)
        self.command.wait_complete()
        self.command.teleop_enable(0)
        self.command.wait_complete()
        self.command.home(-1)
        self.until(lambda s: all(s.homed[:6]), "homing")
        self.command.mode(linuxcnc.MODE_MDI)
        self.until(lambda s: s.task_mode == linuxcnc.MODE_MDI, "mode MDI")

    def where(self):
        self.stat.poll()
        return {"joints_deg": self.stat.joint_position[:6], "world": self.stat.position[:6]}

    def mdi(self, text):
        """Whether LinuxCNC did it and is still on."""
        self.command.mdi(text)
        done = self.command.wait_complete(LONGEST_S)
        self.stat.poll()
        self.listen()
        if done == linuxcnc.RCS_DONE and self.stat.task_state == linuxcnc.STATE_ON:
            return True
        self.said.append(f"{text}: completed with {done}, task state {self.stat.task_state}, mode {self.stat.task_mode}, "
                         f"interpreter {self.stat.interp_state}")
        return False


def sampled(session, text):
    """Moves, and gives what the joints were commanded to meanwhile."""
    with open("samples", "w+") as file:
        sampler = subprocess.Popen(["stdbuf", "-oL", "halsampler"], stdout=file)
        subprocess.run(["halcmd", "setp", "sampler.0.enable", "1"], check=True)
        done = session.mdi(text)
        subprocess.run(["halcmd", "setp", "sampler.0.enable", "0"], check=True)
        time.sleep(0.2)
        sampler.terminate()
        sampler.wait()
        file.seek(0)
        rows = [line.split() for line in file]
    return done, [[float(word) for word in row] for row in rows if len(row) == 6]


def main():
    with open(sys.argv[1]) as file:
        plan = json.load(file)
    session = Session()
    result = {"ways": {}}
    try:
        session.begin()
        result["home"] = session.where()
        on = session.mdi("G21 G90 G61 G94")
        goto = "G1 X{:.9f} Y{:.9f} Z{:.9f} A{:.9f} B{:.9f} C{:.9f} F3000"
        for name, (start, end) in plan["ways"].items():
            on = on and session.mdi(plan["adaptive_feed"][name])
            way = result["ways"][name] = {"begun": on and session.mdi(goto.format(*start))}
            if not way["begun"]:
                break
            way["start"] = session.where()
            on, way["joints_deg"] = sampled(session, goto.format(*end))
            way["done"] = on
            way["end"] = session.where()
            if not on:
                break
    except TimeoutError as late:
        session.said.append(f"no {late} within {LONGEST_S} s")
    session.listen()
    result["said"] = session.said
    with open(sys.argv[2], "w") as file:
        json.dump(result, file)


main()
