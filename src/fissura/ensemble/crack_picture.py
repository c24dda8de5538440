"""Picture of where cracks started in the runs of an ensemble."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fissura.ensemble.result import EnsembleResult
from fissura.pictures.curves import INK, LIGHT, ORANGE, WIDE, headline, tidy
from fissura.specimen import domain_from_case


def plot_crack_starts(result: EnsembleResult) -> Figure | None:
    """Draw where cracks started, looking along z, and how that is spread along x."""
    runs = result.runs
    known = np.isfinite(runs["crack_start_x_m"])
    if not known.any():
        return None
    case = result.plan.case
    domain = domain_from_case(case)
    low, high = 1e3 * domain.bounds
    height = float(np.clip(WIDE * (high[1] - low[1]) / (high[0] - low[0]), 1.2, 5.0))
    figure = Figure(figsize=(WIDE, height + 2.6), layout="constrained")
    upper, axes = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, height))
    x, y = 1e3 * runs["crack_start_x_m"][known], 1e3 * runs["crack_start_y_m"][known]
    upper.hist(x, bins=np.linspace(low[0], high[0], 42), color=LIGHT, edgecolor="white", linewidth=0.6)
    upper.set_ylabel("runs")
    upper.yaxis.get_major_locator().set_params(integer=True)
    for loop in domain.outline(np.array([0.0, 0.0, 1.0]), float(domain.bounds[:, 2].mean())):
        axes.plot(*1e3 * loop[np.arange(len(loop) + 1) % len(loop), :2].T, color=INK, linewidth=1.2)
    axes.plot(x, y, "o", color=ORANGE, markersize=4.5, alpha=0.6, markeredgewidth=0, label="runs", zorder=3)
    other = result.companions
    label = "deterministic" if len(other["number"]) else None
    axes.plot(1e3 * other["crack_start_x_m"], 1e3 * other["crack_start_y_m"], "x", color=INK, markersize=5, label=label)
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    for panel in (upper, axes):
        tidy(panel)
    axes.grid(False)
    beside: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "ncols": 2, "borderaxespad": 0.2}
    axes.legend(fontsize=9, labelcolor=INK, frameon=False, **beside)
    headline(upper, "Where cracks started", f"{int(known.sum())} of {len(known)} runs opened a contact by G_t/f_t")
    return figure
