"""The cases of a parameter study: one case with the values of some keys changed, point by point."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from math import prod
from typing import Any, TypeAlias

from fissura.case.changed import changed, value_at
from fissura.case.ensemble import Combine, Varied
from fissura.case.model import Case
from fissura.case.units import show
from fissura.errors import InputError

Value: TypeAlias = float | str
"""A value as tables have it: numbers in SI units, everything else as text."""

MOST_POINTS = 10_000
"""Most points of a study: the case of each is made and validated before the first run."""

#: Keys that do not change what is computed, or that an ensemble sets itself.
_FIXED = ("name", "output", "ensemble", "seed", "field.seed", "field.leading", "solver.threads")


@dataclass(frozen=True)
class Point:
    """One point of a parameter study.

    Attributes
    ----------
    values : dict of str to float or str
        Value of each varied key; numbers in SI units.
    case : Case
        What is run there.
    given : dict of str to str
        The values as they were given.
    """

    values: dict[str, Value]
    case: Case
    given: dict[str, str] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The values as they were given, by the last part of their keys, or by whole keys where that is not enough."""
        names = {key: key.rpartition(".")[2] for key in self.given}
        short = len(set(names.values())) == len(names)
        return ", ".join(f"{names[key] if short else key} = {text}" for key, text in self.given.items())


def points_of(case: Case, vary: Varied, combine: Combine = "grid") -> tuple[Point, ...]:
    """All points of a study, each with its case validated; the case itself where nothing is varied.

    Parameters
    ----------
    case : Case
        Where all other values come from.
    vary : mapping of str to tuple
        Values by dotted key, as a case file gives them.
    combine : {"grid", "together"}
        All combinations, the last key changing first; or the first value of every key, then the second, and so on.

    Raises
    ------
    InputError
        A key is not known or cannot be varied, a value is wrong or there twice, lists that go together differ in
        length, or there are too many points; the key is the varied one.

    Examples
    --------
    >>> [point.values["material.f_t"] for point in points_of(case, {"material.f_t": ("2 MPa", "3 MPa")})]
    [2000000.0, 3000000.0]
    """
    base = case.model_copy(update={"ensemble": None}) if case.ensemble is not None else case
    if not vary:
        return (Point({}, base),)
    for key in vary:
        _check_key(key)
    count = prod(map(len, vary.values())) if combine == "grid" else max(map(len, vary.values()))
    if count > MOST_POINTS:
        raise InputError("vary", f"{count} points are too many", f"at most {MOST_POINTS}")
    if combine == "together" and len({len(values) for values in vary.values()}) > 1:
        lengths = ", ".join(f"{key} has {len(values)}" for key, values in vary.items())
        raise InputError("vary", f"lists that go together differ in length: {lengths}", "lists of the same length")
    found = tuple(_point(base, dict(zip(vary, values, strict=True))) for values in _combinations(vary, combine))
    seen: dict[str, None] = {}
    for point in found:
        text = json.dumps(point.values)
        if text in seen:
            raise InputError("vary", f"{point.label} is there twice", "every point once")
        seen[text] = None
    return found


def _combinations(vary: Varied, combine: Combine) -> Iterator[tuple[Any, ...]]:
    return product(*vary.values()) if combine == "grid" else zip(*vary.values(), strict=True)


def _check_key(key: str) -> None:
    for fixed in _FIXED:
        if key == fixed or key.startswith(f"{fixed}."):
            raise InputError(f"vary {key}", "is set by the ensemble, or changes no result", "other keys of the case")


def _point(case: Case, values: Mapping[str, Any]) -> Point:
    try:
        found = changed(case, values)
    except InputError as error:
        others = ", ".join(f"{key} = {show(value)}" for key, value in values.items() if key != error.key)
        problem = f"{error.problem} (with {others})" if others else error.problem
        raise InputError(f"vary {error.key}", problem, error.allowed) from None
    given = {key: value if isinstance(value, str) else show(value) for key, value in values.items()}
    return Point({key: _value(found, key, value) for key, value in values.items()}, found, given)


def _value(case: Case, key: str, given: Any) -> Value:
    """The value of a key as a table has it."""
    value = value_at(case, key)
    if isinstance(value, tuple) and len(value) == 1:  # one correlation length, where three may stand
        (value,) = value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return float(f"{value:.12g}")  # round-off of units, and of constants that are kept as others
    return given if isinstance(given, str) else show(given)
