"""Picture of the cracks: the specimen from its side, contacts coloured by their opening."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fissura.arrays import FloatArray
from fissura.pictures.curves import DPI, INK, bare, headline
from fissura.pictures.front import projected, rims, seen
from fissura.pictures.lettering import may_shrink, save
from fissura.pictures.panels import bar_beside, kinds_above
from fissura.pictures.plotting import new_axes
from fissura.results.load_path import NAMES
from fissura.results.result import Result
from fissura.results.run_data import RunData
from fissura.simulation.step import Snapshot
from fissura.text import quantities as text

SHOWN = 0.02
"""Openings below this part of the largest one are not drawn."""

ZOOMED = 0.05
"""The second panel holds every opening above this part of the largest one."""

FINE, COARSE, EDGE = "#dde6ee", "#f6f4ef", "#b4bcc6"
HEAT = LinearSegmentedColormap.from_list(
    "opening", ["#f6d58c66", "#f3ae52", "#e2622c", "#b32430", "#6d0d33", "#30051d"]
)

WIDE = 10.0
"""Width of the picture [inch]."""


@dataclass(frozen=True)
class View:
    """What one panel shows, in mm: drawn shapes and the window."""

    bodies: list[FloatArray]
    colours: list[str]
    rims: FloatArray
    cracks: list[FloatArray]
    outline: list[FloatArray]
    openings: FloatArray
    norm: Normalize


def plot_crack(result: Result, path: Path) -> None:
    """Draw the last state looking along z: facets that face the viewer, and opened contacts projected onto them.

    The widest opening lies on top. Where anything has opened, a second panel shows the cracked zone.

    Parameters
    ----------
    result : Result
        A run with at least one step.
    path : Path
        File to write; its ending decides the format.
    """
    view = _view(result.last)
    whole = _whole(view)
    zone = _cracked_zone(view)
    figure = Figure(layout="constrained")
    if zone is None:
        figure.set_size_inches(WIDE, _height(whole))
        first = second = figure.add_subplot()
    else:
        beside = _aspect(whole) < 1.4
        zoom = _zoom(zone, whole, 0.8 if beside else 1.8)
        first, second = _panels(figure, whole, zoom, beside)
        _draw(second, view, zoom, 2.0)
        first.add_patch(
            Rectangle(
                (zoom[0], zoom[2]),
                zoom[1] - zoom[0],
                zoom[3] - zoom[2],
                fill=False,
                edgecolor=INK,
                linewidth=0.9,
                linestyle=(0, (4, 3)),
                zorder=6,
            )
        )
        may_shrink(second.set_title("cracked zone", loc="left", fontsize=9, color=INK))
        bar_beside(second, HEAT, view.norm, "crack opening [µm]")
    _draw(first, view, whole, 1.0)
    kinds_above(second, [(FINE, EDGE, "fine"), (COARSE, EDGE, "coarse")])
    # Beside another panel both lines stand above its title, so that they have the whole width.
    _titles(first, result, raised=14.0 if zone is not None and beside else 0.0)
    save(figure, path, DPI)


def crack_axes(result: RunData, ax: Axes | None) -> Axes:
    """Draw the whole specimen as `plot_crack` does into axes; see `Result.plot_crack`."""
    view = _view(result.last)
    whole = _whole(view)
    if ax is None:
        ax = new_axes((WIDE, _height(whole)))
        _titles(ax, result, raised=0.0)
    if len(view.openings):
        bar_beside(ax, HEAT, view.norm, "crack opening [µm]")
    _draw(ax, view, whole, 1.0)
    return ax


def _whole(view: View) -> FloatArray:
    """Window round the specimen."""
    points = np.concatenate(view.outline)
    low, high = points.min(axis=0), points.max(axis=0)
    return _window(low, high, 0.03 * (high - low).max(), 0.0, np.inf)


def _view(snapshot: Snapshot) -> View:
    tessellation = snapshot.tessellation
    surface, contacts = tessellation.surface, tessellation.contacts
    facet = surface.polygons.facet
    on_front = seen(surface)
    # Facets parallel to the line of sight project to lines: the outline, walls of notches included.
    edge_on = np.flatnonzero((np.abs(surface.normal[facet, 2]) < 0.1) & ~surface.ledges[facet])
    opening = snapshot.opening * 1e6
    largest = float(opening.max(initial=0.0))
    of = contacts.polygons.facet
    shown = np.flatnonzero((opening[of] > SHOWN * largest) & (opening[of] > 0))
    shown = shown[np.argsort(opening[of[shown]], kind="stable")]
    fine = tessellation.fine[surface.body[facet]]
    return View(
        bodies=projected(surface.polygons, on_front),
        colours=[FINE if fine[k] else COARSE for k in on_front],
        rims=1e3 * rims(surface.polygons, on_front, surface.body[facet[on_front]])[:, :, :2],
        cracks=projected(contacts.polygons, shown),
        outline=[np.vstack([shape, shape[:1]]) for shape in projected(surface.polygons, edge_on)],
        openings=opening[of[shown]],
        norm=Normalize(0.0, largest or 1.0),
    )


def _draw(axes: Axes, view: View, window: FloatArray, scale: float) -> None:
    axes.add_collection(
        PolyCollection(view.bodies, facecolors=view.colours, edgecolors="face", linewidths=0.3 * scale, zorder=2)
    )
    axes.add_collection(LineCollection(list(view.rims), colors=EDGE, linewidths=0.3 * scale, zorder=2))
    colours = HEAT(view.norm(view.openings))
    axes.add_collection(
        PolyCollection(view.cracks, facecolors=colours, edgecolors=colours, linewidths=0.7 * scale, zorder=3)
    )
    axes.add_collection(LineCollection(view.outline, colors=INK, linewidths=1.0, capstyle="round", zorder=4))
    axes.set_xlim(window[0], window[1])
    axes.set_ylim(window[2], window[3])
    axes.set_aspect("equal")
    bare(axes)


def _cracked_zone(view: View) -> FloatArray | None:
    """Lower and upper corner of what opened most, as [x0, x1, y0, y1]; None without cracks."""
    if not len(view.openings):
        return None
    wide = view.openings >= ZOOMED * view.openings[-1]
    points = np.concatenate([shape for shape, is_wide in zip(view.cracks, wide, strict=True) if is_wide])
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([low[0], high[0], low[1], high[1]])


def _zoom(zone: FloatArray, whole: FloatArray, slimmest: float) -> FloatArray:
    """Window round the cracked zone, moved inside that of the whole specimen."""
    low, high = zone[[0, 2]], zone[[1, 3]]
    window = _window(low, high, 0.08 * (high - low).max(), slimmest, 2.2)
    for i in (0, 2):
        extent = window[i + 1] - window[i]
        if extent >= whole[i + 1] - whole[i]:
            window[i : i + 2] = whole[i : i + 2]
        else:
            start = np.clip(window[i], whole[i], whole[i + 1] - extent)
            window[i : i + 2] = start, start + extent
    return window


def _window(low: FloatArray, high: FloatArray, margin: float, slimmest: float, widest: float) -> FloatArray:
    """Box [x0, x1, y0, y1] with a margin, its aspect (width over height) kept in bounds."""
    centre, half = (low + high) / 2, (high - low) / 2 + margin
    half[0] = max(half[0], slimmest * half[1])
    half[1] = max(half[1], half[0] / widest)
    return np.array([centre[0] - half[0], centre[0] + half[0], centre[1] - half[1], centre[1] + half[1]])


def _aspect(window: FloatArray) -> float:
    return float((window[1] - window[0]) / (window[3] - window[2]))


def _height(window: FloatArray) -> float:
    """Height of a picture that one panel fills [inch]."""
    return float(np.clip((WIDE - 0.8) / _aspect(window), 1.6, 9.0) + 0.9)


def _panels(figure: Figure, whole: FloatArray, zoom: FloatArray, beside: bool) -> tuple[Axes, Axes]:
    """Panels below each other for a long specimen, side by side for a compact one."""
    if beside:
        widths = (_aspect(whole), _aspect(zoom) * 1.18)
        height = np.clip((WIDE - 2.0) / sum(widths), 2.5, 6.5) + 1.1
        figure.set_size_inches(WIDE, height)
        # The layout leaves no room for the headline of a panel that is lower than the one beside it.
        figure.set_layout_engine("constrained", rect=(0.0, 0.0, 1.0, 1.0 - 0.2 / height))
        first, second = figure.subplots(1, 2, width_ratios=widths)
        return first, second
    heights = ((WIDE - 0.9) / _aspect(whole), (WIDE - 2.0) / _aspect(zoom))
    figure.set_size_inches(WIDE, sum(heights) + 1.8)
    first, second = figure.subplots(2, 1, height_ratios=heights)
    return first, second


def _titles(axes: Axes, result: RunData, raised: float) -> None:
    step = int(result.curve["step"][-1])
    value, load = text.length(float(result.controlled[-1])), text.force(float(result.load_values[-1]))
    bodies = text.count(float(result.curve["bodies"][-1]))
    headline(
        axes,
        result.case.name,
        f"step {step}: {NAMES[result.case.quantity]} {value}, load {load}, {bodies} bodies",
        raised=raised,
    )
