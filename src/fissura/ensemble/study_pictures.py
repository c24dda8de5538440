"""Pictures of a parameter study: curves by value, and peak loads over each varied key."""

from collections.abc import Mapping
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from fissura.ensemble.axes_of_values import ValueAxis, value_axis_of
from fissura.ensemble.result import EnsembleResult
from fissura.pictures.curves import INK, WIDE, headline, legend, tidy
from fissura.pictures.grid import grid_of
from fissura.pictures.lettering import literal
from fissura.results.names import load_name, value_axis
from fissura.text.units import scale_of

#: Points, and lines, that a legend names one by one, at most; and varied keys with a panel of their own.
_NAMED, _PANELS = 12, 4


def plot_study_curves(result: EnsembleResult) -> Figure | None:
    """Draw the curves at all points of a study, a colour for each point; thick lines are means of several runs."""
    if not result.plan.vary or not result.paths:
        return None
    figure = Figure(figsize=(WIDE, 4.8), layout="constrained")
    axes = figure.subplots()
    curves_by_value(result, axes, {})
    count = len(result.plan.points)
    headline(axes, "Load", f"{len(result.paths)} runs of {result.plan.case.name} at {count} points")
    return figure


def curves_by_value(result: EnsembleResult, axes: Axes, line: Mapping[str, Any]) -> None:
    """Draw the curves of a study into axes; where there are many points, only some of them are named."""
    case, paths = result.plan.case, result.paths
    x, x_unit = scale_of("m", max(float(path.value.max()) for path in paths.values()))
    y, y_unit = scale_of("N", max(float(np.abs(path.load).max()) for path in paths.values()))
    count = len(result.groups)
    named = set(np.linspace(0, count - 1, min(count, _NAMED)).round().astype(int).tolist())
    for k, (point, group) in enumerate(zip(result.plan.points, result.groups, strict=True)):
        colour, label = colours(count)[k], literal(point.label) if k in named else None
        found = group.band
        mean = found is not None and len(group.paths) > 1 and found.over != "dissipated energy"
        for j, path in enumerate(group.paths.values()):
            style: dict[str, Any] = {"color": colour, "linewidth": 0.7 if mean else 1.6, "alpha": 0.4 if mean else 1.0}
            name = label if j == 0 and not mean else None
            axes.plot(path.value * x, path.load * y, **{**style, "label": name, **line})
        if mean and found is not None:
            style = {"color": colour, "linewidth": 1.9, "zorder": 3, **line}
            axes.plot(found.abscissa[: found.until] * x, found.mean[: found.until] * y, **{"label": label, **style})
    axes.set_xlabel(f"{value_axis(case, case.quantity)} [{x_unit}]")
    axes.set_ylabel(f"{load_name(case)} [{y_unit}]")
    axes.set_xlim(left=min(0.0, 1.02 * x * min(float(path.value.min()) for path in paths.values())))
    axes.set_ylim(bottom=min(0.0, 1.02 * y * min(float(path.load.min()) for path in paths.values())))
    tidy(axes)
    legend(axes, loc="best", fontsize=8)


def colours(count: int) -> list[str]:
    """Colours of points in order, from dark to light."""
    return [to_hex(colormaps["viridis"](0.92 * k / max(count - 1, 1))) for k in range(count)]


def plot_study_peaks(result: EnsembleResult) -> Figure | None:
    """Draw peak loads over each varied key: runs as dots, means with 95 % intervals, joined where all else is equal."""
    keys = list(result.plan.vary)[:_PANELS]
    if not keys or not len(result.peaks):
        return None
    figure, grid, columns = grid_of(len(keys), (WIDE, WIDE), 3.9, sharey=True)
    y, y_unit = scale_of("N", float(result.peaks.max()))
    for axes, key in zip(grid, keys, strict=True):
        axis = value_axis_of(result.plan, key)
        _peaks(axes, result, key, axis, y)
        axis.label(axes)
        tidy(axes)
    for axes in grid[::columns]:
        axes.set_ylabel(f"peak load [{y_unit}]")
    headline(grid[0], "Peak load", f"{result.plan.case.name}; bars are 95 % intervals of the mean")
    return figure


def _peaks(axes: Axes, result: EnsembleResult, key: str, axis: ValueAxis, y: float) -> None:
    """Peaks over one key."""
    together = result.plan.combine == "together"
    places = [axis.place(group.values[key]) for group in result.groups]
    for place, group in zip(places, result.groups, strict=True):
        if len(group.peaks) > 1:
            axes.plot(np.full(len(group.peaks), place), group.peaks * y, ".", color=INK, markersize=4, alpha=0.35)
    others = ["" if together else str({k: v for k, v in group.values.items() if k != key}) for group in result.groups]
    order = sorted(range(len(places)), key=lambda k: (others[k], places[k]))
    lines = [list(of) for _, of in groupby(order, key=lambda k: others[k])]
    lines.sort(key=min)
    for number, line in enumerate(lines):
        shown = [k for k in line if len(result.groups[k].peaks)]
        means = [float(result.groups[k].peaks.mean()) * y for k in shown]
        bars = [_half_width(result.groups[k]) * y for k in shown]
        label = _others(result, key, line[0]) if 1 < len(lines) <= _NAMED else None
        colour = colours(len(lines))[number]
        axes.errorbar([places[k] for k in shown], means, bars, color=colour, marker="o", ms=4.5, capsize=3, label=label)
    if 1 < len(lines) <= _NAMED:
        axes.margins(y=0.05 + 0.05 * len(lines))  # room for the legend
        legend(axes, fontsize=7.5, loc="upper left")


def _half_width(group: EnsembleResult) -> float:
    """Half of the 95 % interval of the mean peak; 0 for a single run."""
    last = group.statistics.convergence
    return float(last.mean[-1, 2] - last.mean[-1, 0]) if len(last.n) and np.isfinite(last.mean[-1]).all() else 0.0


def _others(result: EnsembleResult, key: str, point: int) -> str:
    """What the other keys are at a point."""
    given = result.plan.points[point].given
    return literal(", ".join(f"{name.rpartition('.')[2]} = {text}" for name, text in given.items() if name != key))
