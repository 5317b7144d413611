#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Forward kinematics of a URDF that armsig corrected, by a reader that is not ours.

read_urdf.py URDF BASE TIP JOINTS.csv POSES.csv: prints the largest distance (m) and the largest
difference of the rotation matrices from the poses that armsig predicts. Where the base link stands
in the sensor frame, and the frame predicted in the tip link, are read from the file's comment. The
conventions are those of wiki.ros.org/urdf/XML/joint, written here anew.
"""
import csv
import math
import re
import sys
import xml.etree.ElementTree as ET

import numpy as np


def turn(axis, angle):
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return T


def shift(p):
    T = np.eye(4)
    T[:3, 3] = p
    return T


def numbers(element, name, absent):
    return [float(word) for word in (element.get(name) if element is not None and element.get(name) else absent).split()]


def origin(joint):
    element = joint.find("origin")
    roll, pitch, yaw = numbers(element, "rpy", "0 0 0")
    return shift(numbers(element, "xyz", "0 0 0")) @ turn([0, 0, 1], yaw) @ turn([0, 1, 0], pitch) @ turn([1, 0, 0], roll)


def from_quaternion(p):
    w, x, y, z = (float(p[k]) for k in ("qw", "qx", "qy", "qz"))
    T = shift([float(p[k]) for k in ("x_m", "y_m", "z_m")])
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return T


def stated(text, words):
    found = re.search(re.escape(words) + r": (x_m=\S+)", text)
    return from_quaternion(dict(item.split("=") for item in found[1].split(",")))


def path(robot, base, tip):
    above = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    joints = []
    while tip != base:
        joints.insert(0, above[tip])
        tip = above[tip].find("parent").get("link")
    return joints


def values_of(joints, readings):
    moving = [joint for joint in joints if joint.get("type") != "fixed" and joint.find("mimic") is None]
    values = dict(zip([joint.get("name") for joint in moving], readings, strict=True))
    for joint in joints:
        mimic = joint.find("mimic")
        if mimic is not None:
            values[joint.get("name")] = float(mimic.get("multiplier", "1")) * values[mimic.get("joint")] + \
                float(mimic.get("offset", "0"))
    return values


def pose(joints, readings):
    values = values_of(joints, readings)
    T = np.eye(4)
    for joint in joints:
        T = T @ origin(joint)
        if joint.get("type") == "fixed":
            continue
        axis = np.array(numbers(joint.find("axis"), "xyz", "1 0 0"))
        value = values[joint.get("name")]
        T = T @ (shift(value * axis / np.linalg.norm(axis)) if joint.get("type") == "prismatic" else turn(axis, value))
    return T


def rows(file):
    with open(file, newline="") as opened:
        return list(csv.DictReader(line for line in opened if not line.startswith("#")))


def main():
    urdf, base, tip, readings, poses = sys.argv[1:]
    with open(urdf) as opened:
        text = opened.read()
    joints = path(ET.fromstring(text), base, tip)
    before = stated(text, base + " in the sensor frame")
    behind = stated(text, "last link of armsig predict in " + tip)
    distance = angle = 0
    for row, expected in zip(rows(readings), rows(poses), strict=True):
        q = [math.radians(float(v)) if k.endswith("_deg") else float(v) / 1e3 for k, v in sorted(row.items())]
        difference = before @ pose(joints, q) @ behind - from_quaternion(expected)
        distance = max(distance, float(np.linalg.norm(difference[:3, 3])))
        angle = max(angle, float(np.abs(difference[:3, :3]).max()))
    print(f"{distance:.3g} {angle:.3g}")


main()
