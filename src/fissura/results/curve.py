"""The load-gauge curve as columns, written to ``curve.csv`` one row per accepted step."""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.case import Case, Quantity
from fissura.case.programme import GRAVITY
from fissura.errors import InputError
from fissura.files.text import read_text
from fissura.simulation.step import Step

#: Largest curve that is read: a million steps have some 300 MB.
_MOST_BYTES = 500_000_000

Curve = dict[str, NDArray[Any]]
"""Column name -> 1-D array, one entry per step; int64 for counts, text, float64 for all others."""

Row = dict[str, float | str]
"""Column name -> its value in one step."""

_TABLE: dict[str, tuple[str, type]] = {
    "step": ("number", int),
    "gauge_m": ("gauge", float),
    "load_N": ("load", float),
    "load_displacement_m": ("load_displacement", float),
    "bodies": ("bodies", int),
    "fine_bodies": ("fine_bodies", int),
    "refinements": ("refinements", int),
    "coarsenings": ("coarsenings", int),
    "iterations": ("iterations", int),
    "linear_iterations": ("linear_iterations", int),
    "factorizations": ("factorizations", int),
    "dissipated_J": ("dissipated", float),
    "stored_J": ("stored", float),
    "work_J": ("work", float),
    "exchanged_J": ("exchanged", float),
    "dissipated_at_places_J": ("", float),
    "unbalanced_N": ("", float),
    "unbalanced_Nm": ("", float),
    "max_elastic_utilisation": ("max_elastic_utilisation", float),
    "residual": ("residual", float),
    "cpu_s": ("", float),
    "wall_s": ("", float),
    "control": ("control", str),
    "stage": ("stage", int),
}
"""Columns of every ``curve.csv`` in order: what of a `Step` they hold, where that is all, and their type."""

COLUMNS: tuple[str, ...] = tuple(_TABLE)
"""Columns of every ``curve.csv`` in order; the part after the last underscore is the unit, if there is one."""

COUNTS = frozenset(name for name, (_, kind) in _TABLE.items() if kind is int)
"""Columns of whole numbers."""

TEXTS = frozenset(name for name, (_, kind) in _TABLE.items() if kind is str)
"""Columns of words."""

REACTION: tuple[str, ...] = tuple(
    f"{kind}_{axis}_{unit}" for kind, unit in (("force", "N"), ("moment", "Nm")) for axis in "xyz"
)
"""Parts of the reaction of a support."""

LOAD = "load"
"""Name of the load that needs none: its force and displacement are columns of every curve."""

NAMED: tuple[str, ...] = ("force_{}_N", "displacement_{}_m")
"""Columns of a load that has a name."""

ENERGY_AT = "dissipated_at_{}_J"
"""Column of the energy at a place."""

COLUMN_OF: dict[Quantity, str] = {"gauge": "gauge_m", "displacement": "load_displacement_m"}
"""Column of each quantity that may be controlled."""


def case_columns(case: Case) -> tuple[str, ...]:
    """Columns that follow those of `COLUMNS` in a case.

    They are force and displacement of every load, and every gauge, that has a name of its own; energies at the places;
    reactions.
    """
    named = (*_load_columns(case.load_names), *_gauge_columns([gauge.name for gauge in case.named_gauges]))
    return (*named, *_place_columns([load.name for load in case.named_loads], case.held_names))


def _load_columns(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(column.format(name) for name in names if name != LOAD for column in NAMED)


def _gauge_columns(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(f"gauge_{name}_m" for name in names if name != "gauge")


def _place_columns(loads: Iterable[str], held: Sequence[str]) -> tuple[str, ...]:
    energies = [ENERGY_AT.format(LOAD if name == LOAD else f"load_{name}") for name in loads]
    energies += [ENERGY_AT.format(name) for name in held]
    return (*energies, *(f"{name}_{part}" for name in held for part in REACTION))


def row(step: Step, cpu_s: float, wall_s: float) -> Row:
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
        Value of every column of `COLUMNS` and of `case_columns`.
    """
    *at, at_all = step.dissipated_at.tolist()
    force, moment = (float(np.linalg.norm(part)) for part in (step.rest[:3], step.rest[3:]))
    found: Row = {
        **{name: getattr(step, attribute) for name, (attribute, _) in _TABLE.items() if attribute},
        "dissipated_at_places_J": at_all,
        "unbalanced_N": force,
        "unbalanced_Nm": moment,
        "cpu_s": cpu_s,
        "wall_s": wall_s,
    }
    found = {name: found[name] for name in COLUMNS}
    for name in step.forces:
        if name != LOAD:
            of_load = (step.forces[name], step.displacements[name])
            found |= zip((column.format(name) for column in NAMED), of_load, strict=True)
    found |= zip(_gauge_columns(step.gauges), (v for name, v in step.gauges.items() if name != "gauge"), strict=True)
    places = _place_columns([name for name in step.forces if name != GRAVITY], step.held)
    found |= zip(places, [*at, *step.reactions.ravel().tolist()], strict=True)
    return found


def columns(rows: Iterable[Mapping[str, float | str]]) -> Curve:
    """Columns of a list of rows; those of `COLUMNS`, of length zero, when there are none."""
    rows = list(rows)
    return {name: np.array([r[name] for r in rows], dtype=_dtype(name)) for name in (rows[0] if rows else COLUMNS)}


def peak_position(load: NDArray[np.float64]) -> int:
    """Position of the load of largest magnitude, the first one of several; shape (steps,), at least one step."""
    return int(np.abs(load).argmax())


class GrowingCurve:
    """A curve that grows by one row at a time; its columns are made of the rows that are new only.

    Parameters
    ----------
    curve : dict of str to (steps,) array, optional
        What it begins with.
    """

    def __init__(self, curve: Curve | None = None) -> None:
        self._rows: list[Row] = []
        self._curve = curve

    def add(self, values: Row) -> None:
        """Append a row."""
        self._rows.append(values)

    def columns(self) -> Curve:
        """Columns of all rows so far."""
        if self._rows or self._curve is None:
            more, self._rows, before = columns(self._rows), [], self._curve
            if before is not None and len(before["step"]):
                more = {name: np.concatenate([before[name], values]) for name, values in more.items()}
            self._curve = more
        return self._curve


def read_curve(path: str | Path) -> Curve:
    """Read a ``curve.csv``.

    Parameters
    ----------
    path : str or Path
        The file, or the result folder it lies in.

    Returns
    -------
    dict of str to (steps,) array
        Every column of the file, at least those of `COLUMNS`.

    Raises
    ------
    InputError
        The file is missing, lacks a column, or has a word where a number belongs.

    Examples
    --------
    >>> read_curve(folder)["load_N"].tolist() == result.load_values.tolist()
    True
    """
    path = Path(path)
    if path.is_dir():
        path = path / "curve.csv"
    allowed = "a curve.csv of a Fissura run"
    text = read_text(path, str(path), allowed, _MOST_BYTES)
    try:
        lines = [(number, line) for number, line in enumerate(csv.reader(io.StringIO(text, newline="")), 1) if line]
    except csv.Error as error:
        raise InputError(str(path), "is not a CSV text file", allowed) from error
    names = [name.strip() for name in lines[0][1]] if lines else []
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise InputError(str(path), f"has no column {', '.join(missing)}", "a first line naming " + ",".join(COLUMNS))
    rows = [_values(path, number, line, names) for number, line in lines[1:]]
    return {name: np.array([values[k] for values in rows], dtype=_dtype(name)) for k, name in enumerate(names)}


def _values(path: Path, number: int, line: list[str], names: list[str]) -> list[float | str]:
    key = f"{path}, line {number}"
    if len(line) != len(names):
        raise InputError(key, f"has {len(line)} values", f"{len(names)} values, one for each column")
    values: list[float | str] = []
    for name, text in zip(names, line, strict=True):
        if name in TEXTS:
            values.append(text.strip())
            continue
        try:
            value = float(text)
        except ValueError:
            raise InputError(key, f"{name} is {text!r}", "a number") from None
        if name in COUNTS and not (math.isfinite(value) and value == int(value)):
            raise InputError(key, f"{name} is {text!r}", "a whole number")
        values.append(value)
    return values


def _dtype(name: str) -> type[np.float64] | type[np.int64] | type[np.str_]:
    if name in TEXTS:
        return np.str_
    return np.int64 if name in COUNTS else np.float64
