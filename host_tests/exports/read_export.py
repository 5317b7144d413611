#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Evaluates an export with readers that are not ours and compares it with what armsig predicts.

read_export.py FORMAT EXPORT JOINTS.csv POSES.csv: prints the largest distance (m) and the largest
difference of the rotation matrices. The conventions are written here anew, from the documentation
of the software that reads each format.
"""
import math
import os
import re
import sys
import types

import numpy as np
import yaml

from export_text import comments_of, from_quaternion, rotation, rows_of, shift, stated_pose
from read_deflections import json_export, maps_csv


def couple(path, q):
    effective = list(q)
    for line in comments_of(path):
        found = re.fullmatch(r"effective reading of joint (\d) = reading \1 \+ (\S+) \* reading (\d)", line)
        if found:
            effective[int(found[1]) - 1] += float(found[2]) * q[int(found[3]) - 1]
    return effective


def rows_csv(path, link):
    rows = rows_of(path)
    base, tool = stated_pose(path, "base"), stated_pose(path, "tool")

    def pose(q):
        T = base
        for row, reading in zip(rows, couple(path, q), strict=True):
            theta, d = float(row["theta_rad"]), float(row["d_m"])
            if row["type"] == "revolute":
                theta += reading
            else:
                d += reading
            T = T @ link(row, theta, d)
        return T @ tool
    return pose


def dh_csv(path):
    return rows_csv(path, lambda row, theta, d: rotation("z", theta) @ shift(0, 0, d) @
                    shift(float(row["a_m"]), 0, 0) @ rotation("x", float(row["alpha_rad"])))


def mdh_csv(path):
    return rows_csv(path, lambda row, theta, d: rotation("x", float(row["alpha_prev_rad"])) @
                    shift(float(row["a_prev_m"]), 0, 0) @ rotation("z", theta) @ shift(0, 0, d))


def compensation(path):
    """What LinuxCNC adds to a joint's position: nominal less actual, between the lines of its table."""
    if not os.path.exists(path):
        return lambda joint: 0
    with open(path) as file:
        lines = [[float(word) for word in line.split()] for line in file]
    assert 2 <= len(lines) <= 256 and all(len(line) == 3 and line[1] == line[2] for line in lines)
    nominal = [line[0] for line in lines]
    assert nominal == sorted(nominal)
    return lambda joint: np.interp(joint, nominal, [line[0] - line[1] for line in lines])


def linuxcnc(path):
    """The forward function of genserkins: joints in degrees, `unrotate`, then Craig's rows."""
    pins = {}
    with open(path) as file:
        for line in file:
            if line.startswith("setp "):
                _, pin, value = line.split()
                pins[pin] = float(value)
    base, tool = stated_pose(path, "base"), stated_pose(path, "tool")
    tables = [compensation(f"{path}.joint-{i}.comp") for i in range(6)]

    def pose(q):
        angles = []
        for i, reading in enumerate(q):
            # fb-out = fb-in - offset
            motor = math.degrees(reading) - pins[f"joint-offset.{i}.offset"]
            joint = motor
            for _ in range(20):  # the joint that LinuxCNC sends the motor there for
                joint = motor - tables[i](joint)
            angles.append(math.radians(joint))
        # unrotate acts on the joints of genserkins, before their offsets are known to it
        for i in range(1, 6):
            angles[i] -= pins.get(f"genserkins.unrotate-{i}", 0) * angles[i - 1]
        T = base
        for i, angle in enumerate(angles):
            T = T @ rotation("x", pins[f"genserkins.ALPHA-{i}"]) @ \
                shift(pins[f"genserkins.A-{i}"] / 1e3, 0, 0) @ rotation("z", angle) @ \
                shift(0, 0, pins[f"genserkins.D-{i}"] / 1e3)
        return T @ tool
    return pose


def ur_yaml(path):
    with open(path) as file:
        links = yaml.safe_load(file)["kinematics"]
    assert re.fullmatch(r"calib_\w+", links["hash"])
    base = stated_pose(path, "base in the sensor frame")
    tool = stated_pose(path, "last link of armsig predict in wrist_3")

    def pose(q):
        T = base
        for name, reading in zip(("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"), q):
            link = links[name]
            T = T @ shift(link["x"], link["y"], link["z"]) @ rotation("z", link["yaw"]) @ \
                rotation("y", link["pitch"]) @ rotation("x", link["roll"]) @ rotation("z", reading)
        return T @ tool
    return pose


def rtb(path):
    """Runs the source against the real toolbox where it is installed, else against its conventions."""
    try:
        import roboticstoolbox  # noqa: F401
    except ImportError:
        toolbox, math3d = types.ModuleType("roboticstoolbox"), types.ModuleType("spatialmath")

        class Link:
            def __init__(self, kind, offset=0, a=0, alpha=0, d=0, theta=0, qlim=None):
                self.kind, self.offset, self.a, self.alpha, self.d, self.theta = kind, offset, a, alpha, d, theta
                assert qlim[0] < qlim[1]

            def A(self, q):
                theta, d = (q + self.offset, self.d) if self.kind == "R" else (self.theta, q + self.offset)
                return rotation("z", theta) @ shift(self.a, 0, 0) @ shift(0, 0, d) @ rotation("x", self.alpha)

        class DHRobot:
            def __init__(self, links, name, base, tool):
                self.links, self.base, self.tool = links, base, tool

            def fkine(self, q):
                T = self.base
                for link, reading in zip(self.links, q, strict=True):
                    T = T @ link.A(reading)
                return types.SimpleNamespace(A=T @ self.tool)
        toolbox.DHRobot = DHRobot
        toolbox.RevoluteDH = lambda **k: Link("R", **k)
        toolbox.PrismaticDH = lambda **k: Link("P", **k)
        math3d.SE3 = lambda T, check: T
        sys.modules.update(roboticstoolbox=toolbox, spatialmath=math3d)
    names = {}
    with open(path) as file:
        exec(compile(file.read(), path, "exec"), names)
    return lambda q: np.asarray(names["robot"].fkine(names["effective"](q)).A)


def readings(path):
    for row in rows_of(path):
        yield [math.radians(float(v)) if k.endswith("_deg") else float(v) / 1e3
               for k, v in sorted(row.items())]


def main():
    form, export, joints, poses = sys.argv[1:]
    pose = {"dh-csv": dh_csv, "mdh-csv": mdh_csv, "linuxcnc": linuxcnc, "ur-yaml": ur_yaml, "rtb": rtb,
            "json": json_export, "maps-csv": maps_csv}[form](export)
    distance = turn = 0
    for q, expected in zip(readings(joints), rows_of(poses), strict=True):
        difference = pose(q) - from_quaternion({k: float(v) for k, v in expected.items()})
        distance = max(distance, float(np.linalg.norm(difference[:3, 3])))
        turn = max(turn, float(np.abs(difference[:3, :3]).max()))
    print(f"{distance:.3g} {turn:.3g}")


main()
