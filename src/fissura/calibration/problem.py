"""What a calibration asks for: unknown keys of a case, and the tests whose curves they are to explain."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case, Quantity
from fissura.case.points import Value, points_of
from fissura.case.units import ACCELERATION, DENSITY, DURATION, ENERGY_PER_AREA, FORCE, LENGTH, STRESS, Dimension, told
from fissura.errors import InputError
from fissura.results.measured import MeasuredBand

_DIMENSIONS = (STRESS, ENERGY_PER_AREA, LENGTH, FORCE, DENSITY, ACCELERATION, DURATION)


@dataclass(frozen=True)
class Unknown:
    """A key of the case that is to be found.

    Attributes
    ----------
    key : str
        Dotted key.
    start, lower, upper : float
        Where the search begins, and between which values it stays; SI units.
    dimension : Dimension or None
        In which it is told; None for a pure number.
    """

    key: str
    start: float
    lower: float
    upper: float
    dimension: Dimension | None = None

    @property
    def log(self) -> bool:
        """Whether the search goes over its logarithm: steps are relative then."""
        return self.lower > 0.0

    def coordinate(self, value: float) -> float:
        """Coordinate of a value in the search."""
        return float(np.log(value)) if self.log else (value - self.lower) / (self.upper - self.lower)

    def value(self, coordinate: float) -> float:
        """Value at a coordinate, within the bounds."""
        return min(max(self.value_beyond(coordinate), self.lower), self.upper)

    def value_beyond(self, coordinate: float) -> float:
        """Value at a coordinate, which may be beyond the bounds."""
        return float(np.exp(coordinate)) if self.log else self.lower + coordinate * (self.upper - self.lower)

    def slope(self, value: float) -> float:
        """Derivative of the value by its coordinate."""
        return value if self.log else self.upper - self.lower

    def told(self, value: float) -> str:
        """A value with its unit, four digits."""
        return f"{value:.4g}" if self.dimension is None else told(value, self.dimension)

    @property
    def name(self) -> str:
        """Last part of the key."""
        return self.key.rpartition(".")[2]


@dataclass(frozen=True)
class Test:
    """A test: a case, and what was measured.

    Attributes
    ----------
    name : str
        Its name, which folders have, too.
    case : Case
        How it is computed.
    measured : tuple of MeasuredBand
        One curve for each specimen, a mean curve, or one band.
    weight : float
        How much it counts.
    specimens : int
        How many specimens are behind what was measured.
    quantity : {"gauge", "displacement"}
        What loads were measured over.
    until : float
        Up to where they are compared [m].
    """

    name: str
    case: Case
    measured: tuple[MeasuredBand, ...]
    weight: float
    specimens: int
    quantity: Quantity
    until: float = np.inf

    __test__ = False  # it is no test of pytest


@dataclass(frozen=True)
class Problem:
    """A calibration.

    Attributes
    ----------
    name : str
        Its name.
    unknowns : tuple of Unknown
    tests : tuple of Test
    """

    name: str
    unknowns: tuple[Unknown, ...]
    tests: tuple[Test, ...]

    @property
    def start(self) -> FloatArray:
        """Coordinates where the search begins, shape (m,)."""
        return np.array([unknown.coordinate(unknown.start) for unknown in self.unknowns])

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest coordinates, shape (m,) each."""
        return (
            np.array([unknown.coordinate(unknown.lower) for unknown in self.unknowns]),
            np.array([unknown.coordinate(unknown.upper) for unknown in self.unknowns]),
        )

    def values(self, coordinates: FloatArray) -> dict[str, float]:
        """Values of the unknowns at coordinates, shape (m,)."""
        pairs = zip(self.unknowns, coordinates.tolist(), strict=True)
        return {unknown.key: unknown.value(coordinate) for unknown, coordinate in pairs}

    def as_dict(self) -> dict[str, Any]:
        """Plain data: what decides the numbers."""
        return {
            "unknowns": {u.key: {"start": u.start, "lower": u.lower, "upper": u.upper} for u in self.unknowns},
            "tests": {
                test.name: {
                    "case": test.case.model_dump(mode="json", exclude={"source", "name", "output", "ensemble"}),
                    "measured": [
                        {"gauge_m": band.gauge.tolist(), "low_N": band.lower.tolist(), "high_N": band.upper.tolist()}
                        for band in test.measured
                    ],
                    "weight": test.weight,
                    "specimens": test.specimens,
                    "over": test.quantity,
                    "until_m": test.until if np.isfinite(test.until) else None,
                }
                for test in self.tests
            },
        }


def number_of(case: Case, key: str, given: Any, where: str) -> float:
    """The number that a key gets from what was given for it.

    Raises
    ------
    InputError
        The key is not known, or the value is wrong, or no number.
    """
    try:
        (point,) = points_of(case, {key: (given,)})
    except InputError as error:
        raise InputError(f"{where} {error.key.removeprefix('vary ')}", error.problem, error.allowed) from None
    value: Value = point.values[key]
    if isinstance(value, str):
        raise InputError(f"{where} {key}", "holds no number", "keys whose value is a number")
    return value


def dimension_of(case: Case, key: str, value: float) -> Dimension | None:
    """The dimension of a key, found by trying which units it takes; None for a pure number."""
    for dimension in _DIMENSIONS:
        try:
            points_of(case, {key: (f"{value!r} {dimension.unit}",)})
        except InputError:
            continue
        return dimension
    return None
