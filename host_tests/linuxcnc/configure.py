# SPDX-License-Identifier: MIT
"""Writes what LinuxCNC needs to home at a wrist singularity and to move through it.

configure.py SIGNATURE.yaml armsigkins FILE.kins FOLDER [HOME]
configure.py SIGNATURE.yaml genserkins FILE.hal FOLDER [HOME]
HOME: singular, or regular (where the line through the singularity begins). The same arm stands at the same place and its last link is to go the same ways with both.
"""
import json
import pathlib
import re
import sys

import numpy as np
from signature import Signature, abc, of_quaternion, pose

SERVO_NS = 1_000_000
# Readings where the arm stands at home but for joint 5, which the singularity says.
NEAR_HOME_DEG = [20, -70, 40, 35, 0, 25]

INI = """[EMC]
VERSION = 1.1
DEBUG = 0
[TASK]
TASK = milltask
CYCLE_TIME = 0.01
[RS274NGC]
PARAMETER_FILE = variables
[EMCMOT]
EMCMOT = motmod
SERVO_PERIOD = {servo}
COMM_TIMEOUT = 4
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = tools
[KINS]
KINEMATICS = {kinematics}
JOINTS = 6
[TRAJ]
COORDINATES = XYZABC
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 500
MAX_LINEAR_ACCELERATION = 5000
MAX_ANGULAR_VELOCITY = 360
MAX_ANGULAR_ACCELERATION = 3600
"""
AXIS = """[AXIS_{}]
MIN_LIMIT = -9999
MAX_LIMIT = 9999
MAX_VELOCITY = 500
MAX_ACCELERATION = 5000
"""
JOINT = """[JOINT_{}]
TYPE = ANGULAR
MIN_LIMIT = -400
MAX_LIMIT = 400
MAX_VELOCITY = 3000
MAX_ACCELERATION = 60000
FERROR = 9999
MIN_FERROR = 9999
HOME_SEARCH_VEL = 0
HOME_LATCH_VEL = 0
HOME_SEQUENCE = 0
HOME = {home:.14g}
HOME_OFFSET = {home:.14g}
"""

MOTION = """loadrt [KINS]KINEMATICS
loadrt motmod servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=6
loadrt sampler cfg=ffffff depth=60000
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
END = ("".join(f"net at-{i} joint.{i}.pos-cmd => sampler.0.pin.{i}\n" for i in range(6)) +
       "addf sampler.0 servo-thread\nsetp sampler.0.enable 0\n")


def drives(kins):
    """The drives follow at once."""
    if kins == "armsigkins":
        nets = [f"net joint-{i} joint.{i}.motor-pos-cmd => joint.{i}.motor-pos-fb\n" for i in range(6)]
        return "".join(nets) + "net slow armsigkins.feed => motion.adaptive-feed\n"
    return "".join(f"net drive-{i} joint-offset.{i}.out => joint-offset.{i}.fb-in\n" for i in range(6))


def stated_pose(text, name):
    words = re.search(rf"^# {name}: (.*)$", text, re.M)[1].split(",")
    n = {k: float(v) for k, v in (word.split("=") for word in words)}
    return pose(of_quaternion(n["qw"], n["qx"], n["qy"], n["qz"]), [n["x_m"], n["y_m"], n["z_m"]])


def ways(arm, singular):
    """Lines past the singularity, as pairs of poses of the last link in the base: one that stays near
    it, one that goes right through it, and one that misses it by a little, as joint 4 turns round."""
    X = arm.in_base(singular)
    J = arm.jacobian(singular)
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
    signature, kins, export, folder, *where = sys.argv[1:]
    arm = Signature(signature)
    folder = pathlib.Path(folder)
    text = pathlib.Path(export).read_text()
    singular = arm.at_wrist_singularity(np.radians(NEAR_HOME_DEG))
    lines = ways(arm, singular)
    home = arm.near(lines["through"][0], singular) if where == ["regular"] else singular
    before, after, zero_deg = np.eye(4), np.eye(4), np.zeros(6)
    hal = [MOTION]
    kinematics = f"armsigkins signature={export}"
    if kins == "genserkins":
        kinematics = "genserkins"
        hal.append(text)
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
        "zero_deg": list(zero_deg),  # a joint of LinuxCNC is the reading and this
        "home_deg": list(np.degrees(home)),
        "ways": {name: [world(X) for X in line] for name, line in lines.items()},
        "in_base": {name: [X.tolist() for X in line] for name, line in lines.items()},
    }
    ini = INI.format(servo=SERVO_NS, kinematics=kinematics) + "".join(AXIS.format(a) for a in "XYZABC")
    ini += "".join(JOINT.format(i, home=h) for i, h in enumerate(np.degrees(home) + zero_deg))
    (folder / "arm.ini").write_text(ini)
    (folder / "arm.hal").write_text("".join(hal) + drives(kins) + END)
    (folder / "plan.json").write_text(json.dumps(plan))
    (folder / "tools").write_text("")


main()
