# SPDX-License-Identifier: MIT
"""The real arm of a signature file, in numpy.

    arm = armsig.load("signature.yaml")
    target = arm.forward(q)                       # where the tool really is
    told, status = arm.compensate(target, q)      # what its own controller must be given instead

Lengths are in metres, angles in radians. Readings are what the encoders show, one a joint, in the last
dimension: shape (..., joints). A pose is x, y, z and a quaternion w, x, y, z of length 1: shape (..., 7). Functions take
any number of dimensions before the last and give as many. Where a pose is asked for, matrices of shape
(..., 4, 4) do as well, and objects that have one: SE3 of spatialmath (`.A`) and of Pinocchio (`.homogeneous`).

Poses are of the tool in the base: the base of the nominal model, laid over the identified axes.
"""
from armsig._arm import Arm, Status, load, matrices, poses
from armsig._command import Problem, check, identify, predict, solve

__all__ = ["Arm", "Problem", "Status", "check", "identify", "load", "matrices", "poses", "predict", "solve"]
