# SPDX-License-Identifier: MIT
"""What the command answers, on arrays: the command itself computes it, so that its answers are these to the last digit."""
from __future__ import annotations

import json
import os
import pathlib
import subprocess
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from armsig._problem import Problem

File = str | os.PathLike[str]
Numbers = NDArray[np.float64]

_POSE_COLUMNS = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]


def identify(arm: File, q: ArrayLike, p: ArrayLike, out: File, *, types: str | None = None, sweep: ArrayLike = 0,
             target: ArrayLike = 1, sigma_m: ArrayLike | None = None, options: Sequence[str] = ()) -> dict[str, Any]:
    """Finds the arm signature, writes it to the file `out`, and gives the result of `armsig identify --json`.

    arm: an arm description (YAML), or a name that `armsig arms` lists
    q: readings (rows, joints) [rad; m of prismatic joints]
    p: measured positions (rows, 3) of the target in the sensor's frame [m]
    types: the joints in order, r (revolute) or p (prismatic); None: all revolute
    sweep: of each row, 0 where all joints were anywhere; target: its number; sigma_m: 1 sigma of a coordinate [m]
    options: further options of the command, such as ["--method", "refined"]
    Raises Problem where the command refuses, in its words.
    """
    rows = _measurements(q, p, types, sweep, target, sigma_m)
    return _with_files({"measurements": rows}, lambda folder: _json(
        "identify", "--arm", arm, "--measurements", folder / "measurements.csv", "--out", out, *options))


def check(signature: File, q: ArrayLike, p: ArrayLike, *, types: str | None = None, sweep: ArrayLike = 0,
          target: ArrayLike = 1, sigma_m: ArrayLike | None = None, options: Sequence[str] = ()) -> dict[str, Any]:
    """Whether the arm is still the one of `signature`, by poses measured since: the result of `armsig check --json`.

    The arguments are those of identify(). An arm that has changed is an answer, no Problem.
    """
    rows = _measurements(q, p, types, sweep, target, sigma_m)
    return _with_files({"measurements": rows}, lambda folder: _json(
        "check", "--signature", signature, "--measurements", folder / "measurements.csv", *options))


def predict(signature: File, q: ArrayLike, target: int = 1, *, types: str | None = None) -> Numbers:
    """Poses (rows, 7) [m] of `target` in the sensor's frame at readings `q` (rows, joints): `armsig predict`."""
    names, readings = _readings(q, types)

    def answer(folder: pathlib.Path) -> Numbers:
        _run("predict", "--signature", signature, "--joints", folder / "joints.csv", "--target", str(target), "--out",
             folder / "poses.csv")
        return _table(folder / "poses.csv", _POSE_COLUMNS)

    return _with_files({"joints": _text(names, readings)}, answer)


def solve(signature: File, poses: ArrayLike, seed: ArrayLike, target: int = 1, *, types: str | None = None) -> Numbers:
    """Readings (rows, joints) near `seed` at which `target` is at `poses` (rows, 7) in the sensor's frame [m].

    It is `armsig solve`: raises Problem where a pose has no answer.
    """
    names, readings = _readings(seed, types)
    files = {"poses": _text(_POSE_COLUMNS, np.atleast_2d(np.asarray(poses, dtype=float))), "seed": _text(names, readings)}

    def answer(folder: pathlib.Path) -> Numbers:
        _run("solve", "--signature", signature, "--poses", folder / "poses.csv", "--target", str(target), "--seed",
             folder / "seed.csv", "--out", folder / "readings.csv")
        return _radians(folder / "readings.csv")

    return _with_files(files, answer)


def _readings(q: ArrayLike, types: str | None) -> tuple[list[str], Numbers]:
    readings = np.atleast_2d(np.asarray(q, dtype=float))
    types = types or "r" * readings.shape[1]
    if len(types) != readings.shape[1] or set(types) - {"r", "p"}:
        raise ValueError(f"types {types!r} are no r or p for each of {readings.shape[1]} joints")
    return [f"q{k}_{'rad' if kind == 'r' else 'm'}" for k, kind in enumerate(types, 1)], readings


def _measurements(q: ArrayLike, p: ArrayLike, types: str | None, sweep: ArrayLike, target: ArrayLike,
                  sigma_m: ArrayLike | None) -> str:
    names, readings = _readings(q, types)
    positions = np.asarray(p, dtype=float)
    rows = len(readings)
    if positions.shape != (rows, 3):
        raise ValueError(f"{rows} rows of readings need positions of shape ({rows}, 3); theirs is {positions.shape}")
    numbers = [np.broadcast_to(np.asarray(column, dtype=float), rows)[:, None] for column in (sweep, target)]
    columns = ["sweep", "target", *names, "x_m", "y_m", "z_m"]
    table = [*numbers, readings, positions]
    if sigma_m is not None:
        columns.append("sigma_m")
        table.append(np.broadcast_to(np.asarray(sigma_m, dtype=float), rows)[:, None])
    return _text(columns, np.hstack(table))


def _text(columns: list[str], rows: Numbers) -> str:
    def word(x: float) -> str:
        return str(int(x)) if x == int(x) else repr(float(x))

    if not np.all(np.isfinite(rows)):
        raise ValueError("a number is not finite")
    return "\n".join([",".join(columns), *(",".join(map(word, row)) for row in rows)]) + "\n"


def _with_files(files: dict[str, str], answer: Any) -> Any:
    with tempfile.TemporaryDirectory(prefix="armsig-") as name:
        folder = pathlib.Path(name)
        for file, text in files.items():
            (folder / f"{file}.csv").write_text(text, encoding="ascii")
        return answer(folder)


def _run(*arguments: File) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(["armsig", *(os.fspath(argument) for argument in arguments)], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise Problem(done.stderr.strip().removeprefix("armsig: "))
    return done


def _json(*arguments: File) -> dict[str, Any]:
    done = subprocess.run(["armsig", *(os.fspath(argument) for argument in arguments), "--json"], capture_output=True,
                          text=True, stdin=subprocess.DEVNULL)
    result = json.loads(done.stdout) if done.stdout else {"error": {"what": done.stderr.strip()}}
    if "error" in result:
        raise Problem("; expected ".join(result["error"][key] for key in ("what", "expected") if key in result["error"]))
    return result


def _lines(file: pathlib.Path) -> tuple[list[str], list[list[str]]]:
    lines = [line.split(",") for line in file.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    return lines[0], lines[1:]


def _table(file: pathlib.Path, columns: list[str]) -> Numbers:
    names, rows = _lines(file)
    places = [names.index(column) for column in columns]
    return np.array([[float(row[place]) for place in places] for row in rows])


# Degrees and millimetres, as the command writes readings.
def _radians(file: pathlib.Path) -> Numbers:
    units = {"deg": np.pi / 180, "rad": 1.0, "mm": 1e-3, "m": 1.0}
    names, rows = _lines(file)
    joints = [(k, units[name.rsplit("_", 1)[1]]) for k, name in enumerate(names) if name[0] == "q" and name[1:2].isdigit()]
    return np.array([[float(row[place]) * unit for place, unit in joints] for row in rows])
