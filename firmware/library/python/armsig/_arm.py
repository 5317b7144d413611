# SPDX-License-Identifier: MIT
"""An arm by libarmsig (armsig.h)."""
from __future__ import annotations

import ctypes
import enum
import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from armsig._problem import Problem

Numbers = NDArray[np.float64]
Statuses = NDArray[np.int32]

_POSE = 7
_MOST_SOLUTIONS = 16


class Status(enum.IntEnum):
    """Of an answer: armsig_status of armsig.h. The answer is NaN but for OK and SINGULAR."""

    OK = 0
    SINGULAR = 1
    OUT_OF_REACH = 2
    JOINT_LIMIT = 3
    CONFIGURATION = 4
    NOT_FINITE = 5
    NO_UNCERTAINTY = 6
    NO_ROOM = 7
    TOO_LARGE = 8

    @property
    def words(self) -> str:
        """What it means, in English."""
        return _library().armsig_words(self).decode()


def _declared(library: ctypes.CDLL) -> ctypes.CDLL:
    numbers, text, size = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t
    for name, result, arguments in (
        ("load", ctypes.c_void_p, (text, text, text, size)),
        ("free", None, (ctypes.c_void_p,)),
        ("joint_count", size, (ctypes.c_void_p,)),
        ("words", text, (ctypes.c_int,)),
        ("forward_rows", size, (ctypes.c_void_p, size, numbers, numbers, numbers, numbers)),
        ("nominal_forward_rows", size, (ctypes.c_void_p, size, numbers, numbers, numbers, numbers)),
        ("inverse_rows", size, (ctypes.c_void_p, size, numbers, numbers, numbers, numbers, numbers)),
        ("compensate_rows", size, (ctypes.c_void_p, size, numbers, numbers, numbers, numbers, numbers)),
        ("sigma_rows", size, (ctypes.c_void_p, size, numbers, ctypes.c_int, numbers, numbers)),
        ("solutions", ctypes.c_int, (ctypes.c_void_p, numbers, numbers, numbers, size, ctypes.POINTER(size))),
        ("base_in_sensor", None, (ctypes.c_void_p, numbers)),
        ("last_link_on_flange", None, (ctypes.c_void_p, numbers)),
    ):
        function = getattr(library, "armsig_" + name)
        function.restype, function.argtypes = result, arguments
    return library


_loaded: ctypes.CDLL | None = None


def _library() -> ctypes.CDLL:
    global _loaded
    if _loaded is None:
        _loaded = _declared(ctypes.CDLL("libarmsig.so.1"))
    return _loaded


def poses(matrices: ArrayLike | Any) -> Numbers:
    """Poses (..., 7) of matrices (..., 4, 4), of an SE3 object, or of poses."""
    for name in ("homogeneous", "A"):
        matrices = getattr(matrices, name, matrices)
    given = np.asarray(matrices, dtype=float)
    if given.shape[-2:] != (4, 4):
        return _rows_of(given, _POSE, "a pose")
    flat = given.reshape(-1, 4, 4)
    R = flat[:, :3, :3]
    # The largest of the four numbers of a quaternion by the diagonal, the others by it (Shepperd 1978).
    trace = np.trace(R, axis1=1, axis2=2)
    squares = np.stack([1 + trace, *(1 - trace + 2 * R[:, i, i] for i in range(3))], axis=1)
    largest = np.argmax(squares, axis=1)
    w = R[:, [2, 0, 1], [1, 2, 0]] - R[:, [1, 2, 0], [2, 0, 1]]
    sums = R + np.swapaxes(R, 1, 2)
    products = np.empty((len(flat), 4, 4))
    products[:, 1:, 1:] = sums
    products[:, 0, 1:] = products[:, 1:, 0] = w
    products[:, range(4), range(4)] = squares
    q = products[np.arange(len(flat)), largest]
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    q *= np.where(q[:, :1] < 0, -1.0, 1.0)
    return np.concatenate([flat[:, :3, 3], q], axis=1).reshape(*given.shape[:-2], _POSE)


def matrices(poses: ArrayLike) -> Numbers:
    """Matrices (..., 4, 4) of poses (..., 7)."""
    given = _rows_of(poses, _POSE, "a pose")
    w, x, y, z = np.moveaxis(given[..., 3:], -1, 0)
    X = np.zeros((*given.shape[:-1], 4, 4))
    X[..., 0, :3] = np.stack([w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=-1)
    X[..., 1, :3] = np.stack([2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)], axis=-1)
    X[..., 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z], axis=-1)
    X[..., :3, 3] = given[..., :3]
    X[..., 3, 3] = 1
    return X


def _rows_of(numbers: ArrayLike, width: int, what: str) -> Numbers:
    rows = np.ascontiguousarray(numbers, dtype=float)
    if rows.shape[-1:] != (width,):
        raise ValueError(f"{what} has {width} numbers in the last dimension; the shape is {rows.shape}")
    return rows


class Arm:
    """The arm of a signature file: load() makes one. Any number of threads may use it at once."""

    def __init__(self, handle: int) -> None:
        self._handle = handle
        self._free = _library().armsig_free
        self.joint_count: int = _library().armsig_joint_count(handle)

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._free(self._handle)

    def forward(self, q: ArrayLike, tool: ArrayLike | Any = None) -> Numbers:
        """Where the tool really is [m] at readings `q` (..., joints) [rad, m]: poses (..., 7).

        `tool`: the pose of the tool on the flange; None for the flange itself.
        NaN where a reading is not finite.
        """
        return self._forward("forward_rows", q, tool)

    def nominal_forward(self, q: ArrayLike, tool: ArrayLike | Any = None) -> Numbers:
        """Where the tool is by the nominal model, which the closed controller computes with: as forward()."""
        return self._forward("nominal_forward_rows", q, tool)

    def inverse(self, pose: ArrayLike | Any, seed: ArrayLike, tool: ArrayLike | Any = None) -> tuple[Numbers, Statuses]:
        """The readings (..., joints) [rad, m] near `seed` (..., joints) at which the tool is at `pose` (..., 7) [m].

        The second answer has a Status for each.
        """
        return self._solved("inverse_rows", self.joint_count, pose, seed, tool)

    def compensate(self, pose: ArrayLike | Any, seed: ArrayLike, tool: ArrayLike | Any = None) -> tuple[Numbers, Statuses]:
        """The poses (..., 7) [m] to give a closed controller so that the real tool arrives at `pose` (..., 7) [m].

        `seed` (..., joints) [rad, m]: readings near those where the controller goes; it says the configuration. The
        second answer has a Status for each.
        """
        return self._solved("compensate_rows", _POSE, pose, seed, tool)

    def solutions(self, pose: ArrayLike | Any, tool: ArrayLike | Any = None) -> Numbers:
        """All readings (solutions, joints) [rad, m] inside the limits at which the tool is at one `pose` (7) [m]."""
        at = poses(pose)
        if at.shape != (_POSE,):
            raise ValueError(f"solutions() takes one pose; the shape is {at.shape}")
        found = np.empty((_MOST_SOLUTIONS, self.joint_count))
        count = ctypes.c_size_t()
        status = Status(_library().armsig_solutions(self._handle, at.ctypes.data, self._tool(tool)[1], found.ctypes.data,
                                                    _MOST_SOLUTIONS, ctypes.byref(count)))
        if status not in (Status.OK, Status.OUT_OF_REACH):
            raise ValueError(status.words)
        return found[:count.value].copy()

    def sigma(self, q: ArrayLike, target: int) -> Numbers:
        """1 sigma (..., 3) [m] of the position of `target` along the axes of the sensor's frame at readings `q`."""
        rows = _rows_of(q, self.joint_count, "a row of readings")
        sigma_m = np.empty((*rows.shape[:-1], 3))
        statuses = np.empty(rows.shape[:-1], dtype=np.int32)
        _library().armsig_sigma_rows(self._handle, statuses.size, rows.ctypes.data, target, sigma_m.ctypes.data,
                                     statuses.ctypes.data)
        if np.any(statuses == Status.NO_UNCERTAINTY):
            raise ValueError(Status.NO_UNCERTAINTY.words)
        return sigma_m

    @property
    def base_in_sensor(self) -> Numbers:
        """The pose (7) [m] of the base in the frame of the sensor that the signature was measured by."""
        return self._fixed("base_in_sensor")

    @property
    def last_link_on_flange(self) -> Numbers:
        """The pose (7) [m] of the last link's frame, which `armsig predict` answers for, on the flange."""
        return self._fixed("last_link_on_flange")

    def _fixed(self, name: str) -> Numbers:
        pose = np.empty(_POSE)
        getattr(_library(), "armsig_" + name)(self._handle, pose.ctypes.data)
        return pose

    # With the array that the address is of, which must outlive the call.
    @staticmethod
    def _tool(tool: ArrayLike | Any) -> tuple[Numbers | None, int | None]:
        if tool is None:
            return None, None
        pose = poses(tool)
        if pose.shape != (_POSE,):
            raise ValueError(f"one tool is one pose; the shape is {pose.shape}")
        return pose, pose.ctypes.data

    def _forward(self, name: str, q: ArrayLike, tool: ArrayLike | Any) -> Numbers:
        rows = _rows_of(q, self.joint_count, "a row of readings")
        kept, address = self._tool(tool)
        answer = np.empty((*rows.shape[:-1], _POSE))
        getattr(_library(), "armsig_" + name)(self._handle, answer.size // _POSE, rows.ctypes.data, address,
                                              answer.ctypes.data, None)
        del kept
        return answer

    def _solved(self, name: str, width: int, pose: ArrayLike | Any, seed: ArrayLike,
                tool: ArrayLike | Any) -> tuple[Numbers, Statuses]:
        at = poses(pose)
        near = _rows_of(seed, self.joint_count, "a seed")
        shape = np.broadcast_shapes(at.shape[:-1], near.shape[:-1])
        at = np.ascontiguousarray(np.broadcast_to(at, (*shape, _POSE)))
        near = np.ascontiguousarray(np.broadcast_to(near, (*shape, self.joint_count)))
        kept, address = self._tool(tool)
        answer = np.empty((*shape, width))
        statuses = np.empty(shape, dtype=np.int32)
        getattr(_library(), "armsig_" + name)(self._handle, statuses.size, at.ctypes.data, address, near.ctypes.data,
                                              answer.ctypes.data, statuses.ctypes.data)
        del kept
        return answer, statuses


def load(path: str | os.PathLike[str], nominal_model: str | os.PathLike[str] | None = None) -> Arm:
    """The arm of a signature file.

    `nominal_model`: an arm description that the closed controller computes with; None for that of the signature.
    Raises Problem, with the place and what was expected, where a file cannot be read.
    """
    problem = ctypes.create_string_buffer(512)
    nominal = None if nominal_model is None else os.fsencode(nominal_model)
    handle = _library().armsig_load(os.fsencode(path), nominal, problem, len(problem))
    if not handle:
        raise Problem(problem.value.decode(errors="replace"))
    return Arm(handle)
