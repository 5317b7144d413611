# SPDX-License-Identifier: MIT
"""What gravity and joint error maps do, from the exports that say it: json and maps-csv."""
import json
import math

import numpy as np

from export_text import comments_of, rotation, rows_of, shift


def spline(origin, per_unit, coefficients, reading):
    """Cubic B-splines by the recursion of de Boor and Cox, on the knots -3 ... 1 about the reading."""
    u = (reading - origin) * per_unit
    k, n = math.floor(u), len(coefficients)

    def basis(i, degree):
        if degree == 0:
            return 1.0 if i <= u - k < i + 1 else 0.0
        return ((u - k - i) * basis(i, degree - 1) + (i + degree + 1 - u + k) * basis(i + 1, degree - 1)) / degree
    return sum(coefficients[(k + j) % n] * basis(j - 3, 3) for j in range(4))


def sagging(drawing, joints, gravity, effective, up=(0, 0, 1)):
    """What gravity turns each joint by; `up` in frame 0 of the nominal model."""
    down = -np.array(up)
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
            lever = axes[j] @ np.cross(origins[term["link"]] - origins[j], down)
        else:
            lever = axes[j] @ down
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
    for i, line in enumerate(line for line in comments_of(path) if line.startswith("nominal ")):
        said["nominal"][i] = {k: float(v) for k, v in
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
            return sagging(said["nominal"], joints, said["gravity"], couple_by(export["coupling"], readings),
                           said.get("up", (0, 0, 1))) + \
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
