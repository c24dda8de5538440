"""Pictures of an ensemble: curves, peaks, probability plots, crack starts, convergence."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fissura.ensemble.distributions import GAUSSIAN, WEIBULL, Family, Fit, median_ranks
from fissura.ensemble.result import EnsembleResult
from fissura.results import quantities as text
from fissura.results.measured import read_measured
from fissura.results.path import LoadPath
from fissura.results.pictures import BLUE, GREY, INK, LIGHT, ORANGE, headline, tidy

__all__ = ["PICTURES", "plot_convergence", "plot_crack_starts", "plot_curves", "plot_papers", "plot_peaks"]

FloatArray = NDArray[np.float64]

WIDE = 7.2
COLOURS = {"Gaussian": BLUE, "Weibull": ORANGE}


def plot_curves(result: EnsembleResult) -> Figure | None:
    """Draw all curves, their mean and percentile band, and the deterministic run.

    If the gauge of a run turns back, mean and band are over the dissipated energy, in a panel of their own. Where not
    every run counts any more, the mean is dashed and the band is paler.
    """
    if not result.paths:
        return None
    found = result.band
    over_energy = found is not None and found.over != "gauge"
    figure = Figure(figsize=(WIDE, 7.6 if over_energy else 4.8), layout="constrained")
    panels = figure.subplots(2 if over_energy else 1, 1, squeeze=False)[:, 0]
    axes, banded = panels[0], panels[-1]
    paths = result.paths
    x, x_unit = _scale(max(float(path.gauge.max()) for path in paths.values()), 1e-3, ("µm", 1e6), ("mm", 1e3))
    y, y_unit = _scale(max(float(path.load.max()) for path in paths.values()), 1e3, ("N", 1.0), ("kN", 1e-3))
    measured = result.plan.case.output.measured
    if measured is not None and measured.exists():
        known = read_measured(measured)
        axes.fill_between(
            known.gauge * x,
            known.lower * y,
            known.upper * y,
            color=GREY,
            alpha=0.7,
            linewidth=0,
            label="measured",
            zorder=0,
        )
    finished = set(result.runs["number"][result.runs["status"] == "finished"].tolist())
    _lines(axes, [path for k, path in paths.items() if k in finished], x, y, LIGHT, f"{len(finished)} runs", 0.55)
    stopped = [path for k, path in paths.items() if k not in finished]
    _lines(axes, stopped, x, y, ORANGE, f"{len(stopped)} stopped early", 0.9)
    alone = list(result.companion_paths.values())
    if len(alone) == 1:
        axes.plot(
            alone[0].gauge * x,
            alone[0].load * y,
            color=INK,
            linewidth=1.3,
            linestyle=(0, (5, 2)),
            label="deterministic",
        )
    elif alone:
        _lines(axes, alone, x, y, INK, f"{len(alone)} deterministic runs", 0.3)
    if found is not None:
        u, u_unit = (x, x_unit) if not over_energy else _scale(float(found.abscissa[-1]), 1.0, ("mJ", 1e3), ("J", 1.0))
        whole = found.whole
        until = int(np.flatnonzero(whole)[-1]) + 1
        for part, alpha in ((slice(0, until), 0.30), (slice(until - 1, None), 0.14)):
            at = found.abscissa[part] * u
            banded.fill_between(
                at,
                found.percentiles[0, part] * y,
                found.percentiles[2, part] * y,
                color=BLUE,
                alpha=alpha,
                linewidth=0,
                label="5 % to 95 %" if alpha == 0.30 else None,
                zorder=2,
            )
        banded.plot(
            found.abscissa[:until] * u, found.mean[:until] * y, color=BLUE, linewidth=1.9, label="mean", zorder=4
        )
        if until < len(whole):
            label = f"mean of those left (≥ {int(found.count.min())})"
            banded.plot(
                found.abscissa[until - 1 :] * u,
                found.mean[until - 1 :] * y,
                "--",
                color=BLUE,
                linewidth=1.5,
                label=label,
            )
        if over_energy:
            banded.set_xlabel(f"dissipated energy [{u_unit}]")
            banded.set_ylabel(f"load [{y_unit}]")
            banded.set_xlim(0.0, float(found.abscissa[-1]) * u)
    axes.set_xlabel(f"{'gauge' if result.plan.case.quantity == 'gauge' else 'displacement of the load'} [{x_unit}]")
    axes.set_ylabel(f"load [{y_unit}]")
    axes.set_xlim(left=min(0.0, 1.02 * x * min(float(path.gauge.min()) for path in paths.values())))
    for panel in panels:
        tidy(panel)
        panel.set_ylim(bottom=0.0)
        panel.legend(fontsize=9, labelcolor=INK, edgecolor="none", framealpha=0.85, loc="upper right")
    headline(
        axes,
        "Load",
        f"{len(paths)} runs of {result.plan.case.name}" + ("; the gauge turns back" if over_energy else ""),
    )
    return figure


def _lines(axes: Axes, paths: list[LoadPath], x: float, y: float, colour: str, label: str, alpha: float) -> None:
    for k, path in enumerate(paths):
        axes.plot(
            path.gauge * x, path.load * y, color=colour, linewidth=0.7, alpha=alpha, label=label if k == 0 else None
        )


def plot_peaks(result: EnsembleResult) -> Figure | None:
    """Draw a histogram of the peaks with the fitted densities."""
    peaks = result.peaks
    if len(peaks) < 3 or np.ptp(peaks) <= 0.0:
        return None
    figure, axes, scale, unit = _figure(peaks)
    values = peaks * scale
    bins = max(5, min(30, round(1.5 * np.sqrt(len(values)))))
    axes.hist(
        values, bins=bins, density=True, color=LIGHT, edgecolor="white", linewidth=0.8, label=f"{len(values)} runs"
    )
    margin = 0.25 * np.ptp(values)
    x = np.linspace(max(values.min() - margin, 1e-9), values.max() + margin, 300)
    for name, fit in result.statistics.fits.items():
        axes.plot(
            x,
            fit.density(x / scale) / scale,
            color=COLOURS[name],
            linewidth=1.6,
            label=f"{name}, p = {fit.p_value:.2f}",
        )
    axes.plot(
        values,
        np.full(len(values), -0.02),
        "|",
        color=BLUE,
        markersize=7,
        transform=axes.get_xaxis_transform(),
        clip_on=False,
    )
    _companion_line(axes, result, scale)
    axes.set_xlabel(f"peak load [{unit}]")
    axes.set_ylabel(f"density [1/{unit}]")
    tidy(axes)
    axes.tick_params(axis="x", pad=8)
    headline(
        axes,
        "Peak load",
        f"mean {text.force(float(peaks.mean()))}, CoV {text.per_cent(float(peaks.std(ddof=1) / peaks.mean()))}",
    )
    axes.legend(fontsize=9, labelcolor=INK, edgecolor="none", framealpha=0.85)
    return figure


def plot_papers(result: EnsembleResult) -> Figure | None:
    """Draw the peaks on Gaussian and on Weibull paper, with fitted lines and their confidence bounds."""
    fits = result.statistics.fits
    if not fits:
        return None
    figure = Figure(figsize=(WIDE, 4.3), layout="constrained")
    scale, unit = _scale(float(result.peaks.max()), 1e3, ("N", 1.0), ("kN", 1e-3))
    panels = figure.subplots(1, len(fits), squeeze=False)[0]
    for axes, fit in zip(panels, fits.values(), strict=True):
        _paper(axes, fit, result.peaks, scale)
        axes.set_xlabel(f"peak load [{unit}]")
    panels[0].set_ylabel("probability [%]")
    return figure


def _paper(axes: Axes, fit: Fit, peaks: FloatArray, scale: float) -> None:
    """One probability plot: the distribution is a straight line."""
    family = fit.family
    ranks = median_ranks(len(peaks))
    p = 1.0 / (1.0 + np.exp(-np.linspace(_logit(min(0.01, ranks[0])), _logit(max(0.99, ranks[-1])), 120)))
    low, high = fit.bounds(p)
    y = family.quantile(p)
    colour = COLOURS[family.name]
    axes.fill_betweenx(
        y,
        low * scale,
        high * scale,
        color=colour,
        alpha=0.18,
        linewidth=0,
        label=f"{100 * fit.confidence:.0f} % bounds",
    )
    axes.plot(fit.quantile(p) * scale, y, color=colour, linewidth=1.5, label="maximum likelihood")
    axes.plot(np.sort(peaks) * scale, family.quantile(ranks), "o", color=INK, markersize=3.2, zorder=3, label="runs")
    if family is WEIBULL:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(_plain_number)
        axes.xaxis.set_minor_formatter(_plain_number)
        ends = np.array(axes.get_xlim())
        nice = _nice(float(ends[0]), float(ends[1]))
        axes.set_xticks(nice, minor=False)
        axes.set_xticks([], minor=True)
    ticks = np.array([0.1, 1, 2, 5, 10, 25, 50, 75, 90, 95, 99, 99.9])
    ticks = ticks[(ticks / 100 >= p[0] * 0.999) & (ticks / 100 <= p[-1] * 1.001)]
    axes.set_yticks(family.quantile(ticks / 100), [f"{tick:g}" for tick in ticks])
    tidy(axes)
    axes.legend(fontsize=8.5, labelcolor=INK, edgecolor="none", framealpha=0.85, loc="lower right")
    headline(axes, f"{family.name} paper", _parameters(family, fit, scale))


def _parameters(family: Family, fit: Fit, scale: float) -> str:
    values = [value[0] for value in fit.parameters.values()]
    if family is GAUSSIAN:
        return f"CoV {100 * values[1] / values[0]:.2f} %, Anderson–Darling p = {fit.p_value:.2f}"
    return f"shape {values[1]:.3g}, Anderson–Darling p = {fit.p_value:.2f}"


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


def plot_convergence(result: EnsembleResult) -> Figure | None:
    """Draw mean and coefficient of variation of the peak over the number of runs, with 95 % intervals."""
    found = result.statistics.convergence
    if len(found.n) < 2:
        return None
    figure = Figure(figsize=(WIDE, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    scale, unit = _scale(float(result.peaks.max()), 1e3, ("N", 1.0), ("kN", 1e-3))
    # Intervals of 2 or 3 runs are so wide that nothing else would be seen.
    first = min(4, len(found.n) - 1)
    for axes, values, factor, name in (
        (upper, found.mean, scale, f"mean [{unit}]"),
        (lower, found.cov, 100.0, "CoV [%]"),
    ):
        shown = np.where(np.isfinite(values), values, np.nan) * factor
        axes.fill_between(found.n, shown[:, 1], shown[:, 2], color=BLUE, alpha=0.2, linewidth=0, label="95 % interval")
        axes.plot(found.n, shown[:, 0], color=BLUE, linewidth=1.6)
        axes.axhline(shown[-1, 0], color=INK, linewidth=0.8, linestyle=(0, (2, 2)))
        seen = shown[first:]
        low, high = float(np.nanmin(seen)), float(np.nanmax(seen))
        margin = 0.08 * (high - low) or 1.0
        axes.set_ylim(max(low - margin, 0.0), high + margin)
        axes.set_ylabel(name)
        tidy(axes)
    lower.set_xlabel("number of runs")
    lower.set_xlim(found.n[0], found.n[-1])
    upper.legend(fontsize=9, labelcolor=INK, edgecolor="none", framealpha=0.85)
    headline(upper, "Convergence of the peak load", "in order of the numbers of the runs")
    figure.align_ylabels()
    return figure


PICTURES: dict[str, tuple[Callable[[EnsembleResult], Figure | None], str]] = {
    "curves": (plot_curves, "Load curves with mean and percentile band"),
    "peaks": (plot_peaks, "Histogram of the peak loads"),
    "papers": (plot_papers, "Probability plots of the peak loads"),
    "crack_starts": (plot_crack_starts, "Where cracks started"),
    "convergence": (plot_convergence, "Convergence of mean and coefficient of variation"),
}
"""Pictures of the report by name: what draws it (None: there is nothing to draw), and its caption."""


def _figure(peaks: FloatArray) -> tuple[Figure, Axes, float, str]:
    figure = Figure(figsize=(WIDE, 4.2), layout="constrained")
    scale, unit = _scale(float(peaks.max()), 1e3, ("N", 1.0), ("kN", 1e-3))
    return figure, figure.add_subplot(), scale, unit


def _companion_line(axes: Axes, result: EnsembleResult, scale: float) -> None:
    peaks = result.companions["peak_load_N"]
    for k, peak in enumerate(peaks[np.isfinite(peaks)]):
        alone = len(peaks) == 1
        axes.axvline(
            float(peak) * scale,
            color=INK,
            linewidth=1.3 if alone else 0.5,
            alpha=1.0 if alone else 0.5,
            linestyle=(0, (5, 2)),
            label="deterministic" if k == 0 else None,
        )


def _scale(largest: float, limit: float, small: tuple[str, float], large: tuple[str, float]) -> tuple[float, str]:
    unit, factor = small if largest < limit else large
    return factor, unit


def _logit(p: float) -> float:
    return float(np.log(p / (1.0 - p)))


def _plain_number(value: float, position: float) -> str:
    return f"{value:g}"


def _nice(low: float, high: float) -> list[float]:
    """Some six round numbers between two."""
    raw = (high - low) / 6.0
    step = 10.0 ** np.floor(np.log10(raw))
    step *= next(k for k in (1, 2, 5, 10) if k * step >= raw * 0.999)
    return [float(v) for v in np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step if v > 0]
