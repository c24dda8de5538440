"""What the columns of a file of measured loads are: names and units, from its header or as they are told."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from fissura.case.units import FORCE, LENGTH, show, to_si
from fissura.errors import InputError

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")

#: A unit at the end of a name: "CMOD [mm]", "load (kN)", "load / kN", "load in kN", "cmod_mm".
_UNIT = re.compile(r"(.*?)(?:\s*[\[(]\s*([^\[\]()]+?)\s*[\])]|\s*/\s*([^\s/]+)|\s+in\s+(\S+)|_([A-Za-zµμ]+))\s*")

_OWN = ("gauge_m", "load_N")

UNITS = 'units in the header, such as "CMOD [mm]; load [kN]" or "cmod_mm,load_N", or told as units'


@dataclass(frozen=True)
class Column:
    """A column of measured values.

    Attributes
    ----------
    name : str
        Its name, with its unit if the header has it.
    place : int
        Which column it is, from 0.
    factor : float
        From the unit of the file to SI units.
    length : bool
        Whether it holds lengths; else forces.
    """

    name: str
    place: int
    factor: float
    length: bool


PLAIN = (Column("cmod_mm", 0, 1e-3, True), Column("min_N", 1, 1.0, False), Column("max_N", 2, 1.0, False))
"""Columns of files that say nothing about them."""


def is_number(cell: str, separator: str) -> bool:
    """Whether a cell holds a number, with a decimal comma where commas do not separate columns."""
    text = cell if separator == "," else cell.replace(",", ".", 1)
    return _NUMBER.fullmatch(text) is not None


def unit_of(unit: str) -> tuple[float, bool] | None:
    """Factor to SI units, and whether it is a unit of length; None for units of anything but lengths and forces."""
    for dimension in (LENGTH, FORCE):
        try:
            return to_si(f"1 {unit}", dimension), dimension is LENGTH
        except ValueError:
            continue
    return None


def columns_named(names: Sequence[str]) -> list[Column | None]:
    """Columns of a header; None for those without a unit of length or force."""
    found: list[Column | None] = []
    for place, name in enumerate(names):
        match = _UNIT.fullmatch(name)
        unit = next((part for part in match.groups()[1:] if part), None) if match else None
        known = None if unit is None else unit_of(unit)
        found.append(None if known is None else Column(name, place, *known))
    return found


def columns_of_units(names: Sequence[str], units: Sequence[str], key: str) -> list[Column | None]:
    """Columns whose units are told: one for each, or one for lengths and one for all others.

    Raises
    ------
    InputError
        There are too few units, or one is not of a length or a force.
    """
    if len(units) == 2 and len(names) == 3:
        units = [units[0], units[1], units[1]]
    if len(units) != len(names):
        raise InputError(key, f"{len(units)} units are told for {len(names)} columns", "one unit for each column")
    found: list[Column | None] = []
    for place, (name, unit) in enumerate(zip(names, units, strict=True)):
        known = unit_of(unit)
        if known is None:
            raise InputError(key, f"{show(unit)} is no unit of a length or a force", "units such as mm and kN")
        found.append(Column(name, place, *known))
    return found


def chosen(
    columns: Sequence[Column | None], names: Sequence[str], wanted: Sequence[str], path: str, key: str
) -> tuple[Column, ...]:
    """One column of lengths, then one or two of loads.

    Parameters
    ----------
    columns : sequence of Column or None
        Those of the file.
    names : sequence of str
        Their names.
    wanted : sequence of str
        Names of those that are meant, with or without units; empty for all.
    path, key : str
        For messages.

    Raises
    ------
    InputError
        A unit is missing, or there is no such choice.
    """
    if wanted:
        places = [_place(name, names, path, key) for name in wanted]
    elif set(_OWN) <= set(names):  # a curve.csv of Fissura
        places = [names.index(name) for name in _OWN]
    elif len(columns) in (2, 3):
        places = list(range(len(columns)))
    else:
        allowed = "two columns or three (smallest and largest load), or the names of those that are meant"
        raise InputError(key, f"{path} has {len(columns)} columns: {show(', '.join(names))}", allowed)
    found = []
    for place in places:
        column = columns[place]
        if column is None:
            raise InputError(key, f"{path}: column {show(names[place])} has no unit", UNITS)
        found.append(column)
    lengths, loads = [c for c in found if c.length], [c for c in found if not c.length]
    if len(lengths) != 1 or not 1 <= len(loads) <= 2:
        problem = f"{path} has {len(lengths)} columns of lengths and {len(loads)} of forces"
        raise InputError(key, problem, "one of lengths, and one or two of forces")
    return (*lengths, *loads)


def _place(name: str, names: Sequence[str], path: str, key: str) -> int:
    for k, known in enumerate(names):
        match = _UNIT.fullmatch(known)
        if name in (known, match[1].strip() if match else known):
            return k
    raise InputError(key, f"{path} has no column {show(name)}", ", ".join(names))
