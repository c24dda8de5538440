"""Comparison of two runs: how far an adaptive run is from its reference, and what it saved."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError, Notice
from fissura.results import quantities as text
from fissura.results.comparable import common_quantity, comparison_notices
from fissura.results.path import NAMES, LoadPath
from fissura.results.peak import peak_position
from fissura.results.result import Result

if TYPE_CHECKING:
    from fissura.case import Quantity

__all__ = ["Comparison", "compare", "compare_results"]

FloatArray = NDArray[np.float64]

logger = logging.getLogger(__name__)

ENERGY = "dissipated energy"


@dataclass(frozen=True, repr=False, eq=False)
class Comparison:
    """Run A (by convention the adaptive one) against run B (the reference).

    Differences are fractions of the value of B, positive where A is larger; nan where B's value is zero or
    unknown.

    Attributes
    ----------
    a, b : Result
        The runs.
    over : str
        What both runs have in common where their loads are compared: ``"gauge"`` or ``"displacement of the load"``, or
        ``"dissipated energy"`` if that of either turns back.
    quantity : str
        Which of the first two it is, or is until it turns back: "gauge" or "displacement"; see
        `fissura.results.comparable.common_quantity`.
    abscissa : (k,) array
        Values of that of both runs together, up to the smaller of their ends [m or J]: gauges and displacements from 0
        on, energies from the first step on at which both have dissipated any.
    load_a, load_b : (k,) array
        Loads there, interpolated linearly, over the quantity from ``(0, 0)`` on [N]. Over energy, loads until the
        quantity of either first turns back are those at the same value of it, and the abscissa has the energy of B at
        it: where damage begins the load over energy is so steep that steps of other lengths would count as a
        difference of the runs.
    max_load_difference : float
        Largest absolute load difference over ``abscissa``, over the magnitude of the peak of B.
    at_max_difference : float
        Where that is [m or J].
    peaks, gauges_at_peak : (float, float)
        Loads of largest magnitude of A and B up to the common end [N], and the quantities at which they occur [m].
    peak_difference, gauge_at_peak_difference : float
        Of these.
    energy_difference : float
        Of the energies dissipated up to the common end; up to the ends of the runs where these are compared over
        energy.
    stiffness_difference : float
        Of the initial stiffnesses; nan if the runs control different quantities, whose stiffnesses these are.
    cpu_ratio : float
        Processor time of B over that of A: above 1, A was faster.
    notices : tuple of Notice
        Warnings: in what the specimens differ, or what does not mean the same in both runs.
    """

    a: Result
    b: Result
    over: str
    quantity: Quantity
    abscissa: FloatArray
    load_a: FloatArray
    load_b: FloatArray
    max_load_difference: float
    at_max_difference: float
    peaks: tuple[float, float]
    gauges_at_peak: tuple[float, float]
    peak_difference: float
    gauge_at_peak_difference: float
    energy_difference: float
    stiffness_difference: float
    cpu_ratio: float
    notices: tuple[Notice, ...] = ()

    @property
    def by_energy(self) -> bool:
        """Whether loads are compared over dissipated energy."""
        return self.over == ENERGY

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value."""
        show = text.energy if self.by_energy else text.length
        start, end = ("0" if x == 0.0 else show(float(x)) for x in self.abscissa[[0, -1]])
        energy = f"{ENERGY} at the ends" if self.by_energy else ENERGY
        why = f"; the {NAMES[self.quantity]} turns back" if self.by_energy else ""
        bodies = [text.count(float(r.curve["bodies"][-1])) for r in (self.a, self.b)]
        seconds = [text.seconds(float(r.curve["cpu_s"][-1])) for r in (self.a, self.b)]
        slower = 0.0 < self.cpu_ratio < 1.0
        faster = (
            f"{text.ratio(1.0 / self.cpu_ratio if slower else self.cpu_ratio)} times {'slower' if slower else 'faster'}"
        )
        return [
            (f"common {self.over} range", f"{start} to {end}{why}"),
            (
                "largest load difference",
                f"{text.per_cent(self.max_load_difference)} of the peak, at {show(self.at_max_difference)}",
            ),
            ("peak load", _pair(text.force, *self.peaks, self.peak_difference)),
            (
                f"{NAMES[self.quantity]} at peak",
                _pair(text.length, *self.gauges_at_peak, self.gauge_at_peak_difference),
            ),
            (energy, text.per_cent(self.energy_difference, signed=True)),
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
                f"{seconds[0]} against {seconds[1]}: {faster}",
            ),
        ]

    def plot(self, path: str | Path) -> None:
        """Draw both curves and their difference as PNG (or another format, by the name's ending)."""
        from fissura.results.pictures import plot_comparison

        plot_comparison(self, Path(path))

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
        A folder is missing or broken, a run has no steps, or the runs have nothing to compare.
    """
    comparison = compare_results(Result.load(a), Result.load(b))
    for notice in comparison.notices:
        logger.warning(notice)
    return comparison


def compare_results(a: Result, b: Result) -> Comparison:
    """Compare two results in memory; see `Comparison`.

    Raises
    ------
    InputError
        The runs have nothing to compare; one has no steps with a positive gauge (or displacement), or that turns back
        though it dissipates nothing.
    """
    quantity = common_quantity(a.case, b.case, _key(a))
    path_a, path_b = (LoadPath.of(run.curve, _key(run), quantity) for run in (a, b))
    grows = path_a.grows and path_b.grows
    (x_a, of_a), (x_b, of_b) = (path.over_value() if grows else path.over_energy() for path in (path_a, path_b))
    # Over energy the elastic part is one point, and where exactly damage begins depends on the steps.
    start, end = 0.0 if grows else max(x_a[1], x_b[1]), min(x_a[-1], x_b[-1])
    if start >= end:
        raise InputError(_key(a), f"has dissipated no energy in common with {_key(b)}", "runs that go on for longer")
    x = np.union1d(x_a, x_b)
    load_a, load_b = np.interp(x, x_a, of_a[0]), np.interp(x, x_b, of_b[0])
    if not grows:
        x, load_a, load_b = _by_value_before_turning(path_a, path_b, x, load_a, load_b)
    common = (x >= start) & (x <= end)
    x, load_a, load_b = x[common], load_a[common], load_b[common]
    (peak_a, at_a), (peak_b, at_b) = _peak(x_a, of_a, end), _peak(x_b, of_b, end)
    worst = np.abs(load_a - load_b).argmax()
    ends = [np.interp(end, x, of[2]) if grows else of[2][-1] for x, of in ((x_a, of_a), (x_b, of_b))]
    return Comparison(
        a=a,
        b=b,
        over=path_a.name if grows else ENERGY,
        quantity=quantity,
        abscissa=x,
        load_a=load_a,
        load_b=load_b,
        max_load_difference=abs(_fraction(load_a[worst] - load_b[worst], peak_b)),
        at_max_difference=float(x[worst]),
        peaks=(peak_a, peak_b),
        gauges_at_peak=(at_a, at_b),
        peak_difference=_difference(peak_a, peak_b),
        gauge_at_peak_difference=_difference(at_a, at_b),
        energy_difference=_difference(*ends),
        stiffness_difference=(
            _difference(a.initial_stiffness, b.initial_stiffness) if a.case.quantity == b.case.quantity else math.nan
        ),
        cpu_ratio=_fraction(b.curve["cpu_s"][-1], a.curve["cpu_s"][-1]),
        notices=comparison_notices(a.case, b.case, quantity),
    )


def _by_value_before_turning(
    a: LoadPath, b: LoadPath, x: FloatArray, load_a: FloatArray, load_b: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Energies, and loads of A and B at them, with loads at the same value until that of either run turns back."""
    (value_a, of_a), (value_b, of_b) = a.until_turning(), b.until_turning()
    turn = min(value_a[-1], value_b[-1])
    value = np.union1d(value_a, value_b)
    value = value[value <= turn]
    energy = np.maximum.accumulate(np.interp(value, value_b, of_b[1]))
    after = x > max(energy[-1], np.interp(turn, value_a, of_a[1]))
    return (
        np.append(energy, x[after]),
        np.append(np.interp(value, value_a, of_a[0]), load_a[after]),
        np.append(np.interp(value, value_b, of_b[0]), load_b[after]),
    )


def _peak(x: FloatArray, of: FloatArray, end: float) -> tuple[float, float]:
    """Load of largest magnitude up to an end, and the gauge or displacement there."""
    at = np.append(x[x < end], end)
    loads = np.interp(at, x, of[0])
    k = peak_position(loads)
    return float(loads[k]), float(np.interp(at[k], x, of[1]))


def _key(result: Result) -> str:
    return str(result.folder or result.case.name)


def _difference(a: float, b: float) -> float:
    return _fraction(a - b, b)


def _fraction(part: float, whole: float) -> float:
    return float(part / whole) if whole else math.nan


def _pair(show: text.Formatter, a: float, b: float, difference: float) -> str:
    return f"{show(float(a))} against {show(float(b))} ({text.per_cent(difference, signed=True)})"
