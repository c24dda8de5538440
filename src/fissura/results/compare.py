"""Comparison of two runs: how far an adaptive run is from its reference, and what it saved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.results import quantities as text
from fissura.results.result import Result

__all__ = ["Comparison", "compare", "compare_results"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Comparison:
    """Run A (by convention the adaptive one) against run B (the reference).

    Differences are fractions of the value of B, positive where A is larger; nan where B's value is zero or
    unknown.

    Attributes
    ----------
    a, b : Result
        The runs.
    gauge : (k,) array
        Gauge values of both runs together, from 0 to the smaller of their ends [m].
    load_a, load_b : (k,) array
        Loads there, interpolated linearly from ``(0, 0)`` on [N].
    max_load_difference : float
        Largest absolute load difference over ``gauge``, over the peak of B there.
    gauge_of_max_difference : float
        Where that is [m].
    peak_difference, gauge_at_peak_difference : float
        Of the largest loads over the common gauges, and of the gauges at which they occur.
    energy_difference : float
        Of the energies dissipated up to the common end.
    stiffness_difference : float
        Of the initial stiffnesses.
    cpu_ratio : float
        Processor time of B over that of A: above 1, A was faster.
    """

    a: Result
    b: Result
    gauge: FloatArray
    load_a: FloatArray
    load_b: FloatArray
    max_load_difference: float
    gauge_of_max_difference: float
    peak_difference: float
    gauge_at_peak_difference: float
    energy_difference: float
    stiffness_difference: float
    cpu_ratio: float

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value."""
        where = text.length(self.gauge_of_max_difference)
        bodies = [text.count(float(r.curve["bodies"][-1])) for r in (self.a, self.b)]
        seconds = [text.seconds(float(r.curve["cpu_s"][-1])) for r in (self.a, self.b)]
        return [
            ("common gauge range", f"0 to {text.length(float(self.gauge[-1]))}"),
            (
                "largest load difference",
                f"{text.per_cent(self.max_load_difference)} of the peak, at {where}",
            ),
            ("peak load", _pair(text.force, self.load_a.max(), self.load_b.max(), self.peak_difference)),
            (
                "gauge at peak",
                _pair(text.length, *self._gauges_at_peak(), self.gauge_at_peak_difference),
            ),
            ("dissipated energy", text.per_cent(self.energy_difference, signed=True)),
            (
                "initial stiffness",
                _pair(
                    text.stiffness,
                    self.a.initial_stiffness,
                    self.b.initial_stiffness,
                    self.stiffness_difference,
                ),
            ),
            ("bodies at the end", f"{bodies[0]} against {bodies[1]}"),
            (
                "processor time",
                f"{seconds[0]} against {seconds[1]}: {text.ratio(self.cpu_ratio)} times faster",
            ),
        ]

    def plot(self, path: str | Path) -> None:
        """Draw both curves and their difference as PNG (or another format, by the name's ending)."""
        from fissura.results.pictures import plot_comparison

        plot_comparison(self, Path(path))

    def _gauges_at_peak(self) -> tuple[float, float]:
        return float(self.gauge[self.load_a.argmax()]), float(self.gauge[self.load_b.argmax()])

    def __repr__(self) -> str:
        width = max(len(name) for name, _ in self.table())
        return "\n".join(f"{name:<{width}}  {value}" for name, value in self.table())


def compare(a: str | Path, b: str | Path) -> Comparison:
    """Compare two result folders.

    Parameters
    ----------
    a, b : str or Path
        Folders of the adaptive run and of the reference.

    Raises
    ------
    InputError
        A folder is missing or broken, or a run has no steps.
    """
    return compare_results(Result.load(a), Result.load(b))


def compare_results(a: Result, b: Result) -> Comparison:
    """Compare two results in memory; see `Comparison`.

    Raises
    ------
    InputError
        A run has no steps with a positive gauge.
    """
    (gauge_a, load_a, energy_a), (gauge_b, load_b, energy_b) = _from_origin(a), _from_origin(b)
    end = min(gauge_a[-1], gauge_b[-1])
    gauge = np.union1d(gauge_a, gauge_b)
    gauge = gauge[gauge <= end]
    of_a, of_b = np.interp(gauge, gauge_a, load_a), np.interp(gauge, gauge_b, load_b)
    peak_a, peak_b = of_a.argmax(), of_b.argmax()
    worst = np.abs(of_a - of_b).argmax()
    return Comparison(
        a=a,
        b=b,
        gauge=gauge,
        load_a=of_a,
        load_b=of_b,
        max_load_difference=abs(_fraction(of_a[worst] - of_b[worst], of_b[peak_b])),
        gauge_of_max_difference=float(gauge[worst]),
        peak_difference=_difference(of_a[peak_a], of_b[peak_b]),
        gauge_at_peak_difference=_difference(gauge[peak_a], gauge[peak_b]),
        energy_difference=_difference(np.interp(end, gauge_a, energy_a), np.interp(end, gauge_b, energy_b)),
        stiffness_difference=_difference(a.initial_stiffness, b.initial_stiffness),
        cpu_ratio=_fraction(b.curve["cpu_s"][-1], a.curve["cpu_s"][-1]),
    )


def _from_origin(result: Result) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauge, load and dissipated energy with the state before the first step in front."""
    gauge = result.gauge
    if not len(gauge) or not gauge[-1] > 0:
        key = str(result.folder or result.case.name)
        raise InputError(key, "has no step with a positive gauge", "a run of at least one step")
    assert np.all(np.diff(gauge, prepend=0.0) > 0), "the controlled quantity grows from step to step"
    loads, energies = result.load_values, result.curve["dissipated_J"].astype(np.float64)
    return np.append(0.0, gauge), np.append(0.0, loads), np.append(0.0, energies)


def _difference(a: float, b: float) -> float:
    return _fraction(a - b, b)


def _fraction(part: float, whole: float) -> float:
    return float(part / whole) if whole else math.nan


def _pair(show: text.Formatter, a: float, b: float, difference: float) -> str:
    return f"{show(float(a))} against {show(float(b))} ({text.per_cent(difference, signed=True)})"
