"""Measured load bands to show next to a computed curve."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fissura.case.files import read_text
from fissura.case.units import show
from fissura.errors import InputError

__all__ = ["MeasuredBand", "read_measured"]

KEY = "output.measured"
COLUMNS = ("cmod_mm", "min_N", "max_N")
ALLOWED = "a CSV file of cmod_mm,min_N,max_N"

#: Largest values of the columns, and largest file.
_MOST, _MOST_BYTES = (1e7, 1e15, 1e15), 20_000_000

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True)
class MeasuredBand:
    """Smallest and largest measured load over the gauge.

    Attributes
    ----------
    gauge : (k,) array
        Crack mouth opening [m], ascending.
    lower, upper : (k,) array
        Loads [N].
    """

    gauge: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]


def read_measured(path: str | Path) -> MeasuredBand:
    """Read a CSV file of columns ``cmod_mm,min_N,max_N``; lines that start with ``#`` are skipped.

    Columns are separated by commas, semicolons or tabs. With the latter two decimals may have commas, as where
    spreadsheets write them so.

    Raises
    ------
    InputError
        The file cannot be read, or has a line that is not three finite numbers, or the largest load below the smallest.
    """
    path = Path(path)
    text = read_text(path, KEY, ALLOWED, _MOST_BYTES)
    lines = {
        number: line for number, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"
    }
    separator = next((sign for sign in ";\t" if any(sign in line for line in lines.values())), ",")
    rows = []
    for first, (number, line) in enumerate(lines.items()):
        where = f"line {number} of {path}"
        try:
            (cells,) = csv.reader([line], delimiter=separator)
        except (csv.Error, ValueError):  # a quotation mark that is not closed, a cell of more than 128 kB
            raise InputError(KEY, f"{where} is {show(line)}", ALLOWED) from None
        cells = [cell.strip() for cell in cells]
        if not first and tuple(cells) == COLUMNS:
            continue
        rows.append(_row(cells, separator, where))
    if not rows:
        raise InputError(KEY, f"{path} holds no numbers", ALLOWED)
    table = np.array(sorted(rows))
    return MeasuredBand(table[:, 0] * 1e-3, table[:, 1], table[:, 2])


def _row(cells: list[str], separator: str, where: str) -> tuple[float, float, float]:
    """Three numbers of a line."""
    if len(cells) != len(COLUMNS):
        hint = ": decimal commas need semicolons or tabs between columns" if len(cells) == 2 * len(COLUMNS) else ""
        problem = f"{where} has {len(cells)} value{'s' if len(cells) != 1 else ''}, {show(separator.join(cells))}{hint}"
        raise InputError(KEY, problem, ALLOWED)
    cmod, lower, upper = (
        _number(cell, separator, most, f"{where}: {name}")
        for cell, most, name in zip(cells, _MOST, COLUMNS, strict=True)
    )
    if lower > upper:
        raise InputError(KEY, f"{where}: min_N = {lower:g} is above max_N = {upper:g}", "min_N at most max_N")
    return cmod, lower, upper


def _number(cell: str, separator: str, most: float, where: str) -> float:
    """One number, no larger than any experiment has."""
    text = cell if separator == "," else cell.replace(",", ".", 1)
    if _NUMBER.fullmatch(text) is None:
        kind = "not finite" if re.fullmatch(r"[+-]?(nan|inf(inity)?)", text, re.IGNORECASE) else "not a number"
        raise InputError(KEY, f"{where} is {show(cell)}, {kind}", ALLOWED)
    number = float(text)
    if abs(number) > most:
        raise InputError(KEY, f"{where} = {show(cell)} is too large", f"{ALLOWED}, {where.split()[-1]} up to {most:g}")
    return number
