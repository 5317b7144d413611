# SPDX-License-Identifier: MIT
"""Writes what LinuxCNC needs to home at a wrist singularity and to move through it.

configure.py EXAMPLE SIGNATURE.yaml armsigkins FILE.kins FOLDER
configure.py EXAMPLE SIGNATURE.yaml genserkins FILE.hal FOLDER
From the guide's example (a folder with arm.ini and arm.hal). The same arm stands at the same place and its last link is to go
the same ways with both.
"""
import json
import pathlib
import re
import sys

import numpy as np
from signature import Signature, abc, of_quaternion, pose

# Readings where the arm stands at home but for joint 5, which the singularity says.
NEAR_HOME_DEG = [20, -70, 40, 35, 0, 25]

# What samples the joints at every servo period.
SAMPLER = ("loadrt sampler cfg=ffffff depth=60000\n" +
           "".join(f"net at-{i} joint.{i}.pos-cmd => sampler.0.pin.{i}\n" for i in range(6)) +
           "addf sampler.0 servo-thread\nsetp sampler.0.enable 0\n")


def ini_of(example, kinematics, home_deg, zero_deg):
    """The example's, homed at `home_deg`; a joint of LinuxCNC is the reading and `zero_deg`."""
    text = re.sub(r"^KINEMATICS = .*$", f"KINEMATICS = {kinematics}", example, flags=re.M)
    head, *joints = re.split(r"(?=^\[JOINT_)", text, flags=re.M)
    assert len(joints) == 6
    for i, joint in enumerate(joints):
        at = f"{home_deg[i] + zero_deg[i]:.14g}"
        joint = re.sub(r"^(HOME|HOME_OFFSET) = .*$", rf"\1 = {at}", joint, flags=re.M)
        joints[i] = re.sub(r"^(M.._LIMIT) = (.*)$", lambda m, z=zero_deg[i]: f"{m[1]} = {float(m[2]) + z:.14g}",
                           joint, flags=re.M)
    return head + "".join(joints)


def hal_of(example, export):
    """The example's; for genserkins with the settings exported, whose offsets are between joint and drive."""
    if export is None:
        return example + SAMPLER
    kept = [line for line in example.splitlines() if not re.match(r"net (kins-feed|joint-)", line)]
    drives = [f"net drive-{i} joint-offset.{i}.out => joint-offset.{i}.fb-in" for i in range(6)]
    return "\n".join([*kept, export, *drives, ""]) + SAMPLER


def stated_pose(text, name):
    words = re.search(rf"^# {name}: (.*)$", text, re.M)[1].split(",")
    n = {k: float(v) for k, v in (word.split("=") for word in words)}
    return pose(of_quaternion(n["qw"], n["qx"], n["qy"], n["qz"]), [n["x_m"], n["y_m"], n["z_m"]])


def ways(arm, home):
    """Lines past the singularity, as pairs of poses of the last link in the base: one that stays near
    it, one that goes right through it, and one that misses it by a little, as joint 4 turns round."""
    X = arm.in_base(home)
    J = arm.jacobian(home)
    null = np.linalg.svd(J)[0][:, -1]  # what the joints can't do there
    across = null[:3] / np.linalg.norm(null[:3])
    along = np.linalg.pinv(J, rcond=1e-6)[4, :3]  # what turns joint 5 most
    along -= across * (across @ along)
    along /= np.linalg.norm(along)
    around = np.cross(across, along)

    def line(direction, aside_mm=0):
        middle = X[:3, 3] + 1e-3 * aside_mm * across
        return [pose(X[:3, :3], middle + way * direction) for way in (-0.04, 0.04)]
    return {"along": line(around), "through": line(along), "beside": line(along, 0.2)}


def main():
    example, signature, kins, export, folder = sys.argv[1:]
    arm = Signature(signature)
    example, folder = pathlib.Path(example), pathlib.Path(folder)
    text = pathlib.Path(export).read_text()
    home = arm.at_wrist_singularity(np.radians(NEAR_HOME_DEG))
    lines = ways(arm, home)
    before, after, zero_deg = np.eye(4), np.eye(4), np.zeros(6)
    kinematics, settings = f"armsigkins signature={export}", None
    if kins == "genserkins":
        kinematics, settings = "genserkins", text
        zero_deg = -np.array([float(re.search(rf"setp joint-offset.{i}.offset (\S+)", text)[1]) for i in range(6)])
        before = np.linalg.inv(stated_pose(text, "base")) @ arm.base
        after = np.linalg.inv(stated_pose(text, "tool"))

    def world(X):
        X = before @ X @ after
        return [*(1e3 * X[:3, 3]), *abc(X[:3, :3])]
    plan = {
        "kins": kins,
        # Slowly where joints would turn fast, but for the line that is near the singularity all the way.
        "adaptive_feed": {name: f"M52 P{int(kins == 'armsigkins' and name != 'along')}" for name in lines},
        "around": [np.linalg.inv(X).tolist() for X in (before, after)],  # what LinuxCNC shows, for the last link in the base
        "zero_deg": list(zero_deg),  # a joint of LinuxCNC is the reading and this
        "home_deg": list(np.degrees(home)),
        "ways": {name: [world(X) for X in line] for name, line in lines.items()},
        "in_base": {name: [X.tolist() for X in line] for name, line in lines.items()},
    }
    ini = ini_of((example / "arm.ini").read_text(), kinematics, np.degrees(home), zero_deg)
    (folder / "arm.ini").write_text(ini)
    (folder / "arm.hal").write_text(hal_of((example / "arm.hal").read_text(), settings))
    (folder / "plan.json").write_text(json.dumps(plan))
    (folder / "tools").write_text("")


main()
