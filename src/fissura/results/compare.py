"""Comparison of two runs: how far an adaptive run is from its reference, and what it saved."""

import logging
import math
from pathlib import Path

import numpy as np

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.results.comparable import common_quantity, comparison_notices
from fissura.results.comparison import ENERGY, Comparison, difference
from fissura.results.curve import peak_position
from fissura.results.load_path import LoadPath
from fissura.results.result import Result

logger = logging.getLogger(__name__)


def compare(a: Result | str | Path, b: Result | str | Path) -> Comparison:
    """Compare two runs, as ``fissura compare`` does.

    Parameters
    ----------
    a, b : Result or path
        Results, or folders of results: of the adaptive run, say, and of the reference.

    Returns
    -------
    Comparison
        Differences of their loads, peaks, energies and times; what does not mean the same in both is logged as a
        warning, too.

    Raises
    ------
    InputError
        A folder is missing or broken, a run has no steps, or the runs have nothing to compare.

    Examples
    --------
    >>> both = fissura.compare(adaptive, full)
    >>> abs(both.peak_difference) < 0.05
    True
    """
    comparison = compare_results(*(run if isinstance(run, Result) else Result.load(run) for run in (a, b)))
    for notice in comparison.notices:
        logger.warning(notice)
    return comparison


def compare_results(a: Result, b: Result) -> Comparison:
    """Compare two results, and warn of nothing; see `compare`.

    Parameters
    ----------
    a, b : Result
        The runs.

    Returns
    -------
    Comparison
        Their differences.

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
        peak_difference=difference(peak_a, peak_b),
        gauge_at_peak_difference=difference(at_a, at_b),
        energies=(float(ends[0]), float(ends[1])),
        energy_difference=difference(*ends),
        stiffness_difference=(
            difference(a.initial_stiffness, b.initial_stiffness) if a.case.quantity == b.case.quantity else math.nan
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


def _fraction(part: float, whole: float) -> float:
    return float(part / whole) if whole else math.nan
