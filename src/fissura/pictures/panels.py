"""Panels beside views of the specimen: the curve, and what the colours mean."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, Normalize
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fissura.pictures.curves import BLUE, INK, mark_refinements, tidy
from fissura.pictures.side_view import COARSE, EDGE, FINE, HEAT, TENSION, Look
from fissura.results.curve import peak_position
from fissura.results.names import load_name, value_axis
from fissura.results.result import Result
from fissura.text.units import scale_of


def draw_curve(axes: Axes, result: Result) -> tuple[float, float]:
    """Draw load over what is controlled in the units of the other pictures, with ticks at refinements.

    Returns the factors from metres and newtons to the units of the axes.
    """
    value, load = result.controlled, result.load_values
    x_scale, x_unit = scale_of("m", float(np.abs(value).max()))
    y_scale, y_unit = scale_of("N", float(np.abs(load).max()))
    axes.plot(np.append(0.0, value) * x_scale, np.append(0.0, load) * y_scale, color=BLUE, linewidth=1.8, zorder=3)
    if mark_refinements(axes, result, value * x_scale, 0.05, 1.4):
        peak = peak_position(load)
        falls = peak < len(load) - 1 and value[peak] < 0.5 * value.max()
        corner: dict[str, Any] = (
            {"loc": "upper right", "bbox_to_anchor": (1.0, 0.97)}
            if falls
            else {"loc": "lower right", "bbox_to_anchor": (1.0, 0.03)}
        )
        axes.legend(fontsize=8, labelcolor=INK, frameon=False, handlelength=1.0, **corner)
    axes.set_xlim(min(0.0, 1.03 * float(value.min()) * x_scale), 1.03 * float(max(value.max(), 0.0)) * x_scale or None)
    axes.set_ylim(min(0.0, 1.2 * float(load.min()) * y_scale), 1.2 * float(max(load.max(), 0.0)) * y_scale or None)
    axes.set_xlabel(f"{value_axis(result.case, result.case.quantity)} [{x_unit}]")
    axes.set_ylabel(f"{load_name(result.case)} [{y_unit}]")
    tidy(axes)
    return x_scale, y_scale


def draw_scales(axes: Axes, look: Look, *, full: bool, wide: bool = False) -> None:
    """Explain the colours of bodies and cracks, and say by how much displacements are magnified.

    Parameters
    ----------
    axes : Axes
        Where to draw; its frame is taken away.
    look : Look
        What to explain.
    full : bool
        Whether all bodies are fine.
    wide : bool, optional
        One row rather than one column.
    """
    axes.set_axis_off()
    bars: list[tuple[str, Any, Normalize]] = [("crack opening [µm]", HEAT, look.opening)]
    if look.stress is not None:
        bars.append(("largest principal stress [MPa]", TENSION, look.stress))
    for k, (name, colours, norm) in enumerate(bars):
        place = (0.02 + 0.36 * k, 0.68, 0.3, 0.17) if wide else (0.04, 0.80 - 0.34 * k, 0.92, 0.07)
        bar = axes.figure.colorbar(ScalarMappable(norm, colours), cax=axes.inset_axes(place), orientation="horizontal")
        bar.locator = MaxNLocator(4)
        bar.update_ticks()
        plain_bar(bar, name, fontsize=9, labelpad=1)
        bar.ax.tick_params(labelsize=8, pad=2)
    if look.stress is None:
        kinds = [(FINE, "fine")] if full else [(FINE, "fine"), (COARSE, "coarse")]
        axes.legend(
            handles=[Patch(facecolor=colour, edgecolor=EDGE, label=f"{name} bodies") for colour, name in kinds],
            loc="center left" if wide else "lower left",
            bbox_to_anchor=(0.38, 0.62) if wide else (0.0, 0.18),
            fontsize=9,
            labelcolor=INK,
            frameon=False,
        )
    axes.text(
        0.99 if wide else 0.04,
        0.62 if wide else 0.08,
        f"section at half thickness\ndisplacements × {look.magnify:g}",
        transform=axes.transAxes,
        fontsize=9,
        color=INK,
        ha="right" if wide else "left",
        va="center",
    )


def bar_beside(axes: Axes, colours: Colormap, norm: Normalize, label: str) -> None:
    """Colour bar on the right of axes."""
    bar = axes.figure.colorbar(ScalarMappable(norm, colours), ax=axes, pad=0.02, fraction=0.05, aspect=28)
    plain_bar(bar, label)


def plain_bar(bar: Colorbar, label: str, **look: Any) -> None:
    """Style that all colour bars share: no frame, small ink-coloured letters."""
    bar.set_label(label, color=INK, **look)
    bar.ax.tick_params(colors=INK, labelsize=9)
    bar.outline.set_visible(False)


def kinds_above(axes: Axes, kinds: Iterable[tuple[str, str, str]]) -> None:
    """Legend above axes, flush right, by colour of the faces and of the edges, and name."""
    axes.legend(
        handles=[Patch(facecolor=face, edgecolor=edge, label=name) for face, edge, name in kinds],
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.2,
        ncols=2,
        fontsize=9,
        labelcolor=INK,
        frameon=False,
        handlelength=1.2,
    )
