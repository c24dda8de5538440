"""What many runs say together: errors by specimen and variation, indicators against true errors, places of cracks."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.study.definition import Limits
from fissura.study.indicators import INDICATORS
from fissura.study.measures import Measures

SAME_CRACK = 0.8
"""Overlap of energies from which a crack is the same."""

#: Smallest differences that count [fraction of the peak]; below it there is only the tolerance of equilibrium.
_FLOOR = 1e-4


@dataclass(frozen=True)
class Spread:
    """Median and worst (largest size) of some values, nan without any."""

    median: float
    worst: float


def spread(values: Iterable[float], *, smallest: bool = False) -> Spread:
    """Median and worst; with `smallest`, the smallest value is the worst."""
    known = np.array([value for value in values if not math.isnan(value)])
    if not len(known):
        return Spread(math.nan, math.nan)
    worst = known.min() if smallest else np.abs(known).max()
    return Spread(float(np.median(known)), float(worst))


def fails(found: Measures, limits: Limits) -> list[str]:
    """Which limits a run misses, as ``"load 1.32 %"``; what could not be compared misses."""
    if not found.compared or not found.finished:
        return [f"adaptive {found.end}, full {found.end_full}"]
    values = (("load", found.load), ("peak", found.peak), ("energy", found.energy))
    return [f"{name} {100 * value:.2f} %" for name, value in values if not abs(value) <= getattr(limits, name)]


def twins(found: Sequence[Measures]) -> list[Measures]:
    """Runs of those specimens and seeds that all variations share, so that variations can be compared.

    A variation with which one of them could not be run or compared is left out.
    """
    by_variation: dict[str, dict[tuple[str, int], Measures]] = {}
    for m in found:
        by_variation.setdefault(m.variation, {})[m.specimen, m.seed] = m
    if not by_variation:
        return []
    common = set.intersection(*(set(runs) for runs in by_variation.values()))
    kept = [runs for runs in by_variation.values() if all(runs[key].compared for key in common)]
    return [m for runs in kept for key, m in runs.items() if key in common]


def pareto(gain: Sequence[float], error: Sequence[float]) -> list[int]:
    """Indices of points that no other beats in both, the gain larger and the error smaller; by ascending gain."""
    order = sorted(range(len(gain)), key=lambda k: (-gain[k], error[k]))
    best, front = math.inf, []
    for k in order:
        if error[k] < best:
            best = error[k]
            front.append(k)
    return front[::-1]


@dataclass(frozen=True)
class Correlation:
    """How an indicator goes with the true error.

    Attributes
    ----------
    name : str
        Of the indicator.
    runs : int
        How many.
    rank : float
        Spearman's correlation of ranks.
    linear : float
        Pearson's correlation of logarithms, of runs where the indicator is positive.
    covering : float
        Factor ``c`` such that ``c * indicator`` is at least the true error in 95 % of the runs; inf where the indicator
        is zero in more of them though there is an error above the floor.
    excess : float
        Median of ``c * indicator`` over the true error: how much an estimate with this factor exaggerates.
    """

    name: str
    runs: int
    rank: float
    linear: float
    covering: float
    excess: float


def correlations(found: Iterable[Measures], error: Callable[[Measures], float] = lambda m: m.load) -> list[Correlation]:
    """Correlate every indicator with the true error, errors below 1e-4 counting as 1e-4."""
    usable = [m for m in found if m.compared and m.indicators and set(INDICATORS) <= set(m.indicators)]
    true = np.array([max(abs(error(m)), _FLOOR) for m in usable])
    return [_correlation(name, np.array([(m.indicators or {})[name] for m in usable]), true) for name in INDICATORS]


def _correlation(name: str, values: FloatArray, true: FloatArray) -> Correlation:
    from scipy.stats import pearsonr, spearmanr  # takes long to import

    nothing = math.nan
    if len(values) < 3 or np.ptp(values) == 0.0 or np.ptp(true) == 0.0:
        return Correlation(name, len(values), nothing, nothing, nothing, nothing)
    rank = float(spearmanr(values, true).statistic)
    positive = values > 0.0
    logs = np.log(values[positive]), np.log(true[positive])
    linear = float(pearsonr(*logs).statistic) if positive.sum() > 2 and min(map(np.ptp, logs)) > 0.0 else nothing
    needed = np.full(len(values), np.inf)
    np.divide(true, values, out=needed, where=positive)
    needed[~positive & (true <= _FLOOR)] = 0.0
    # The method "higher" takes a value that occurs: no infinite value is mixed with a finite one.
    covering = float(np.quantile(needed, 0.95, method="higher"))
    excess = float(np.median(covering * values / true)) if math.isfinite(covering) else nothing
    return Correlation(name, len(values), rank, linear, covering, excess)


@dataclass(frozen=True)
class Localisation:
    """Where cracks ran that might have run anywhere, adaptive against full resolution.

    Attributes
    ----------
    specimen, variation : str
    adaptive, full : (k,) array
        Positions along x for each seed [m], see `fissura.study.measures.crack_position`.
    same : (k,) bool array
        Whether it is the same crack, see `SAME_CRACK`.
    statistic, probability : float
        Of the Kolmogorov-Smirnov test that both sets of positions come from one distribution.
    """

    specimen: str
    variation: str
    adaptive: FloatArray
    full: FloatArray
    same: BoolArray
    statistic: float
    probability: float


def localisation(found: Iterable[Measures]) -> list[Localisation]:
    """Compare places of cracks for each specimen and variation with at least two runs."""
    from scipy.stats import ks_2samp  # takes long to import

    groups: dict[tuple[str, str], list[Measures]] = {}
    for m in found:
        if m.compared and not math.isnan(m.position) and not math.isnan(m.position_full):
            groups.setdefault((m.specimen, m.variation), []).append(m)
    tests = []
    for (specimen, variation), runs in groups.items():
        if len(runs) < 2:
            continue
        adaptive, full = (np.array([getattr(m, key) for m in runs]) for key in ("position", "position_full"))
        same = np.array([m.overlap >= SAME_CRACK for m in runs])
        test = ks_2samp(adaptive, full)
        tests.append(Localisation(specimen, variation, adaptive, full, same, float(test.statistic), float(test.pvalue)))
    return tests
