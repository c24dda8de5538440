"""The load-gauge curve as columns, written to ``curve.csv`` one row per accepted step."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.step import Step

__all__ = ["COLUMNS", "Curve", "CurveWriter", "columns", "read_curve", "row"]

Curve = dict[str, NDArray[Any]]
"""Column name -> 1-D array, one entry per step; int64 for counts, float64 for all others."""

COLUMNS: tuple[str, ...] = (
    "step",
    "gauge_m",
    "load_N",
    "load_displacement_m",
    "bodies",
    "fine_bodies",
    "refinements",
    "iterations",
    "factorizations",
    "dissipated_J",
    "stored_J",
    "work_J",
    "max_elastic_utilisation",
    "residual",
    "cpu_s",
    "wall_s",
)
"""Columns of ``curve.csv`` in order; the part after the last underscore is the unit, if there is one."""

COUNTS = frozenset({"step", "bodies", "fine_bodies", "refinements", "iterations", "factorizations"})
"""Columns of whole numbers."""


def row(step: Step, cpu_s: float, wall_s: float) -> dict[str, float]:
    """Row of the curve for one step.

    Parameters
    ----------
    step : Step
        An accepted step.
    cpu_s, wall_s : float
        Processor and wall time since the simulation was built [s].

    Returns
    -------
    dict
        Value of every column of `COLUMNS`.
    """
    return {
        "step": step.number,
        "gauge_m": step.gauge,
        "load_N": step.load,
        "load_displacement_m": step.load_displacement,
        "bodies": step.bodies,
        "fine_bodies": step.fine_bodies,
        "refinements": step.refinements,
        "iterations": step.iterations,
        "factorizations": step.factorizations,
        "dissipated_J": step.dissipated,
        "stored_J": step.stored,
        "work_J": step.work,
        "max_elastic_utilisation": step.max_elastic_utilisation,
        "residual": step.residual,
        "cpu_s": cpu_s,
        "wall_s": wall_s,
    }


def columns(rows: Iterable[Mapping[str, float]]) -> Curve:
    """Columns of a list of rows; arrays of length zero when there are none."""
    rows = list(rows)
    return {name: np.array([r[name] for r in rows], dtype=_dtype(name)) for name in COLUMNS}


class CurveWriter:
    """Writes ``curve.csv`` row by row, so that a run that is killed keeps its curve.

    Parameters
    ----------
    path : Path
        File to write; an older one is replaced.
    """

    def __init__(self, path: Path) -> None:
        self._file: TextIO = path.open("w", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        self._writer.writerow(COLUMNS)
        self._file.flush()

    def write(self, values: Mapping[str, float]) -> None:
        """Append one row and hand it to the operating system."""
        self._writer.writerow([str(int(values[n])) if n in COUNTS else f"{values[n]:.12g}" for n in COLUMNS])
        self._file.flush()

    def close(self) -> None:
        """Close the file; may be called twice."""
        self._file.close()


def read_curve(path: str | Path) -> Curve:
    """Read a ``curve.csv``.

    Parameters
    ----------
    path : str or Path
        The file, or the result folder it lies in.

    Returns
    -------
    dict of str to (steps,) array
        Every column of the file; those of `COLUMNS` are always there.

    Raises
    ------
    InputError
        The file is missing, lacks a column, or has a row that is not made of numbers.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "curve.csv"
    try:
        with path.open(encoding="utf-8", newline="") as file:
            lines = [(number, line) for number, line in enumerate(csv.reader(file), 1) if line]
    except OSError as error:
        raise InputError(str(path), "cannot be read", "a curve.csv of a Fissura run") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(str(path), "is not a CSV text file", "a curve.csv of a Fissura run") from error
    names = [name.strip() for name in lines[0][1]] if lines else []
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise InputError(str(path), f"has no column {', '.join(missing)}", "a first line naming " + ",".join(COLUMNS))
    table = np.array([_numbers(path, number, line, names) for number, line in lines[1:]], dtype=np.float64).reshape(
        -1, len(names)
    )
    return {name: table[:, k].astype(_dtype(name)) for k, name in enumerate(names)}


def _numbers(path: Path, number: int, line: list[str], names: list[str]) -> list[float]:
    key = f"{path}, line {number}"
    if len(line) != len(names):
        raise InputError(key, f"has {len(line)} values", f"{len(names)} values, one for each column")
    values = []
    for name, text in zip(names, line, strict=True):
        try:
            value = float(text)
        except ValueError:
            raise InputError(key, f"{name} is {text!r}", "a number") from None
        if name in COUNTS and not (math.isfinite(value) and value == int(value)):
            raise InputError(key, f"{name} is {text!r}", "a whole number")
        values.append(value)
    return values


def _dtype(name: str) -> type[np.float64] | type[np.int64]:
    return np.int64 if name in COUNTS else np.float64
