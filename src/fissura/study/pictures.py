"""Pictures of a study: trade-off of error and cost, errors by specimen, indicators, places of cracks."""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from fissura.pictures.attempted import attempted
from fissura.pictures.curves import BLUE, DPI, GREY, INK, ORANGE, headline, tidy
from fissura.pictures.grid import grid_of
from fissura.pictures.lettering import legend_below, literal, may_shrink, save
from fissura.study.indicators import INDICATORS
from fissura.study.measures import Measures
from fissura.study.result import StudyResult
from fissura.study.statistics import correlations, localisation, pareto, spread, twins

PICTURES = ("tradeoff.png", "errors.png", "indicators.png", "places.png")
"""Names of the files."""

#: Colours that stay apart for the colour-blind, and markers, one pair for each variation in turn.
COLOURS = ("#1f4e79", "#d1641b", "#3a9a78", "#8c4a8f", "#c9a227", "#5aa5d6", "#7a7f87", "#b3394a")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*")

#: Colour of notes that should not catch the eye.
SOFT = "#7a7f87"

#: Errors are drawn at this one at least [%]: below it there is only the tolerance of equilibrium.
FLOOR = 0.01

_DOT: dict[str, Any] = {"linestyle": "", "marker": "o", "color": INK}


def _look(number: int) -> dict[str, Any]:
    """Marker and colour of a variation, or a type of specimens."""
    return {"linestyle": "", "marker": MARKERS[number % len(MARKERS)], "color": COLOURS[number % len(COLOURS)]}


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
    types = {name: twins(result.of(specimens)) for name, specimens in result.types().items()}
    types = {name: found for name, found in types.items() if found}
    if not types:
        return False
    names = [v.name for v in result.study.variations if any(m.variation == v.name for f in types.values() for m in f)]
    look = {name: _look(k) for k, name in enumerate(names)}
    figure, grid, columns = grid_of(len(types), (4.6, 8.6), 3.2, more=0.9, sharey=True)
    for axes, (title, found) in zip(grid, types.items(), strict=True):
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
    for axes in grid[::columns]:
        axes.set_ylabel("largest load difference\n[% of the peak]")
    for axes in grid[-columns:]:
        axes.set_xlabel("processor time, full / adaptive")
    entries = [(Line2D([], [], **look[name]), literal(name)) for name in names]
    entries += [
        (Line2D([], [], **_DOT), "median"),
        (Line2D([], [], **_DOT, markerfacecolor="white"), "worst"),
        (Line2D([], [], color=INK, linewidth=1.0), "front of the medians"),
        (Line2D([], [], color=INK, linewidth=1.0, linestyle="--"), "front of the worst"),
    ]
    legend_below(figure, entries, colour=INK)
    save(figure, path, DPI)
    return True


def _tradeoff(axes: Axes, found: Sequence[Measures], names: Sequence[str], look: dict[str, dict[str, Any]]) -> None:
    here = [name for name in names if any(m.variation == name for m in found)]
    gains, middles, worsts = [], [], []
    for name in here:
        runs = [m for m in found if m.variation == name]
        error = spread(max(100 * m.load, FLOOR) for m in runs)
        gains.append(spread(m.cpu_ratio for m in runs).median)
        middles.append(error.median)
        worsts.append(error.worst)
    for name, gain, middle, worst in zip(here, gains, middles, worsts, strict=True):
        style = look[name] | {"markersize": 6.5}
        axes.plot([gain, gain], [middle, worst], color=style["color"], linewidth=0.8, alpha=0.35, zorder=2)
        axes.plot(gain, worst, **style, markerfacecolor="white", zorder=4)
        axes.plot(gain, middle, **style, zorder=5)
    for values, dashes in ((middles, "-"), (worsts, "--")):
        front = pareto(gains, values)
        axes.plot([gains[k] for k in front], [values[k] for k in front], dashes, color=INK, linewidth=1.0, zorder=3)
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
                axes.plot(errors[chosen], height[chosen], **_DOT | {"color": colour}, markersize=4.2, zorder=3)
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
    figure, grid, columns = grid_of(len(INDICATORS), (8.4, 8.4, 8.4), 2.6, sharey=True)
    known = {c.name: c for c in correlations(found)}
    for axes, name in zip(grid, INDICATORS, strict=True):
        ends = []
        for k, specimens in enumerate(types.values()):
            x, y = _points(name, [m for m in found if m.specimen in specimens])
            ends += x
            axes.plot(x, y, **_look(k), markersize=3.6, alpha=0.75)
        axes.set_xscale("log")
        axes.set_yscale("log")
        if ends and math.isfinite(known[name].covering):
            span = np.array([min(ends), max(ends)])
            axes.plot(span, 100 * known[name].covering * span, color=GREY, linewidth=1.2, zorder=1)
        if ends and max(ends) < 50.0 * min(ends):
            plain(axes.xaxis, few(min(ends), max(ends)))
        axes.set_ylim(FLOOR / 1.5, 2.0 * max(max(100 * m.load, FLOOR) for m in found))
        plain(axes.yaxis)
        tidy(axes)
        rank = "" if math.isnan(known[name].rank) else f", ρ = {known[name].rank:.2f}"
        axes.set_title(f"{name.replace('_', ' ')}{rank}", fontsize=9.5, loc="left", color=INK)
    for axes in grid[::columns]:
        axes.set_ylabel("largest load difference [%]")
    entries = [(Line2D([], [], **_look(k)), literal(name)) for k, name in enumerate(types)]
    legend_below(figure, entries, colour=INK, most=len(entries), size=9.0)
    save(figure, path, DPI)
    return True


def _points(name: str, runs: Sequence[Measures]) -> tuple[list[float], list[float]]:
    """An indicator, where it is positive, and the true error [%]."""
    known = [(m.indicators[name], m.load) for m in runs if m.indicators and m.indicators.get(name, 0.0) > 0.0]
    return [value for value, _ in known], [max(100 * load, FLOOR) for _, load in known]


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
    figure, grid, _ = grid_of(len(tests), (4.2, 8.0), 3.7, more=0.4)
    for axes, test in zip(grid, tests, strict=True):
        both = 1e3 * np.concatenate([test.adaptive, test.full])
        low, high = both.min() - 10.0, both.max() + 10.0
        axes.plot([low, high], [low, high], color=GREY, linewidth=1.2, zorder=1)
        for chosen, colour, label in ((test.same, BLUE, "same crack"), (~test.same, ORANGE, "another crack")):
            dots = {"color": colour, "markersize": 5.5, "markeredgecolor": "white", "markeredgewidth": 0.6}
            name = f"{label}: {chosen.sum()}"
            axes.plot(1e3 * test.full[chosen], 1e3 * test.adaptive[chosen], **_DOT | dots, label=name, zorder=3)
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
        axes.set_aspect("equal")
        tidy(axes)
        headline(axes, test.specimen.replace("_", ", "), f"p = {test.probability:.2f}")
        axes.set_xlabel("crack at full resolution, x [mm]")
        axes.set_ylabel("crack of the adaptive run, x [mm]")
        axes.legend(fontsize=8.5, loc="upper left", frameon=False, labelcolor=INK)
    save(figure, path, DPI)
    return True


def plain(axis: Axis, ticks: Sequence[float] = ()) -> None:
    """Write the numbers of a logarithmic axis out, at given ticks or at the powers of ten."""
    axis.set_major_locator(FixedLocator(ticks) if ticks else LogLocator(10.0))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
    if ticks:
        axis.set_minor_locator(NullLocator())


def few(low: float, high: float) -> list[float]:
    """Two to eight round ticks of a logarithmic axis that span an interval."""
    for steps in ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)):
        decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
        ticks = [float(f"{step * 10.0**decade:.3g}") for decade in decades for step in steps]
        inside = [tick for tick in ticks if low / 1.1 <= tick <= 1.1 * high]
        if len(inside) >= 3:
            return inside
    middle = math.sqrt(low * high)
    return inside or [float(f"{middle:.2g}")]
