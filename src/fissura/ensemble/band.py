"""Mean curve of an ensemble with its percentile band."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.case import Quantity
from fissura.files.atomic import csv_bytes, write_atomically
from fissura.results.curve import COLUMN_OF
from fissura.results.load_path import LoadPath

POINTS = 200
"""Intervals of the abscissa."""

PERCENTILES = (5.0, 50.0, 95.0)


@dataclass(frozen=True, eq=False)
class Band:
    """Loads of many runs at the same value of the controlled quantity, or at the same dissipated energy.

    A run that ended counts up to its end and not beyond: nothing is known of it there. Where runs are missing, the
    others are not a fair sample any more (those that end early may be the weak ones), so whoever draws the band must
    show where `count` falls.

    Attributes
    ----------
    over : str
        ``"gauge"`` or ``"displacement of the load"``, whichever is controlled, or ``"dissipated energy"`` if that of
        any run turns back.
    abscissa : (k,) array
        Its values [m or J], up to where fewer than half of the runs are left.
    count : (k,) array
        Number of runs that got there.
    mean : (k,) array
        Mean load [N].
    percentiles : (3, k) array
        5 %, 50 % and 95 % of the loads [N].
    value : (k,) array
        Mean of the controlled quantity there [m].
    quantity : str
        What is controlled, "gauge" or "displacement".
    """

    over: str
    abscissa: FloatArray
    count: IntArray
    mean: FloatArray
    percentiles: FloatArray
    value: FloatArray
    quantity: Quantity = "gauge"

    @property
    def whole(self) -> BoolArray:
        """Where every run counts, shape (k,)."""
        return np.asarray(self.count == self.count.max())

    @property
    def until(self) -> int:
        """How many points there are up to the last one at which every run counts; beyond it the mean is not fair."""
        return int(np.flatnonzero(self.whole)[-1]) + 1


def band(paths: Sequence[LoadPath]) -> Band | None:
    """Mean curve of runs.

    Loads are interpolated linearly, as in `fissura.results.compare`: over what is controlled from the unloaded state
    on, or over energy from the last state on at which nothing was dissipated.

    Parameters
    ----------
    paths : sequence of LoadPath
        The runs.

    Returns
    -------
    Band or None
        None without runs, or if what is controlled turns back in one and not all have dissipated energy.
    """
    if not paths:
        return None
    grows = all(path.grows for path in paths)
    if not grows and any(path.energy[-1] <= 0.0 for path in paths):
        return None
    lines = [path.over_value() if grows else path.over_energy() for path in paths]
    ends = np.sort([x[-1] for x, _ in lines])
    # More than half of the runs reach the last point.
    x = np.linspace(0.0, ends[(len(ends) - 1) // 2], POINTS + 1)
    x = np.union1d(x, ends[: (len(ends) - 1) // 2 + 1])
    loads = np.stack([np.interp(x, own, of[0], right=np.nan) for own, of in lines])
    values = np.stack([np.interp(x, own, of[1], right=np.nan) for own, of in lines])
    return Band(
        paths[0].name if grows else "dissipated energy",
        x,
        np.isfinite(loads).sum(axis=0),
        np.nanmean(loads, axis=0),
        np.nanpercentile(loads, PERCENTILES, axis=0),
        np.nanmean(values, axis=0),
        paths[0].quantity,
    )


def write_bands(found: Sequence[tuple[Mapping[str, float | str], Band]], path: Path) -> None:
    """Write the bands of one or several groups of runs as CSV, one below the other; nothing if there are none.

    Parameters
    ----------
    found : sequence of (mapping, Band)
        Each band, after the values that its group is told by: these are the first columns. All bands must be over the
        same quantity; those that are not over that of the first are left out.
    path : Path
        The file.
    """
    if not found:
        return
    keys, first = list(found[0][0]), found[0][1]
    column = COLUMN_OF[first.quantity]
    over = "dissipated_J" if first.over == "dissipated energy" else column
    head = (*keys, over, "runs", "mean_load_N", *(f"p{p:02.0f}_load_N" for p in PERCENTILES), f"mean_{column}")
    rows: list[tuple[Any, ...]] = [head]
    for values, of in found:
        if of.over != first.over:
            continue
        for row in zip(of.abscissa, of.count, of.mean, *of.percentiles, of.value, strict=True):
            cells = [int(value) if k == 1 else f"{value:.12g}" for k, value in enumerate(row)]
            rows.append((*(values[key] for key in keys), *cells))
    write_atomically(path, csv_bytes(rows))
