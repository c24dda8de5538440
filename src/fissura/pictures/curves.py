"""Pictures of load-gauge curves: one run, or two compared."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fissura.arrays import FloatArray
from fissura.pictures.lettering import literal, may_shrink, save
from fissura.results.comparison import Comparison
from fissura.results.curve import peak_position
from fissura.results.measured import MeasuredBand, read_measured
from fissura.results.names import load_name, value_axis
from fissura.results.result import Result
from fissura.text import quantities as text
from fissura.text.units import scale_of

BLUE, LIGHT, ORANGE, GREY, INK = "#1f4e79", "#8fb8dc", "#d1641b", "#c9ccd1", "#30343b"
DPI, WIDE = 160, 7.2  # dots and width of pictures [per inch, inch]


def plot_curve(result: Result, path: Path) -> None:
    """Draw load over what is controlled: steps, peak, refinements, and the measured band if the case names one.

    Measured loads are over the gauge, so with them it is over the gauge if the case has one. Steps in which dissipated
    energy led have lighter dots.

    Parameters
    ----------
    result : Result
        A run with at least one step.
    path : Path
        File to write; its ending decides the format.

    Raises
    ------
    InputError
        The measured band cannot be read.
    """
    save(curve_figure(result), path, DPI)


def curve_figure(result: Result) -> Figure:
    """The figure that `plot_curve` writes."""
    figure = Figure(figsize=(WIDE, 4.6), layout="constrained")
    axes = figure.add_subplot()
    measured = result.case.output.measured
    quantity = result.case.quantity if measured is None or result.case.main.gauge is None else "gauge"
    gauge, load = result.values_of(quantity), result.load_values
    x_scale, x_unit = scale_of("m", float(np.abs(gauge).max()))
    y_scale, y_unit = scale_of("N", float(np.abs(load).max()))
    if measured is not None:
        band = read_measured(measured)
        fill_measured(axes, band, x_scale, y_scale)
    axes.plot(
        np.append(0.0, gauge) * x_scale,
        np.append(0.0, load) * y_scale,
        color=BLUE,
        linewidth=1.6,
        marker="o",
        markersize=2.4,
        label="computed steps",
        zorder=3,
    )
    led = result.led_by_energy
    if led.any():
        axes.plot(
            gauge[led] * x_scale,
            load[led] * y_scale,
            linestyle="none",
            marker="o",
            markersize=3.4,
            color=LIGHT,
            markeredgecolor=BLUE,
            markeredgewidth=0.6,
            label="dissipation control",
            zorder=3.5,
        )
    mark_refinements(axes, result, gauge * x_scale, 0.035, 1.2)
    farthest = 1.02 * float(gauge.max())
    axes.set_xlim(min(0.0, 1.02 * float(gauge.min()) * x_scale), farthest * x_scale if farthest > 0 else None)
    peak = peak_position(load)
    # Headroom for the note at the peak; the part of the band beyond the run counts, too, where it shows.
    top = max(float(load.max()) * y_scale, 0.0)
    if measured is not None:
        seen = band.gauge <= farthest
        top = max(top, float(np.max(band.upper[seen], initial=0.0)) * y_scale)
    axes.set_ylim(min(0.0, 1.08 * float(load.min()) * y_scale), 1.16 * top if top > 0 else None)
    _note_peak(axes, float(gauge[peak]), float(load[peak]), x_scale, y_scale)
    tidy(axes)
    axes.set_xlabel(f"{value_axis(result.case, quantity)} [{x_unit}]")
    axes.set_ylabel(f"{load_name(result.case)} [{y_unit}]")
    headline(axes, result.case.name, _kind(result))
    _legend(axes, gauge, load)
    return figure


def comparison_figure(comparison: Comparison, make: Callable[..., Figure] = Figure) -> Figure:
    """Draw two curves, and below them the difference of their loads as per cent of the reference's peak.

    Parameters
    ----------
    comparison : Comparison
        The runs.
    make : callable, optional
        Makes the figure: the class, or ``pyplot.figure`` for a figure that notebooks show.
    """
    figure = make(figsize=(7.2, 5.6), layout="constrained")
    by_energy, quantity = comparison.by_energy, comparison.quantity
    upper, lower = figure.subplots(2, 1, sharex=not by_energy, height_ratios=(3, 1))
    a, b = comparison.a, comparison.b
    values = [run.values_of(quantity) for run in (a, b)]
    x_scale, x_unit = scale_of("m", max(float(np.abs(value).max()) for value in values))
    reference = abs(comparison.peaks[1])
    y_scale, y_unit = scale_of("N", reference)
    for run, value, colour, width in ((b, values[1], GREY, 3.6), (a, values[0], BLUE, 1.4)):
        upper.plot(
            np.append(0.0, value) * x_scale,
            np.append(0.0, run.load_values) * y_scale,
            color=colour,
            linewidth=width,
            label=f"{'A' if run is a else 'B'}: {_kind(run)}",
        )
    share = 100 * (comparison.load_a - comparison.load_b) / reference if reference else 0 * comparison.load_b
    over_scale, over_unit = scale_of("J", float(comparison.abscissa[-1])) if by_energy else (x_scale, x_unit)
    over = comparison.abscissa * over_scale
    lower.axhline(0.0, color=INK, linewidth=0.8)
    lower.fill_between(over, share, color=BLUE, alpha=0.25, linewidth=0)
    lower.plot(over, share, color=BLUE, linewidth=1.2)
    limit = max(1.25 * float(np.abs(share).max()), 0.1)
    lower.set_ylim(-limit, limit)
    lower.set_ylabel("A − B\n[% of peak]")
    (upper if by_energy else lower).set_xlabel(f"{value_axis(b.case, quantity)} [{x_unit}]")
    if by_energy:
        lower.set_xlabel(f"{comparison.over} [{over_unit}]")
        upper.set_xlim(left=min(0.0, 1.02 * min(float(value.min()) for value in values) * x_scale))
    lower.set_xlim(left=0.0)
    upper.set_ylabel(f"{load_name(b.case)} [{y_unit}]")
    least = min(0.0, float(a.load_values.min()), float(b.load_values.min())) * y_scale
    upper.set_ylim(bottom=1.08 * least)
    headline(
        upper,
        f"{a.case.name} against {b.case.name}" if a.case.name != b.case.name else a.case.name,
        f"largest difference {text.per_cent(comparison.max_load_difference)} of the peak load",
    )
    for axes in (upper, lower):
        tidy(axes)
    _legend(upper, values[1], b.load_values)
    figure.align_ylabels()
    return figure


def headline(axes: Axes, name: str, note: str, *, raised: float = 0.0) -> None:
    """Name of the picture in bold, and a note below it, both letter by letter; raised by so many points."""
    title = axes.set_title(literal(name), loc="left", fontsize=11, fontweight="bold", color=INK, pad=19 + raised)
    may_shrink(title)
    note_above(axes, literal(note), 5 + raised)


def note_above(axes: Axes, note: str, raised: float, **look: Any) -> None:
    """A line above axes, flush left and raised by so many points, ready to be drawn; it shrinks where it must."""
    look = {"fontsize": 9, "color": INK, **look}
    may_shrink(
        axes.annotate(note, (0, 1), xytext=(0, raised), xycoords="axes fraction", textcoords="offset points", **look)
    )


def mark_point(axes: Axes, x: Any, y: Any, *, size: float = 6.5, zorder: float = 4, **more: Any) -> Line2D:
    """A white dot with a blue rim, as for the peak, the state that is shown and the like."""
    look: dict[str, Any] = {"markeredgewidth": 1.6, "color": "white", "markeredgecolor": BLUE, **more}
    return axes.plot(x, y, marker="o", markersize=size, zorder=zorder, **look)[0]


def mark_refinements(axes: Axes, result: Result, x: FloatArray, height: float, width: float) -> bool:
    """Ticks at the steps that refined, over this part of the height; returns whether there are any."""
    refined = x[result.curve["refinements"] > 0]
    if len(refined):
        place = axes.get_xaxis_transform()
        look: dict[str, Any] = {"color": ORANGE, "linewidth": width, "label": "refinement", "zorder": 2}
        axes.vlines(refined, 0.0, height, transform=place, **look)
    return len(refined) > 0


def bare(axes: Axes, across: str = "x", up: str = "y") -> None:
    """Style of views along an axis: no grid, coordinates in mm."""
    tidy(axes)
    axes.grid(False)
    axes.set_xlabel(f"{across} [mm]")
    axes.set_ylabel(f"{up} [mm]")


def tidy(axes: Axes) -> None:
    """Style that all pictures share: no box, faint grid, small ink-coloured labels."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(INK)
    axes.grid(color="#e8eaed", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelsize=9)
    axes.xaxis.label.set_color(INK)
    axes.yaxis.label.set_color(INK)


def legend(axes: Axes, **more: Any) -> None:
    """Legend that all pictures share: no frame, what is behind it shimmers through."""
    axes.legend(**{"fontsize": 9, "labelcolor": INK, "edgecolor": "none", "framealpha": 0.85, **more})


def fill_measured(axes: Axes, band: MeasuredBand, x_scale: float, y_scale: float) -> None:
    """Measured band of loads, behind everything computed; scales are factors from metres and newtons."""
    axes.fill_between(
        band.gauge * x_scale,
        band.lower * y_scale,
        band.upper * y_scale,
        color=GREY,
        alpha=0.75,
        linewidth=1.5 if band.is_curve else 0,  # a curve: without an edge nothing of it would be seen
        label="measured",
        zorder=1,
    )


def _note_peak(axes: Axes, gauge: float, load: float, x_scale: float, y_scale: float) -> None:
    """Mark the peak; the note lies on the side where there is more room."""
    x, y = gauge * x_scale, load * y_scale
    right = x < 0.6 * axes.get_xlim()[1]
    mark_point(axes, x, y)
    axes.annotate(
        f"peak {text.force(load)} at {text.length(gauge)}",
        (x, y),
        xytext=(9 if right else -9, 7),
        textcoords="offset points",
        ha="left" if right else "right",
        va="bottom",
        fontsize=9,
        color=INK,
        zorder=5,
    )


def _legend(axes: Axes, gauge: FloatArray, load: FloatArray) -> None:
    """Legend in the corner that the curve leaves free: below a rising curve, above a falling one."""
    peak = peak_position(load)
    falls = abs(load[-1]) < 0.6 * abs(load[peak])
    anchor: dict[str, Any] = (
        {"loc": "upper right", "bbox_to_anchor": (1.0, 0.9)}
        if falls and gauge[peak] < 0.5 * gauge.max()
        else {"loc": "lower right", "bbox_to_anchor": (1.0, 0.06)}
    )
    legend(axes, **anchor)


def _kind(result: Result) -> str:
    bodies = text.count(float(result.curve["bodies"][-1]))
    if result.full:
        return f"full resolution, {bodies} bodies"
    about = "about " if result.summary.get("bodies_full_estimated") else ""
    return f"adaptive, {bodies} of {about}{text.count(float(result.summary['bodies_full']))} bodies"
