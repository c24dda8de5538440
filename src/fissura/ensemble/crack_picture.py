"""Picture of where cracks started in the runs of an ensemble."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fissura.ensemble.result import EnsembleResult
from fissura.results.pictures import GREY, INK, LIGHT, ORANGE, headline, tidy

__all__ = ["plot_crack_starts"]

FloatArray = NDArray[np.float64]

WIDE = 7.2


def plot_crack_starts(result: EnsembleResult) -> Figure | None:
    """Draw where cracks started, looking along z, and how that is spread along x."""
    runs = result.runs
    known = np.isfinite(runs["crack_start_x_m"])
    if not known.any():
        return None
    case = result.plan.case
    size = 1e3 * np.array(case.specimen.size)
    height = float(np.clip(WIDE * size[1] / size[0], 1.2, 5.0))
    figure = Figure(figsize=(WIDE, height + 2.6), layout="constrained")
    upper, axes = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, height))
    x, y = 1e3 * runs["crack_start_x_m"][known], 1e3 * runs["crack_start_y_m"][known]
    upper.hist(x, bins=np.linspace(0.0, size[0], 42), color=LIGHT, edgecolor="white", linewidth=0.6)
    upper.set_ylabel("runs")
    upper.yaxis.get_major_locator().set_params(integer=True)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * size[:2]
    axes.plot(*corners.T, color=INK, linewidth=1.2)
    for notch in case.notch:
        _notch(axes, notch.normal, notch.face, 1e3 * notch.position, 1e3 * notch.depth, 1e3 * notch.width, size)
    axes.plot(x, y, "o", color=ORANGE, markersize=4.5, alpha=0.6, markeredgewidth=0, label="runs", zorder=3)
    other = result.companions
    axes.plot(
        1e3 * other["crack_start_x_m"],
        1e3 * other["crack_start_y_m"],
        "x",
        color=INK,
        markersize=5,
        label="deterministic",
    )
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    for panel in (upper, axes):
        tidy(panel)
    axes.grid(False)
    axes.legend(
        fontsize=9,
        labelcolor=INK,
        frameon=False,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=2,
        borderaxespad=0.2,
    )
    headline(upper, "Where cracks started", f"{int(known.sum())} of {len(known)} runs opened a contact by G_t/f_t")
    return figure


def _notch(axes: Axes, normal: str, face: str, position: float, depth: float, width: float, size: FloatArray) -> None:
    if (normal, face) in (("x", "bottom"), ("x", "top")):
        ends = [0.0, depth] if face == "bottom" else [size[1] - depth, size[1]]
        axes.fill_betweenx(ends, position - width / 2, position + width / 2, color=GREY, linewidth=0)
        axes.plot([position, position], ends, color=INK, linewidth=1.2)
