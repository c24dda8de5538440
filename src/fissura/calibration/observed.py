"""Measured and computed curves on common points: evenly along the measured curve, not along its gauge.

Points that are even over the gauge would be few on the steep rise and many on the long tail. Along the arc of the
curve, gauge and load each over their largest value, rise, peak and tail count by their length in the picture.
"""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.calibration.problem import Test
from fissura.errors import InputError
from fissura.results.load_path import LoadPath

POINTS = 60
"""Points at which loads are compared, of each test."""

#: Intervals over which noisy measurements are averaged, and how far the gauge may turn back, over its range.
_BINS, _BACK = 240, 0.02

#: Standard deviation over the peak below which a band counts as no narrower.
_NARROW = 0.02

#: Expected range of so many independent Gaussian values, over their standard deviation.
_RANGE = {2: 1.128, 3: 1.693, 4: 2.059, 5: 2.326, 6: 2.534, 7: 2.704, 8: 2.847, 9: 2.970, 10: 3.078}


@dataclass(frozen=True)
class Observed:
    """What was measured in one test, at the points where it is compared.

    Attributes
    ----------
    x : (n,) array
        Gauge or displacement [m], ascending.
    load : (n,) array
        Mean measured load, or middle of the band [N].
    curves : (specimens, n) array
        Loads of single specimens [N]; one row for a mean curve or a band.
    lower, upper : (n,) array
        Smallest and largest of them, or the band [N].
    peak : float
        Largest magnitude of `load` [N]: residuals are told over it.
    deviation : (n,) array
        Standard deviation of one specimen as the band tells it [N]: its width over the expected range of that many
        specimens; 0 without a band.
    emphasis : (n,) array
        How much each point counts, mean square 1: the more, the narrower a band is there; 1 without a band.
    """

    x: FloatArray
    load: FloatArray
    curves: FloatArray
    lower: FloatArray
    upper: FloatArray
    peak: float
    deviation: FloatArray
    emphasis: FloatArray


def observed(test: Test) -> Observed:
    """Put the measured curves of a test on common points.

    Raises
    ------
    InputError
        A gauge turns back, curves have no common range, or none in common with what is computed.
    """
    key = f"measured of {test.name}"
    for band in test.measured:
        extent = float(np.ptp(band.gauge))
        if len(band.gauge) < 3 or not extent > 0.0:
            raise InputError(key, f"has {len(band.gauge)} points over {extent:g} m", "at least 3 at different openings")
        if band.back > _BACK * extent:
            problem = f"its gauge turns back, by {100 * band.back / extent:.0f} % of its range"
            raise InputError(key, problem, "a gauge that grows: of cycles the envelope, without unloading")
    low = max(0.0, *(float(band.gauge[0]) for band in test.measured))
    high = min(test.until, *(float(band.gauge[-1]) for band in test.measured))
    target = _target(test)
    high = high if target is None else min(high, target)
    if not high > low:
        end = "" if target is None else f"; the computed one ends at {target:g} m"
        spans = ", ".join(f"{band.gauge[0]:g} to {band.gauge[-1]:g} m" for band in test.measured[:5])
        raise InputError(
            key, f"the measured range ({spans}) has nothing to be compared with{end}", "ranges that overlap"
        )
    fine = np.linspace(low, high, _BINS + 1)
    lower = np.stack([_resampled(band.gauge, band.lower, fine) for band in test.measured])
    upper = np.stack([_resampled(band.gauge, band.upper, fine) for band in test.measured])
    curves = 0.5 * (lower + upper)
    x = _along(fine, curves.mean(axis=0))
    on = [np.stack([np.interp(x, fine, row) for row in rows]) for rows in (curves, lower, upper)]
    load = on[0].mean(axis=0)
    peak = float(np.abs(load).max())
    if not peak > 0.0:
        raise InputError(key, "all loads are 0", "loads that grow with the gauge")
    smallest, largest = on[1].min(axis=0), on[2].max(axis=0)
    single = len(test.measured) == 1
    width = (largest - smallest) if single else np.zeros_like(load)
    deviation = width / _RANGE[min(max(test.specimens, 2), 10)]
    emphasis = 1.0 / np.maximum(deviation, _NARROW * peak)
    emphasis /= np.sqrt(np.mean(emphasis**2))
    return Observed(x, load, on[0], smallest, largest, peak, deviation, emphasis)


def _target(test: Test) -> float | None:
    """Where the computed curve ends at the latest; None where its case does not say it over this quantity."""
    case = test.case
    return case.control.target if case.control is not None and case.quantity == test.quantity else None


def _resampled(x: FloatArray, y: FloatArray, fine: FloatArray) -> FloatArray:
    """Loads at fine points: means around them where there are several, interpolated where there are none."""
    x, inverse = np.unique(x, return_inverse=True)
    y = np.bincount(inverse, y) / np.bincount(inverse)
    if len(x) <= 2 * _BINS:
        return np.interp(fine, x, y)
    edges = np.concatenate([[-np.inf], 0.5 * (fine[1:] + fine[:-1]), [np.inf]])
    places = np.digitize(x, edges) - 1
    count = np.bincount(places, minlength=len(fine))
    some = count > 0
    means = np.bincount(places, y, minlength=len(fine))[some] / count[some]
    middles = np.bincount(places, x, minlength=len(fine))[some] / count[some]
    return np.interp(fine, middles, means)


def _along(x: FloatArray, y: FloatArray) -> FloatArray:
    """Points evenly along a curve, both axes over their largest value; noise is smoothed before."""
    kernel = np.hanning(9)[1:-1]
    smooth = np.convolve(np.pad(y, 3, mode="edge"), kernel / kernel.sum(), mode="valid")
    arc = np.hypot(np.diff(x) / np.abs(x).max(), np.diff(smooth) / max(np.abs(smooth).max(), 1e-300))
    return np.asarray(np.interp(np.linspace(0.0, 1.0, POINTS), np.append(0.0, np.cumsum(arc)) / arc.sum(), x))


def at_points(path: LoadPath, x: FloatArray) -> FloatArray:
    """Loads of a run at points, shape (n,) [N]; nan beyond its end.

    Where the gauge turns back, as in snap-back, the load counts with which a point is reached for the first time, as in
    a test under control of the gauge.
    """
    reached = np.maximum.accumulate(path.value)
    first = np.append(True, np.diff(reached) > 0)
    return np.asarray(np.interp(x, reached[first], path.load[first], right=np.nan))


def inside(test: Observed, load: FloatArray) -> float:
    """Share of the points at which a curve is within what was measured."""
    return float(np.mean((load >= test.lower) & (load <= test.upper)))
