# SPDX-License-Identifier: MIT
"""Where the arm was, by its signature, against where it was to be.

judge.py SIGNATURE.yaml FOLDER: prints a line a finding; ends with 0 where all is within 0.01 mm.
"""
import json
import pathlib
import sys

import numpy as np
from signature import Signature, of_abc, pose

MOST_MM = 0.01
MOST_DEG = 0.01  # of the orientation


def angle_deg(R):
    return np.degrees(np.arcsin(min(1, np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2)))


class Judge:
    def __init__(self, arm):
        self.arm = arm
        self.good = True

    def hold(self, what, mm, degrees, more=""):
        held = mm < MOST_MM and degrees < MOST_DEG
        self.good = self.good and held
        print(f"{'held' if held else 'MISSED'}: {what}: {mm:.6f} mm, {degrees:.6f} deg{more}")

    def refuse(self, what):
        self.good = False
        print(f"MISSED: {what}")

    def place(self, what, readings_deg, X):
        Y = self.arm.in_base(np.radians(readings_deg))
        self.hold(what, 1e3 * np.linalg.norm(Y[:3, 3] - X[:3, 3]), angle_deg(X[:3, :3].T @ Y[:3, :3]))

    def line(self, name, readings_deg, line):
        """Every sample of a move that went from end to end: how far it was off the line."""
        start, end = (X[:3, 3] for X in line)
        along = (end - start) / np.linalg.norm(end - start)
        aside, turned, ways, least = 0, 0, [], np.inf
        for row in readings_deg:
            X = self.arm.in_base(np.radians(row))
            ways.append(along @ (X[:3, 3] - start))
            aside = max(aside, 1e3 * np.linalg.norm(X[:3, 3] - start - ways[-1] * along))
            turned = max(turned, angle_deg(line[0][:3, :3].T @ X[:3, :3]))
        middle = readings_deg[int(np.argmin(np.abs(np.array(ways) - np.linalg.norm(end - start) / 2)))]
        least = np.linalg.svd(self.arm.jacobian(np.radians(middle)))[1][-1]
        fastest = np.abs(np.diff(readings_deg, axis=0)).max()
        if not (min(ways) < 1e-5 and max(ways) > np.linalg.norm(end - start) - 1e-5):
            self.refuse(f"line {name}: it was not sampled from end to end")
        self.hold(f"line {name}", aside, turned,
                  f"; {len(ways)} samples, joints {fastest:.2f} deg/ms at most, least singular value {least:.2g} midway")


def main():
    signature, folder = sys.argv[1:]
    folder = pathlib.Path(folder)
    plan = json.loads((folder / "plan.json").read_text())
    result = json.loads((folder / "result.json").read_text())
    judge = Judge(Signature(signature))
    if "home" not in result:
        judge.refuse("not homed")
    else:
        world = result["home"]["world"]
        before, after = np.array(plan["around"])
        judge.place("home, as LinuxCNC shows it", plan["home_deg"],
                    before @ pose(of_abc(world[3:]), 1e-3 * np.array(world[:3])) @ after)
    for name, line in plan["in_base"].items():
        line = [np.array(X) for X in line]
        way = result["ways"].get(name, {"begun": False})
        if not way["begun"]:
            judge.refuse(f"line {name}: LinuxCNC did not go to its start")
        elif not way["done"]:
            judge.refuse(f"line {name}: LinuxCNC did not come to its end")
        else:
            readings_deg = np.array(way["joints_deg"]) - plan["zero_deg"]
            judge.place(f"start of line {name}", readings_deg[0], line[0])
            judge.place(f"end of line {name}", readings_deg[-1], line[1])
            judge.line(name, readings_deg, line)
    for said in result["said"]:
        print(f"LinuxCNC said: {said}")
    sys.exit(0 if judge.good else 1)


main()
