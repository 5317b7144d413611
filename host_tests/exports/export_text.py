# SPDX-License-Identifier: MIT
"""Transforms, and the tables and comments of exports, for the readers that are not ours."""
import csv
import math

import numpy as np


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
