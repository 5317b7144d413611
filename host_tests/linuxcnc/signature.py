# SPDX-License-Identifier: MIT
"""A signature evaluated by numpy alone: each joint turns what is beyond it about its axis line.

Written from docs/formats.md. No Denavit-Hartenberg parameter is used, which the kinematics module
goes by.
"""
import math

import numpy as np
import yaml


def cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def pose(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def turn(direction, point, angle):
    """By Rodrigues, about the line through `point`."""
    k = cross(direction)
    R = np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k
    return pose(R, point - R @ point)


def of_quaternion(w, x, y, z):
    k = cross([x, y, z])
    return np.eye(3) + 2 * w * k + 2 * k @ k


def abc(R):
    """A, B, C in degrees of R = Rot(z, C) Rot(y, B) Rot(x, A), away from B = +-90."""
    return np.degrees([math.atan2(R[2, 1], R[2, 2]), -math.asin(R[2, 0]), math.atan2(R[1, 0], R[0, 0])])


def of_abc(degrees):
    a, b, c = np.radians(degrees)
    X, Y, Z = np.eye(3)
    return (turn(Z, 0 * Z, c) @ turn(Y, 0 * Y, b) @ turn(X, 0 * X, a))[:3, :3]


class Signature:
    def __init__(self, path):
        with open(path) as file:
            said = yaml.safe_load(file)
        joints = said["joints"]
        assert all(joint["type"] == "revolute" for joint in joints)
        self.axes = [np.array(joint["axis_direction"]) for joint in joints]
        self.points = [np.array(joint["axis_point_m"]) for joint in joints]
        self.at = np.array([joint["reading_rad"] for joint in joints])
        last = said["last_link"]
        self.last = pose(np.column_stack([last[f"{k}_direction"] for k in "xyz"]), last["origin_m"])
        self.base = pose(of_quaternion(*said["base"]["quaternion_wxyz"]), said["base"]["position_m"])

    def in_sensor(self, q):
        """Pose of the last link's frame in the sensor frame, metres; q in radians."""
        T = np.eye(4)
        for axis, point, angle in zip(self.axes, self.points, np.asarray(q) - self.at, strict=True):
            T = T @ turn(axis, point, angle)
        return T @ self.last

    def in_base(self, q):
        return np.linalg.inv(self.base) @ self.in_sensor(q)

    def jacobian(self, q, step=1e-6):
        """Of the last link's frame in the base, metres and radians, by central differences."""
        R = self.in_base(q)[:3, :3]
        columns = []
        for i in range(len(q)):
            by = step * np.eye(len(q))[i]
            after, before = self.in_base(q + by), self.in_base(q - by)
            spin = (after[:3, :3] - before[:3, :3]) @ R.T
            columns.append(np.append(after[:3, 3] - before[:3, 3], [spin[2, 1], spin[0, 2], spin[1, 0]]) / (2 * step))
        return np.column_stack(columns)

    def at_wrist_singularity(self, q):
        """q with joint 5 where the six columns of the Jacobian lose a dimension, by bisection."""
        def determinant(angle):
            return np.linalg.det(self.jacobian(np.where(np.arange(6) == 4, angle, q)))
        low, high = -0.2, 0.2
        assert determinant(low) * determinant(high) < 0
        for _ in range(60):
            middle = (low + high) / 2
            if determinant(low) * determinant(middle) <= 0:
                high = middle
            else:
                low = middle
        return np.where(np.arange(6) == 4, low, q)
