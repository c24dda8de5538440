"""What the numbers of an ensemble say: scatter, distributions, sureness."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.ensemble.convergence import Convergence, convergence
from fissura.ensemble.distributions import FAMILIES, Fit, fit
from fissura.ensemble.seeds import RESAMPLING, spawned
from fissura.ensemble.table import Table, select

QUANTITIES = {
    "peak_load_N": "peak load",
    "gauge_at_peak_m": "gauge at peak",
    "dissipated_energy_J": "dissipated energy",
    "initial_stiffness_N_per_m": "initial stiffness",
    "bodies_end": "bodies at the end",
    "cpu_s": "processor time",
}


@dataclass(frozen=True, eq=False)
class Statistics:
    """Statistics of the runs of an ensemble.

    Attributes
    ----------
    counted : (runs,) array of bool
        Runs of the table whose peak counts: those that finished, and those that stopped early but past their peak.
    numbers : (n,) array
        Their numbers.
    peaks : (n,) array
        Magnitudes of their peak loads [N], in order of number.
    fits : dict of str to Fit
        By name of the family; lacks what cannot be fitted.
    convergence : Convergence
        Of mean and coefficient of variation of the peak.
    rows : dict of str to dict
        For each of `QUANTITIES` its mean, standard deviation (with ``n - 1``), coefficient of variation, smallest,
        5 %, 50 %, 95 %, largest value, and number of values.

    Examples
    --------
    >>> round(study.statistics.rows["peak_load_N"]["mean"], 6) == round(float(study.peaks.mean()), 6)
    True
    """

    counted: BoolArray
    numbers: IntArray
    peaks: FloatArray
    fits: dict[str, Fit]
    convergence: Convergence
    rows: dict[str, dict[str, float]]

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as in ``statistics.json``.

        Returns
        -------
        dict
            Numbers, text and lists; None for what is not a finite number.

        Examples
        --------
        >>> "peak_load_N" in str(study.statistics.as_dict())
        True
        """
        last = self.convergence
        sure = {}
        if len(last.n):
            sure = {"mean_95": last.mean[-1, 1:].tolist(), "cov_95": last.cov[-1, 1:].tolist()}
        fits = {
            name: {
                "parameters": {key: list(values) for key, values in found.parameters.items()},
                "confidence": found.confidence,
                "anderson_darling": found.anderson_darling,
                "p_value": found.p_value,
            }
            for name, found in self.fits.items()
        }
        return dict(_finite({"counted": len(self.peaks), **self.rows, "peak": sure, "fits": fits}))


def statistics(runs: Table, master: int) -> Statistics:
    """Statistics of the runs of an ensemble.

    Parameters
    ----------
    runs : Table
        Runs only, no companions, in order of number.
    master : int
        Seed of the ensemble; that of the bootstrap is spawned from it.
    """
    finished = runs["status"] == "finished"
    counted = np.isfinite(runs["peak_load_N"]) & (finished | runs["past_peak"])
    peaks = np.abs(runs["peak_load_N"][counted])
    fits = {}
    for k, family in enumerate(FAMILIES):
        found = fit(family, peaks, np.random.default_rng(spawned(master, k, RESAMPLING)))
        if found is not None:
            fits[family.name] = found
    # What is known at the end of a run only counts where the runs have the same end.
    rows = {}
    for name in QUANTITIES:
        of = counted if name.endswith("peak_m") or name.startswith("peak") else finished
        values = select(runs, of)[name].astype(np.float64)
        values = np.abs(values) if name == "peak_load_N" else values
        rows[name] = _describe(values[np.isfinite(values)])
    return Statistics(counted, runs["number"][counted], peaks, fits, convergence(peaks), rows)


def _describe(values: FloatArray) -> dict[str, float]:
    n = len(values)
    if n == 0:
        return {"n": 0}
    low, middle, high = np.percentile(values, [5.0, 50.0, 95.0]).tolist()
    mean, deviation = float(values.mean()), float(values.std(ddof=1)) if n > 1 else math.nan
    return {
        "n": n,
        "mean": mean,
        "deviation": deviation,
        "cov": deviation / abs(mean) if mean else math.nan,
        "smallest": float(values.min()),
        "p05": low,
        "median": middle,
        "p95": high,
        "largest": float(values.max()),
    }


def _finite(value: Any) -> Any:
    """The same with None for numbers that are not finite."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
