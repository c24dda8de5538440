"""The specimen of a case in three dimensions before anything is run: bodies, surfaces, supports, load and gauge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fissura.results.lettering import legend_below, literal, save
from fissura.results.pictures import INK
from fissura.results.stage import COARSE, FINE
from fissura.specimen import Place, load_direction, place_from_part
from fissura.specimen.notches import SURFACE
from fissura.specimen.planes import unit
from fissura.tessellation.structure import LEDGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura.simulation import Simulation
    from fissura.tessellation import SurfaceFacets

__all__ = ["Sight", "plot_specimen"]

FloatArray = NDArray[np.float64]

SUPPORT, LOAD, GAUGE, NOTCH = "#4b5563", "#b42318", "#1d4ed8", "#f2c14e"

MARKERS = {"pin": "^", "roller": "o", "clamp": "s", "guide": "D"}
"""Signs of the kinds of supports."""

MOST_POINTS = 60
"""Sample points of a place that are drawn, at most."""

HIDDEN = 0.35
"""Opacity of what lies on the far side."""


@dataclass(frozen=True)
class Sight:
    """Direction from which a specimen is seen, without perspective; y points up.

    Attributes
    ----------
    azimuth : float
        Angle to the right of the z axis [degrees].
    elevation : float
        Angle above the horizontal plane [degrees], within -90 and 90.
    """

    azimuth: float = 30.0
    elevation: float = 25.0

    @property
    def axes(self) -> FloatArray:
        """Unit vectors to the right, up, and towards the eye, as rows (3, 3)."""
        a, e = np.radians([self.azimuth, self.elevation])
        eye = np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
        right = np.array([np.cos(a), 0.0, -np.sin(a)])
        return np.stack([right, np.cross(eye, right), eye])


def plot_specimen(simulation: Simulation, path: str | Path, sight: Sight | None = None) -> None:
    """Draw the first discretization of a simulation, with surfaces, supports, load and gauge.

    Parameters
    ----------
    simulation : Simulation
        It has not been run.
    path : str or Path
        Picture to write, such as ``specimen.png``.
    sight : Sight, optional
        From where.
    """
    case, look = simulation.case, (sight or Sight()).axes
    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.set_axis_off()
    surface = simulation.tessellation.surface
    colours = _skin(axes, surface, simulation.tessellation.fine, look)
    corners = 1e3 * surface.polygons.points @ look[:2].T
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float((high - low).max())
    unseen = _names(axes, surface, look)
    entries = [(Line2D([], [], marker="s", ls="", ms=9, color=colour), name) for name, colour in colours]
    entries += _conditions(axes, simulation, look, 0.11 * size)
    axes.set_xlim(low[0] - 0.14 * size, high[0] + 0.14 * size)
    axes.set_ylim(low[1] - 0.14 * size, high[1] + 0.14 * size)
    kind = "full resolution" if simulation.full else f"start; {simulation.bodies_full} at full resolution"
    extent = " x ".join(f"{1e3 * length:.4g}" for length in simulation.domain.size)
    lines = [f"{case.name}: {extent} mm, {simulation.bodies_start} bodies ({kind})"]
    if unseen:
        lines.append(f"not in view: {', '.join(unseen)}")
    figure.suptitle("\n".join(literal(line) for line in lines), fontsize=11, color=INK)
    legend_below(figure, [(artist, literal(name)) for artist, name in entries], colour=INK)
    save(figure, Path(path), dpi=110)


def _skin(axes: Axes, surface: SurfaceFacets, fine: NDArray[np.bool_], look: FloatArray) -> list[tuple[str, str]]:
    """Draw facets that face the eye, the farthest first; return the colours used, by what they mean."""
    polygons = surface.polygons
    shapes = np.split(polygons.points, polygons.offsets[1:-1])
    facet, eye = polygons.facet, look[2]
    depth = np.add.reduceat(polygons.points @ eye, polygons.offsets[:-1]) / np.diff(polygons.offsets)
    facing = surface.normal[facet] @ eye
    order = np.flatnonzero(facing > 1e-9)
    order = order[np.argsort(depth[order], kind="stable")]
    notched = np.array([name == SURFACE for name in surface.names])[surface.surface]
    is_fine = fine[surface.body]
    base = np.where(notched[:, None], to_rgb(NOTCH), np.where(is_fine[:, None], to_rgb(FINE), to_rgb(COARSE)))
    # Light comes from above the eye, so that faces of one body differ.
    light = 0.62 + 0.38 * np.clip(surface.normal @ unit(eye + 0.6 * look[1] - 0.35 * look[0]), 0.0, 1.0)
    shade = base[facet[order]] * light[facet[order], None]
    axes.add_collection(
        PolyCollection(
            [1e3 * shapes[k] @ look[:2].T for k in order],
            facecolors=shade.tolist(),
            edgecolors=(0.8 * shade).tolist(),
            linewidths=0.4,
        )
    )
    entries = [("coarse body", COARSE)] if not is_fine.all() else []
    entries += [("fine body", FINE)] if is_fine.any() else []
    return entries + ([("wall of a notch", NOTCH)] if (notched[facet[order]]).any() else [])


def _names(axes: Axes, surface: SurfaceFacets, look: FloatArray) -> list[str]:
    """Write names of surfaces where they are seen; return those that are not."""
    facing = surface.normal @ look[2]
    unseen = []
    for number, name in enumerate(surface.names):
        own = surface.surface == number
        seen = np.flatnonzero(own & (facing > 0.05))
        if name == LEDGE or not own.any():
            continue
        if not len(seen):
            unseen.append(name)
            continue
        share = surface.area[seen] * facing[seen]
        middle = share @ surface.centroid[seen] / share.sum()
        # The mean of a bent surface may lie inside: its nearest facet in view does not.
        spot = surface.centroid[seen[np.argmin(np.linalg.norm(surface.centroid[seen] - middle, axis=1))]]
        at = 1e3 * look[:2] @ spot
        axes.text(
            at[0], at[1], literal(name), ha="center", va="center", fontsize=8.5, color=INK, zorder=20,
            bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
        )  # fmt: skip
    return unseen


def _conditions(axes: Axes, simulation: Simulation, look: FloatArray, size: float) -> list[tuple[Line2D, str]]:
    """Draw supports, load and gauge; return entries of the legend."""
    case, domain, l_f = simulation.case, simulation.domain, simulation.case.discretization.l_f
    entries = []
    for k, part in enumerate(case.supports):
        _points(axes, place_from_part(part, domain, l_f, f"supports[{k}]"), look, MARKERS[part.type], SUPPORT)
    for kind in dict.fromkeys(part.type for part in case.supports):
        entries.append((Line2D([], [], marker=MARKERS[kind], ls="", ms=7, color=SUPPORT), f"support, {kind}"))
    for load in case.named_loads:
        place = place_from_part(load.part, domain, l_f, load.key)
        _arrows(axes, place, load_direction(load.part, place, load.key), look, size)
    if case.named_loads:
        entries.append((Line2D([], [], marker=r"$\rightarrow$", ls="", ms=13, color=LOAD), "load"))
    for gauge in case.named_gauges:
        middles = []
        for name in ("a", "b"):
            place = place_from_part(getattr(gauge.part, name), domain, l_f, f"{gauge.key}.{name}")
            _points(axes, place, look, "o", GAUGE, size=3.0)
            middles.append(1e3 * look[:2] @ place.centroid)
        axes.add_collection(LineCollection([np.array(middles)], colors=GAUGE, linewidths=1.2, zorder=16))
    if case.named_gauges:
        entries.append((Line2D([], [], marker="o", ms=4, lw=1.2, color=GAUGE), "gauge, from a to b"))
    return entries


def _some(place: Place) -> NDArray[np.int64]:
    """Evenly many of a place's points."""
    count = min(len(place.points), MOST_POINTS)
    return np.unique(np.linspace(0, len(place.points) - 1, count).round().astype(np.int64))


def _points(axes: Axes, place: Place, look: FloatArray, marker: str, colour: str, size: float = 4.5) -> None:
    """Mark points of a place; those on the far side are pale."""
    some = _some(place)
    at, seen = 1e3 * place.points[some] @ look[:2].T, place.normals[some] @ look[2] > 0.0
    for which, alpha in ((seen, 1.0), (~seen, HIDDEN)):
        axes.plot(*at[which].T, marker, ms=size, color=colour, mec="white", mew=0.4, alpha=alpha, zorder=15)


def _arrows(axes: Axes, place: Place, direction: FloatArray, look: FloatArray, size: float) -> None:
    """Draw arrows along a load: they end where it presses, and begin where it pulls."""
    some = _some(place)
    some = some[np.unique(np.linspace(0, len(some) - 1, min(len(some), 9)).round().astype(np.int64))]
    shift = size * look[:2] @ direction
    for point, normal in zip(place.points[some], place.normals[some], strict=True):
        tip = 1e3 * look[:2] @ point
        start, end = (tip - shift, tip) if normal @ direction <= 0.0 else (tip, tip + shift)
        # Where it acts on the far side but its arrow stands out of the specimen, it is seen all the same.
        axes.annotate(
            "", xy=end, xytext=start, zorder=17, annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": LOAD, "lw": 1.4, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
    if np.linalg.norm(shift) < 0.15 * size:  # along the line of sight
        _points(axes, place, look, "x", LOAD)
