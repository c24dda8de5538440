"""Pictures of a study: trade-off of error and cost, errors by specimen, indicators, places of cracks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fissura.pictures.attempted import attempted
from fissura.pictures.curves import BLUE, DPI, GREY, INK, ORANGE, headline, tidy
from fissura.pictures.lettering import legend_below, literal, may_shrink, save
from fissura.study.indicators import INDICATORS
from fissura.study.measures import Measures
from fissura.study.result import StudyResult
from fissura.study.statistics import correlations, localisation, pareto, spread, twins
from fissura.study.style import COLOURS, FLOOR, MARKERS, SOFT, few, plain

__all__ = ["PICTURES", "draw", "plot_errors", "plot_indicators", "plot_places", "plot_tradeoff"]

PICTURES = ("tradeoff.png", "errors.png", "indicators.png", "places.png")
"""Names of the files."""


def draw(result: StudyResult, folder: Path) -> list[Path]:
    """Draw every picture for which there are runs, and that can be drawn; returns what was written."""
    folder.mkdir(parents=True, exist_ok=True)
    plots = (plot_tradeoff, plot_errors, plot_indicators, plot_places)
    return [
        folder / name
        for plot, name in zip(plots, PICTURES, strict=True)
        if attempted(name, partial(plot, result, folder / name))
    ]


def plot_tradeoff(result: StudyResult, path: Path) -> bool:
    """Error against saving, a panel for each type of specimen and a marker for each variation.

    Full markers are medians, hollow ones the worst of the runs; lines are Pareto fronts. Only specimens and seeds count
    that all variations of a panel have, and variations that could be run with all of them.

    Returns
    -------
    bool
        Whether there was anything to draw.
    """
    panels = {name: twins(result.of(specimens)) for name, specimens in result.types().items()}
    panels = {name: found for name, found in panels.items() if found}
    if not panels:
        return False
    names = [v.name for v in result.study.variations if any(m.variation == v.name for f in panels.values() for m in f)]
    look = {name: (COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)]) for k, name in enumerate(names)}
    columns = min(len(panels), 2)
    rows = math.ceil(len(panels) / columns)
    figure = Figure(figsize=(0.6 + 4.0 * columns, 0.9 + 3.2 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axes, (title, found) in zip(grid.flat, panels.items(), strict=False):
        _tradeoff(axes, found, names, look)
        seeds = len({(m.specimen, m.seed) for m in found})
        headline(axes, title, "1 specimen" if seeds == 1 else f"{seeds} specimens")
        limits = {result.specimen(m.specimen).limits.load for m in found}
        for limit in limits:
            axes.axhline(100 * limit, color=GREY, linewidth=1.0, zorder=1)
            axes.annotate(
                "wanted",
                (1.0, 100 * limit),
                xycoords=("axes fraction", "data"),
                xytext=(-2, 2),
                textcoords="offset points",
                ha="right",
                fontsize=7.5,
                color=SOFT,
            )
    for axes in list(grid.flat)[len(panels) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel("largest load difference\n[% of the peak]")
    for axes in list(grid.flat)[max(len(panels) - columns, 0) : len(panels)]:
        axes.set_xlabel("processor time, full / adaptive")
    entries = [
        (Line2D([], [], linestyle="", color=look[name][0], marker=look[name][1]), literal(name)) for name in names
    ]
    entries += [
        (Line2D([], [], linestyle="", color=INK, marker="o"), "median"),
        (Line2D([], [], linestyle="", color=INK, marker="o", markerfacecolor="white"), "worst"),
        (Line2D([], [], color=INK, linewidth=1.0), "front of the medians"),
        (Line2D([], [], color=INK, linewidth=1.0, linestyle="--"), "front of the worst"),
    ]
    legend_below(figure, entries, colour=INK)
    save(figure, path, DPI)
    return True


def _tradeoff(axes: Axes, found: Sequence[Measures], names: Sequence[str], look: dict[str, tuple[str, str]]) -> None:
    here = [name for name in names if any(m.variation == name for m in found)]
    gains, middles, worsts = [], [], []
    for name in here:
        runs = [m for m in found if m.variation == name]
        error = spread(max(100 * m.load, FLOOR) for m in runs)
        gains.append(spread(m.cpu_ratio for m in runs).median)
        middles.append(error.median)
        worsts.append(error.worst)
    for name, gain, middle, worst in zip(here, gains, middles, worsts, strict=True):
        colour, marker = look[name]
        axes.plot([gain, gain], [middle, worst], color=colour, linewidth=0.8, alpha=0.35, zorder=2)
        axes.plot(gain, worst, marker=marker, color=colour, markerfacecolor="white", markersize=6.5, zorder=4)
        axes.plot(gain, middle, marker=marker, color=colour, markersize=6.5, zorder=5)
    for values, style in ((middles, "-"), (worsts, "--")):
        front = pareto(gains, values)
        axes.plot([gains[k] for k in front], [values[k] for k in front], style, color=INK, linewidth=1.0, zorder=3)
    axes.set_xscale("log")
    axes.set_yscale("log")
    plain(axes.xaxis, few(min(gains), max(gains)))
    plain(axes.yaxis)
    low, high = min(gains), max(gains)
    axes.set_xlim(low / 1.15, high * 1.15)
    tidy(axes)


def plot_errors(result: StudyResult, path: Path) -> bool:
    """Errors of the first variation by specimen: a dot for each seed, beyond the limits in orange.

    Returns
    -------
    bool
        Whether there was anything to draw.
    """
    found = [m for m in result.of(variation=result.study.variations[0].name) if m.compared]
    if not found:
        return False
    names = [entry.name for entry in result.study.specimens if any(m.specimen == entry.name for m in found)]
    figure = Figure(figsize=(9.0, 1.3 + 0.36 * len(names)), layout="constrained")
    grid = figure.subplots(1, 3, sharey=True)
    for axes, (key, title) in zip(
        grid, (("load", "largest load difference"), ("peak", "peak load"), ("energy", "dissipated energy")), strict=True
    ):
        for row, name in enumerate(names):
            limit = 100 * getattr(result.specimen(name).limits, key)
            runs = [m for m in found if m.specimen == name]
            errors = np.array([max(100 * abs(getattr(m, key)), FLOOR) for m in runs])
            right = errors <= limit
            height = row + np.linspace(-0.18, 0.18, len(errors)) if len(errors) > 1 else np.array([float(row)])
            axes.plot([limit, limit], [row - 0.38, row + 0.38], color=INK, linewidth=1.4, zorder=2)
            for chosen, colour in ((right, BLUE), (~right, ORANGE)):
                axes.plot(
                    errors[chosen], height[chosen], linestyle="", marker="o", markersize=4.2, color=colour, zorder=3
                )
        axes.set_xscale("log")
        axes.set_xlim(FLOOR / 1.3, None)
        plain(axes.xaxis)
        tidy(axes)
        may_shrink(axes.set_title(title, fontsize=10, loc="left", color=INK))
        axes.grid(axis="y", color="#eef0f2", linewidth=6, zorder=0)
    grid[0].set_yticks(range(len(names)), [literal(name.replace("_", ", ")) for name in names])
    grid[0].invert_yaxis()
    figure.supxlabel("difference from full resolution [%]", fontsize=10, color=INK)
    save(figure, path, DPI)
    return True


def plot_indicators(result: StudyResult, path: Path) -> bool:
    """True error against every indicator, all runs; the line is the bound that covers 95 % of them.

    Returns
    -------
    bool
        Whether there was anything to draw.
    """
    found = [m for m in result.found if m.compared and m.indicators]
    if len(found) < 3:
        return False
    types = result.types()
    across = 3
    rows = -(-len(INDICATORS) // across)
    figure = Figure(figsize=(8.4, 2.6 * rows), layout="constrained")
    grid = figure.subplots(rows, across, sharey=True)
    for axes in grid.flat[len(INDICATORS) :]:
        axes.set_axis_off()
    known = {c.name: c for c in correlations(found)}
    for axes, name in zip(grid.flat, INDICATORS, strict=False):
        drawn = []
        for k, specimens in enumerate(types.values()):
            points = [
                ((m.indicators or {}).get(name, math.nan), max(100 * m.load, FLOOR))
                for m in found
                if m.specimen in specimens
            ]
            positive = [point for point in points if point[0] > 0.0]
            drawn += positive
            axes.plot(
                [point[0] for point in positive],
                [point[1] for point in positive],
                linestyle="",
                marker=MARKERS[k % len(MARKERS)],
                color=COLOURS[k % len(COLOURS)],
                markersize=3.6,
                alpha=0.75,
            )
        axes.set_xscale("log")
        axes.set_yscale("log")
        if drawn and math.isfinite(known[name].covering):
            span = np.array([min(point[0] for point in drawn), max(point[0] for point in drawn)])
            axes.plot(span, 100 * known[name].covering * span, color=GREY, linewidth=1.2, zorder=1)
        ends = [point[0] for point in drawn]
        if ends and max(ends) < 50.0 * min(ends):
            plain(axes.xaxis, few(min(ends), max(ends)))
        axes.set_ylim(FLOOR / 1.5, 2.0 * max(max(100 * m.load, FLOOR) for m in found))
        plain(axes.yaxis)
        tidy(axes)
        rank = "" if math.isnan(known[name].rank) else f", ρ = {known[name].rank:.2f}"
        axes.set_title(f"{name.replace('_', ' ')}{rank}", fontsize=9.5, loc="left", color=INK)
    for axes in grid[:, 0]:
        axes.set_ylabel("largest load difference [%]")
    entries = [
        (Line2D([], [], linestyle="", marker=MARKERS[k % len(MARKERS)], color=COLOURS[k % len(COLOURS)]), literal(name))
        for k, name in enumerate(types)
    ]
    legend_below(figure, entries, colour=INK, most=len(entries), size=9.0)
    save(figure, path, DPI)
    return True


def plot_places(result: StudyResult, path: Path) -> bool:
    """Position of the crack, adaptive over full, of specimens without a notch; first variation.

    Returns
    -------
    bool
        Whether there was anything to draw.
    """
    variation = result.study.variations[0].name
    tests = localisation(result.of(result.free, variation))
    if not tests:
        return False
    columns = min(len(tests), 2)
    rows = math.ceil(len(tests) / columns)
    figure = Figure(figsize=(0.4 + 3.8 * columns, 0.4 + 3.7 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, test in zip(grid.flat, tests, strict=False):
        both = 1e3 * np.concatenate([test.adaptive, test.full])
        low, high = both.min() - 10.0, both.max() + 10.0
        axes.plot([low, high], [low, high], color=GREY, linewidth=1.2, zorder=1)
        for chosen, colour, label in ((test.same, BLUE, "same crack"), (~test.same, ORANGE, "another crack")):
            axes.plot(
                1e3 * test.full[chosen],
                1e3 * test.adaptive[chosen],
                linestyle="",
                marker="o",
                markersize=5.5,
                color=colour,
                markeredgecolor="white",
                markeredgewidth=0.6,
                label=f"{label}: {chosen.sum()}",
                zorder=3,
            )
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
        axes.set_aspect("equal")
        tidy(axes)
        headline(axes, test.specimen.replace("_", ", "), f"p = {test.probability:.2f}")
        axes.set_xlabel("crack at full resolution, x [mm]")
        axes.set_ylabel("crack of the adaptive run, x [mm]")
        axes.legend(fontsize=8.5, loc="upper left", frameon=False, labelcolor=INK)
    for axes in list(grid.flat)[len(tests) :]:
        axes.set_visible(False)
    save(figure, path, DPI)
    return True
