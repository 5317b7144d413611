#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Evaluates an export with readers that are not ours and compares it with what armsig predicts.

read_export.py FORMAT EXPORT JOINTS.csv POSES.csv: prints the largest distance (m) and the largest
difference of the rotation matrices. The conventions are written here anew, from the documentation
of the software that reads each format.
"""
import csv
import json
import math
import os
import re
import sys
import types

import numpy as np
import yaml


def rotation(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    turn = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}
    T = np.eye(4)
    T[:3, :3] = turn[axis]
    return T


def shift(x, y, z):
    T = np.eye(4)
    T[:3, 3] = [x, y, z]
    return T


def from_quaternion(p):
    w, x, y, z = (p[k] for k in ("qw", "qx", "qy", "qz"))
    T = shift(p["x_m"], p["y_m"], p["z_m"])
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return T


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def comments_of(path):
    with open(path) as file:
        return [line[1:].strip() for line in file if line.startswith("#")]


def stated_pose(path, name):
    line = next(line for line in comments_of(path) if line.startswith(name + ":"))
    return from_quaternion({k: float(v) for k, v in
                            (item.split("=") for item in line.split(":")[1].strip().split(","))})


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


def spline(origin, per_unit, coefficients, reading):
    """Cubic B-splines by the recursion of de Boor and Cox, on the knots -3 ... 1 about the reading."""
    u = (reading - origin) * per_unit
    k, n = math.floor(u), len(coefficients)

    def basis(i, degree):
        if degree == 0:
            return 1.0 if i <= u - k < i + 1 else 0.0
        return ((u - k - i) * basis(i, degree - 1) + (i + degree + 1 - u + k) * basis(i + 1, degree - 1)) / degree
    return sum(coefficients[(k + j) % n] * basis(j - 3, 3) for j in range(4))


def sagging(drawing, joints, gravity, effective):
    """What gravity turns each joint by; the drawing stands upright."""
    T = np.eye(4)
    axes, origins = [], []
    for row, joint, q in zip(drawing, joints, effective, strict=True):
        axes.append(T[:3, 2].copy())
        origins.append(T[:3, 3].copy())
        turns = joint["type"] == "revolute"
        T = T @ rotation("z", row["theta_rad"] + (q if turns else 0)) @ \
            shift(0, 0, row["d_m"] + (0 if turns else q)) @ shift(row["a_m"], 0, 0) @ rotation("x", row["alpha_rad"])
    origins.append(T[:3, 3].copy())
    by = np.zeros(len(joints))
    for term in gravity:
        j = term["joint"] - 1
        if joints[j]["type"] == "revolute":
            lever = axes[j] @ np.cross(origins[term["link"]] - origins[j], [0, 0, -1])
        else:
            lever = axes[j] @ [0, 0, -1]
        by[j] += term["coefficient"] * lever
    return by


def couple_by(couplings, q):
    effective = list(q)
    for coupling in couplings:
        effective[coupling["joint"] - 1] += coupling["ratio"] * q[coupling["from"] - 1]
    return effective


def maps_csv(path):
    """The table says what the joints turn; the geometry is that of geometry.json beside it."""
    with open("geometry.json") as file:
        export = json.load(file)
    said = export["deflections"]
    for i, line in enumerate(line for line in comments_of(path) if line.startswith("drawing ")):
        said["drawing"][i] = {k: float(v) for k, v in
                              (item.split("=") for item in line.split(":")[1].strip().split(","))}
    at_rest = next(line for line in comments_of(path) if line.startswith("readings of the signature"))
    said["at_rest"] = [float(v) for v in at_rest.split(":")[1].split(",")]
    said["maps"] = [{"origin": 0, "knots_per_unit": 0, "coefficients": []} for _ in said["maps"]]
    said["gravity"] = []
    knots = {}
    for row in rows_of(path):
        joint = int(row["joint"])
        if row["kind"] == "gravity":
            said["gravity"].append({"joint": joint, "link": int(row["index"]),
                                    "coefficient": float(row["coefficient_rad_or_m"])})
        else:
            knots.setdefault(joint, []).append((float(row["reading_rad_or_m"]), float(row["coefficient_rad_or_m"]),
                                                float(row["value_rad_or_m"])))
    for joint, rows in knots.items():
        said["maps"][joint - 1] = {"origin": rows[0][0], "knots_per_unit": 1 / (rows[1][0] - rows[0][0]),
                                   "coefficients": [row[1] for row in rows]}
        for reading, _, value in rows:
            there = spline(rows[0][0], 1 / (rows[1][0] - rows[0][0]), [row[1] for row in rows], reading)
            assert abs(there - value) < 1e-9, (joint, reading, there, value)
    return pose_by(export)


def json_export(path):
    with open(path) as file:
        return pose_by(json.load(file))


def pose_by(export):
    frames = export["joint_frames"]

    def turned(q):
        effective = couple_by(export["coupling"], q)
        said = export.get("deflections")
        if said is None:
            return effective
        joints = export["signature"]["joints"]

        def by(readings):
            return sagging(said["drawing"], joints, said["gravity"], couple_by(export["coupling"], readings)) + \
                [spline(m["origin"], m["knots_per_unit"], m["coefficients"], reading)
                 for m, reading in zip(said["maps"], readings, strict=True)]
        return effective + by(q) - by(said["at_rest"])

    def pose(q):
        effective = turned(q)
        T = np.array(frames["base"])
        for X, joint, reading in zip(frames["joints"], export["signature"]["joints"], effective, strict=True):
            T = T @ np.array(X) @ (rotation("z", reading) if joint["type"] == "revolute" else shift(0, 0, reading))
        return T @ np.array(frames["last_link"])
    return pose


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
