"""One row for each point of a parameter study: what its runs have in common, and how they scatter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fissura.ensemble.table import Table

if TYPE_CHECKING:
    from fissura.ensemble.result import EnsembleResult

GROUP_KINDS = {"point": int, "runs": int, "counted": int}
"""Columns of whole numbers."""

_MEANS = ("gauge_at_peak_m", "dissipated_energy_J", "initial_stiffness_N_per_m")


def group_rows(groups: Sequence[EnsembleResult]) -> Table:
    """Table of points, in order; what is unknown is nan.

    Columns: ``point``, the varied keys, ``runs`` (those that finished), ``counted`` (those whose peak counts),
    ``mean_peak_load_N`` with its 95 % interval by Student's t, ``low_peak_load_N`` to ``high_peak_load_N``,
    ``cov_peak_load``, and means of gauge at peak, energy and stiffness.
    """
    rows = [_row(k, group) for k, group in enumerate(groups)]
    return {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else {})}


def _row(number: int, group: EnsembleResult) -> dict[str, float | int | str]:
    found = group.statistics
    peak, last = found.rows["peak_load_N"], found.convergence
    low, high = last.mean[-1, 1:].tolist() if len(last.n) else (np.nan, np.nan)
    return {
        "point": number,
        **group.values,
        "runs": group.count("finished"),
        "counted": len(found.peaks),
        "mean_peak_load_N": peak.get("mean", np.nan),
        "low_peak_load_N": low,
        "high_peak_load_N": high,
        "cov_peak_load": peak.get("cov", np.nan),
        **{f"mean_{name}": found.rows[name].get("mean", np.nan) for name in _MEANS},
    }
