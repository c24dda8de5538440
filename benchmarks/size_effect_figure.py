"""Figure of `size_effect.py`: strength and scatter over depth, and over volume in correlation lengths."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from fissura.pictures.curves import BLUE, INK, ORANGE, headline, legend, tidy

FloatArray = NDArray[np.float64]

COLOURS = [ORANGE, BLUE, "#4c8c4a", "#8a4f9e"]


def deterministic(rows: list[dict[str, Any]], of: dict[str, Any]) -> dict[str, Any]:
    return next(r for r in rows if (r["case"], r["depth_mm"], r["length_mm"]) == (of["case"], of["depth_mm"], None))


def figure(rows: list[dict[str, Any]], path: Path) -> None:
    """Mean strength and its scatter over depth, and the same over volume in correlation lengths.

    ``rows`` are those of one case, its deterministic runs among them.
    """
    picture = Figure(figsize=(10.0, 7.4), layout="constrained")
    (mean, cov), (ratio, both) = picture.subplots(2, 2)
    lengths = list(dict.fromkeys(r["length_mm"] for r in rows))
    depths = list(dict.fromkeys(r["depth_mm"] for r in rows))
    for k, length in enumerate(lengths):
        of = [r for r in rows if r["length_mm"] == length]
        depth = np.array([r["depth_mm"] for r in of])
        label = "deterministic" if length is None else f"l = {length:g} mm"
        colour, style = (INK, (0, (5, 2))) if length is None else (COLOURS[(k - 1) % len(COLOURS)], "solid")
        near = depth * 1.015 ** (k - (len(lengths) - 1) / 2)  # beside each other
        bars(mean, near, np.array([r["mean_MPa"] for r in of]), colour, style, label)
        bars(cov, near, 100 * np.array([r["cov"] for r in of]), colour, style, label)
        if length is not None:
            volume = np.array([r["volume_over_l3"] for r in of])
            base = np.array([deterministic(rows, r)["mean_MPa"][0] for r in of])[:, None]
            bars(ratio, volume, np.array([r["mean_MPa"] for r in of]) / base, colour, style, label)
            bars(both, volume, 100 * np.array([r["cov"] for r in of]), colour, style, label)
    for axes, x, y in (
        (mean, "depth [mm]", "mean strength [MPa]"),
        (cov, "depth [mm]", "CoV [%]"),
        (ratio, "V/l³", "mean over deterministic mean"),
        (both, "V/l³", "CoV [%]"),
    ):
        axes.set_xscale("log")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        tidy(axes)
        legend(axes)
        if x.startswith("depth"):
            axes.set_xticks(depths, [f"{depth:g}" for depth in depths])
            axes.set_xticks([], minor=True)
    mean.set_yscale("log")
    low, high = mean.get_ylim()
    ticks = [t for t in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if low <= t <= high]
    mean.set_yticks(ticks, [f"{t:g}" for t in ticks])
    mean.set_yticks([], minor=True)
    headline(mean, "Mean strength", f"{max(r['runs'] for r in rows)} specimens of each depth, 95 % intervals")
    headline(cov, "Scatter", "coefficient of variation of the strength")
    headline(ratio, "What the field takes away", "over the volume in correlation lengths")
    headline(both, "Scatter", "over the volume in correlation lengths")
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.savefig(path, dpi=130)


def bars(axes: Axes, x: FloatArray, y: FloatArray, colour: str, style: Any, label: str) -> None:
    """A line with intervals; columns of ``y``: estimate, lower, upper."""
    spread = np.abs(y[:, 1:] - y[:, :1]).T
    axes.errorbar(
        x,
        y[:, 0],
        np.where(np.isfinite(spread), spread, 0.0),
        color=colour,
        linestyle=style,
        marker="o",
        markersize=4,
        capsize=3,
        linewidth=1.4,
        label=label,
    )
