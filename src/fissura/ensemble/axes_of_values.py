"""Axes of pictures over the values of a varied key: numbers in the unit they were given in, or words side by side."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.axes import Axes

from fissura.case.points import Value
from fissura.pictures.lettering import literal

if TYPE_CHECKING:
    from fissura.ensemble.plan import Plan

_GIVEN = re.compile(r"\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*(\S.*?)\s*")


@dataclass(frozen=True)
class ValueAxis:
    """An axis over the values of a key.

    Attributes
    ----------
    name : str
        What stands beside it.
    factor : float
        From SI units to the unit that is shown.
    words : tuple of str
        The values side by side, if not all are numbers.
    """

    name: str
    factor: float = 1.0
    words: tuple[str, ...] = ()

    def place(self, value: Value) -> float:
        """Where a value is drawn."""
        return float(self.words.index(str(value))) if self.words else float(value) * self.factor

    def label(self, axes: Axes) -> None:
        """Label the axis."""
        axes.set_xlabel(literal(self.name))
        if self.words:
            axes.set_xticks(range(len(self.words)), [literal(word) for word in self.words])
            axes.set_xlim(-0.5, len(self.words) - 0.5)


def value_axis_of(plan: Plan, key: str) -> ValueAxis:
    """The axis of a varied key: in the unit of its first value that has one, else in SI units."""
    values = [point.values[key] for point in plan.points]
    if any(isinstance(value, str) for value in values):
        return ValueAxis(key, words=tuple(dict.fromkeys(map(str, values))))
    for point, value in zip(plan.points, values, strict=True):
        found = _GIVEN.fullmatch(point.given[key])
        if found and float(found[1]) and isinstance(value, float) and value:
            return ValueAxis(f"{key} [{found[2]}]", float(found[1]) / value)
    return ValueAxis(key)
