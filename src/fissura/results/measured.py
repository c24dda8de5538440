"""Measured load bands or curves: to show next to a computed curve, and to calibrate to."""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fissura.case.units import show
from fissura.errors import InputError
from fissura.files.text import read_text
from fissura.results.measured_columns import (
    PLAIN,
    UNITS,
    Column,
    chosen,
    columns_named,
    columns_of_units,
    is_number,
    unit_of,
)
from fissura.text.quantities import counted

KEY = "output.measured"
ALLOWED = "a CSV file of cmod_mm,min_N,max_N, or of two or three columns with units in the header"

#: Largest length [m] and force [N], and largest file.
_MOST, _MOST_BYTES = {True: 1e4, False: 1e15}, 20_000_000


@dataclass(frozen=True)
class MeasuredBand:
    """Smallest and largest measured load over the gauge.

    Attributes
    ----------
    gauge : (k,) array
        Crack mouth opening [m], ascending.
    lower, upper : (k,) array
        Loads [N]; the same where the file has one curve.
    back : float
        How far the opening turns back at most in the order of the file [m].
    """

    gauge: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    back: float = 0.0

    @property
    def is_curve(self) -> bool:
        """Whether both loads are the same everywhere."""
        return bool((self.lower == self.upper).all())


def read_measured(
    path: str | Path,
    *,
    units: Sequence[str] = (),
    columns: Sequence[str] = (),
    key: str = KEY,
    plain: bool = True,
) -> MeasuredBand:
    """Read a CSV file of openings and loads, or of openings, smallest and largest loads.

    Columns are separated by commas, semicolons or tabs. With the latter two decimals may have commas, as where
    spreadsheets write them so. Units are in the header, ``CMOD [mm]; load [kN]`` or ``cmod_mm,load_N``, which may be a
    line that starts with ``#``; other lines that do are skipped.

    Parameters
    ----------
    path : path
        The file, UTF-8.
    units : sequence of str, optional
        Units of the columns, instead of those of the header.
    columns : sequence of str, optional
        Names of the columns that are meant, where the file has more.
    key : str, optional
        Where the file is named, for messages.
    plain : bool, optional
        Whether three columns without units are openings in mm and loads in N.

    Raises
    ------
    InputError
        The file cannot be read, a unit is missing, a line does not hold as many finite numbers as there are columns, or
        the largest load is below the smallest.
    """
    path = Path(path)
    text = read_text(path, key, ALLOWED, _MOST_BYTES)
    every = dict(enumerate(text.splitlines(), 1))
    lines = {number: line for number, line in every.items() if line.strip() and line.lstrip()[0] != "#"}
    separator = next((sign for sign in ";\t" if any(sign in line for line in lines.values())), ",")
    names, told = _header(every, lines, separator, path, key)
    used, width = _columns(names, told or units, columns, lines, separator, path, key, plain=plain)
    rows = [_row(line, separator, used, width, f"line {number} of {path}", key) for number, line in lines.items()]
    if not rows:
        raise InputError(key, f"{path} holds no numbers", ALLOWED)
    table = np.array(rows)
    back = float(np.max(np.maximum.accumulate(table[:, 0]) - table[:, 0]))
    table = table[np.lexsort(table.T[::-1])]
    return MeasuredBand(*_ordered(table, used, path, key), back)


def _header(
    every: Mapping[int, str], lines: dict[int, str], separator: str, path: Path, key: str
) -> tuple[list[str], list[str]]:
    """Names of the columns, and units of a line of their own; header lines are taken away from the others."""
    if not lines:
        return [], []
    first = min(lines)
    cells = _cells(lines[first], separator, f"line {first} of {path}", key)
    if all(cell and not is_number(cell, separator) and not _is_odd_number(cell) for cell in cells):
        del lines[first]
        if not lines:
            return cells, []
        second = min(lines)
        units = [cell.strip("[]() ") for cell in _cells(lines[second], separator, f"line {second} of {path}", key)]
        if len(units) == len(cells) and all(unit and unit_of(unit) is not None for unit in units):
            del lines[second]
            return cells, units
        return cells, []
    above = every.get(first - 1, "").strip()
    if above.startswith("#"):
        words = [word.strip() for word in above.lstrip("# ").split(separator)]
        if len(words) == len(cells) and any(columns_named(words)):
            return words, []
    return [], []


def _columns(
    names: list[str],
    units: Sequence[str],
    wanted: Sequence[str],
    lines: Mapping[int, str],
    separator: str,
    path: Path,
    key: str,
    *,
    plain: bool,
) -> tuple[tuple[Column, ...], int]:
    """Columns that are used, and how many there are."""
    if not lines:
        return PLAIN, len(PLAIN)
    if not names:
        first = min(lines)
        count = len(_cells(lines[first], separator, f"line {first} of {path}", key))
        if not units:
            if plain:
                return PLAIN, len(PLAIN)
            raise InputError(key, f"{path} has no units", UNITS)
        names = [f"column {k}" for k in range(1, count + 1)]
    found = columns_of_units(names, units, key) if units else columns_named(names)
    return chosen(found, names, wanted, str(path), key), len(names)


def _cells(line: str, separator: str, where: str, key: str) -> list[str]:
    try:
        (cells,) = csv.reader([line], delimiter=separator)
    except (csv.Error, ValueError):  # a quotation mark that is not closed, a cell of more than 128 kB
        raise InputError(key, f"{where} is {show(line)}", ALLOWED) from None
    return [cell.strip() for cell in cells]


def _row(line: str, separator: str, used: tuple[Column, ...], width: int, where: str, key: str) -> tuple[float, ...]:
    """Numbers of a line in SI units: the length, then the loads."""
    cells = _cells(line, separator, where, key)
    if len(cells) != width:
        hint = ": decimal commas need semicolons or tabs between columns" if len(cells) == 2 * width else ""
        problem = f"{where} has {counted(len(cells), 'value')}, {show(separator.join(cells))}{hint}"
        raise InputError(key, problem, ALLOWED)
    found = tuple(_number(cells[column.place], separator, column, where, key) for column in used)
    if len(used) == 3 and used is PLAIN and found[1] > found[2]:
        raise InputError(key, f"{where}: min_N = {found[1]:g} is above max_N = {found[2]:g}", "min_N at most max_N")
    return found


def _number(cell: str, separator: str, column: Column, where: str, key: str) -> float:
    """One number, no larger than any experiment has."""
    where = f"{where}: {column.name}"
    text = cell if separator == "," else cell.replace(",", ".", 1)
    if not is_number(cell, separator):
        kind = "not finite" if _is_odd_number(text) else "not a number"
        raise InputError(key, f"{where} is {show(cell)}, {kind}", ALLOWED)
    number = float(text) * column.factor
    if abs(number) > _MOST[column.length]:
        most = _MOST[column.length] / column.factor
        raise InputError(key, f"{where} = {show(cell)} is too large", f"{ALLOWED}, {column.name} up to {most:g}")
    return number


def _is_odd_number(text: str) -> bool:
    return re.fullmatch(r"[+-]?(nan|inf(inity)?)", text, re.IGNORECASE) is not None


def _ordered(
    table: NDArray[np.float64], used: tuple[Column, ...], path: Path, key: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Openings, smallest and largest loads."""
    if len(used) == 2:
        return table[:, 0], table[:, 1], table[:, 1]
    low, high = (1, 2) if np.all(table[:, 1] <= table[:, 2]) else (2, 1)
    wrong = np.flatnonzero(table[:, low] > table[:, high])
    if len(wrong):
        names = [used[1].name, used[2].name]
        values = [column[wrong[0]] / of.factor for column, of in zip(table.T[1:], used[1:], strict=True)]
        problem = f"{path}: {names[0]} = {values[0]:g} is above {names[1]} = {values[1]:g}"
        raise InputError(key, problem, f"{names[0]} at most {names[1]} in every line")
    return table[:, 0], table[:, low], table[:, high]
