"""What the loads and gauges of a case are called in pictures, tables and progress, and columns by users."""

import difflib
from collections.abc import Iterable, Sequence

from fissura.case import Case, Quantity
from fissura.case.programme import GRAVITY
from fissura.errors import InputError
from fissura.results.curve import TEXTS
from fissura.simulation.step import Step
from fissura.text.units import split_unit

#: Names that are told one by one, at most.
_TOLD = 3


def load_name(case: Case, ratios: Sequence[tuple[str, float]] | None = None) -> str:
    """Name of the load of the last stage, or of another one.

    Parameters
    ----------
    case : Case
        What is run.
    ratios : sequence of (str, float), optional
        Loads that a stage drives; those of the last one by default.

    Returns
    -------
    str
        "load" where it needs no name, else the names of all that are driven.
    """
    names = [name for name, _ in (case.main.ratios if ratios is None else ratios)]
    if names == ["load"]:
        return "load"
    told = names if len(names) <= _TOLD else [*names[: _TOLD - 1], "..."]
    return f"load ({', '.join(told)})"


def value_axis(case: Case, quantity: Quantity) -> str:
    """What an axis of the gauge of the last stage, or of the displacement of its load, is called, without its unit."""
    if quantity == "displacement":
        return "displacement of the load"
    gauge = case.main.gauge
    return "gauge opening" if gauge in (None, "gauge") else f"gauge {gauge}"


def driven_in(case: Case, step: Step) -> tuple[str, float]:
    """Name and load factor [N] of what a step drives."""
    ratios = case.stages[step.stage - 1].ratios if step.stage else ((GRAVITY, 1.0),)
    if ratios == case.main.ratios:
        return load_name(case), step.load
    factor = sum(ratio * step.forces[name] for name, ratio in ratios) / sum(ratio**2 for _, ratio in ratios)
    return load_name(case, ratios), factor


def column_named(columns: Iterable[str], name: str, key: str) -> str:
    """The column that is meant: its name may be without the unit.

    Parameters
    ----------
    columns : iterable of str
        Those that there are.
    name : str
        What was asked for.
    key : str
        Where, for the message.

    Raises
    ------
    InputError
        There is none, or it holds words.

    Examples
    --------
    >>> column_named(["gauge_m", "load_N"], "load", "y")
    'load_N'
    """
    if name in TEXTS:
        raise InputError(key, f"{name!r} holds words", ", ".join(column for column in columns if column not in TEXTS))
    return column_among([column for column in columns if column not in TEXTS], name, key)


def column_among(columns: Sequence[str], name: str, key: str, of: str = "the curve") -> str:
    """The column that is meant: its name may be without the unit.

    Raises
    ------
    InputError
        There is none.
    """
    found = [column for column in columns if name in (column, split_unit(column)[0])]
    if found:
        return found[0]
    near = difflib.get_close_matches(str(name), [*columns, *(split_unit(column)[0] for column in columns)], n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise InputError(key, f"{name!r} is no column of {of}{hint}", ", ".join(columns))
