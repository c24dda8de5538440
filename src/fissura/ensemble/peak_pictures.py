"""Pictures of the peak loads of an ensemble: histogram, probability plots, convergence."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura.arrays import FloatArray
from fissura.ensemble.distributions import GAUSSIAN, WEIBULL, Family, Fit, median_ranks
from fissura.ensemble.result import EnsembleResult
from fissura.pictures.curves import BLUE, INK, LIGHT, ORANGE, WIDE, headline, legend, tidy
from fissura.text import quantities as text
from fissura.text.units import scale_of

COLOURS = {"Gaussian": BLUE, "Weibull": ORANGE}


def plot_peaks(result: EnsembleResult) -> Figure | None:
    """Draw a histogram of the peaks with the fitted densities."""
    peaks = result.peaks
    if len(peaks) < 3 or np.ptp(peaks) <= 0.0 or result.plan.vary:
        return None
    figure = Figure(figsize=(WIDE, 4.2), layout="constrained")
    axes, (scale, unit) = figure.add_subplot(), scale_of("N", float(peaks.max()))
    values = peaks * scale
    bins = max(5, min(30, round(1.5 * np.sqrt(len(values)))))
    bars: dict[str, Any] = {"color": LIGHT, "edgecolor": "white", "linewidth": 0.8}
    axes.hist(values, bins=bins, density=True, label=f"{len(values)} runs", **bars)
    margin = 0.25 * np.ptp(values)
    x = np.linspace(max(values.min() - margin, 1e-9), values.max() + margin, 300)
    for name, fit in result.statistics.fits.items():
        label = f"{name}, p = {fit.p_value:.2f}"
        axes.plot(x, fit.density(x / scale) / scale, color=COLOURS[name], linewidth=1.6, label=label)
    below: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "clip_on": False}
    axes.plot(values, np.full(len(values), -0.02), "|", color=BLUE, markersize=7, **below)
    _companion_line(axes, result, scale)
    axes.set_xlabel(f"peak load [{unit}]")
    axes.set_ylabel(f"density [1/{unit}]")
    tidy(axes)
    axes.tick_params(axis="x", pad=8)
    cov = text.per_cent(float(peaks.std(ddof=1) / peaks.mean()))
    headline(axes, "Peak load", f"mean {text.force(float(peaks.mean()))}, CoV {cov}")
    legend(axes)
    return figure


def plot_papers(result: EnsembleResult) -> Figure | None:
    """Draw the peaks on Gaussian and on Weibull paper, with fitted lines and their confidence bounds."""
    fits = result.statistics.fits
    if not fits or result.plan.vary:
        return None
    figure = Figure(figsize=(WIDE, 4.3), layout="constrained")
    scale, unit = scale_of("N", float(result.peaks.max()))
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
    label = f"{100 * fit.confidence:.0f} % bounds"
    axes.fill_betweenx(y, low * scale, high * scale, color=colour, alpha=0.18, linewidth=0, label=label)
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
    legend(axes, fontsize=8.5, loc="lower right")
    headline(axes, f"{family.name} paper", _parameters(family, fit))


def _parameters(family: Family, fit: Fit) -> str:
    values = [value[0] for value in fit.parameters.values()]
    if family is GAUSSIAN:
        return f"CoV {100 * values[1] / values[0]:.2f} %, Anderson–Darling p = {fit.p_value:.2f}"
    return f"shape {values[1]:.3g}, Anderson–Darling p = {fit.p_value:.2f}"


def plot_convergence(result: EnsembleResult) -> Figure | None:
    """Draw mean and coefficient of variation of the peak over the number of runs, with 95 % intervals."""
    found = result.statistics.convergence
    if len(found.n) < 2 or result.plan.vary:
        return None
    figure = Figure(figsize=(WIDE, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    scale, unit = scale_of("N", float(result.peaks.max()))
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
    lower.xaxis.get_major_locator().set_params(integer=True)
    legend(upper)
    headline(upper, "Convergence of the peak load", "in order of the numbers of the runs")
    figure.align_ylabels()
    return figure


def _companion_line(axes: Axes, result: EnsembleResult, scale: float) -> None:
    peaks = np.abs(result.companions["peak_load_N"])
    for k, peak in enumerate(peaks[np.isfinite(peaks)]):
        width, alpha = (1.3, 1.0) if len(peaks) == 1 else (0.5, 0.5)
        style: dict[str, Any] = {"color": INK, "linewidth": width, "alpha": alpha, "linestyle": (0, (5, 2))}
        axes.axvline(float(peak) * scale, label="deterministic" if k == 0 else None, **style)


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
