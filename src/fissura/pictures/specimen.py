"""The specimen of a case in three dimensions before anything is run: bodies, surfaces, supports, loads and gauges."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.pictures.curves import INK
from fissura.pictures.lettering import legend_below, literal, may_shrink, save
from fissura.pictures.side_view import COARSE, FINE
from fissura.pictures.specimen_signs import SUPPORT, WEIGHT, Signs, Spots, named_facets, signs_of
from fissura.specimen.notches import SURFACE
from fissura.specimen.planes import unit
from fissura.tessellation import SurfaceFacets

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

NOTCH = "#f2c14e"
"""Colour of walls of notches."""

MARKERS = {"pin": "^", "roller": "o", "clamp": "s", "guide": "D"}
"""Signs of the kinds of supports; those of other packages are hexagons."""

BEHIND, BEFORE = 0.5, 1.5
"""Heights of platens on the far and on the near side of the specimen, which is at 1."""

JOINED = 1e-6
"""Distance in a picture up to which corners of polygons are the same [mm]."""

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
    """Draw the first discretization of a simulation, with surfaces, supports, platens, loads, gauges and gravity.

    Parameters
    ----------
    simulation : Simulation
        It has not been run.
    path : str or Path
        Picture to write, such as ``specimen.png``.
    sight : Sight, optional
        From where.

    Examples
    --------
    >>> plot_specimen(fissura.Simulation(case), "specimen.png")
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
    signs = signs_of(case, simulation.domain)
    entries = [(_square(colour), name) for name, colour in colours]
    entries += _plates(axes, signs, look)
    entries += _conditions(axes, signs, look, 0.11 * size)
    if signs.weight is not None:
        entries.append(_weight(axes, signs.weight, low, high, look))
    axes.set_xlim(low[0] - 0.14 * size, high[0] + 0.14 * size)
    axes.set_ylim(low[1] - 0.14 * size, high[1] + 0.14 * size)
    kind = "full resolution" if simulation.full else f"start; {simulation.told_full} at full resolution"
    extent = " x ".join(f"{1e3 * length:.4g}" for length in simulation.domain.size)
    lines = [case.name, f"{extent} mm, {simulation.bodies_start} bodies ({kind})"]
    if unseen:
        lines.append(f"not in view: {', '.join(unseen)}")
    title = "\n".join(literal(line) for line in lines)
    may_shrink(figure.suptitle(title, x=0.02, ha="left", fontsize=11, color=INK))
    names = {name: artist for artist, name in entries}  # each once
    legend_below(figure, [(artist, literal(name)) for name, artist in names.items()], colour=INK)
    save(figure, Path(path), dpi=110)


def _whole(shapes: list[FloatArray], facet: IntArray) -> tuple[list[FloatArray], IntArray]:
    """Polygons (k, 2) [mm] of each facet as one, and the facet: what divides them divides the specimen, and no body."""
    groups: dict[int, list[FloatArray]] = {}
    for shape, of in zip(shapes, facet.tolist(), strict=True):
        groups.setdefault(of, []).append(shape)
    found: list[FloatArray] = []
    owner: list[int] = []
    for of, group in groups.items():
        if len(group) > 1:
            whole = shapely.union_all([shapely.Polygon(shape) for shape in group], grid_size=JOINED)
            group = [np.array(part.exterior.coords[:-1]) for part in shapely.get_parts(whole) if not part.is_empty]
        found += group
        owner += [of] * len(group)
    return found, np.array(owner, dtype=np.int64)


def _skin(axes: Axes, surface: SurfaceFacets, fine: BoolArray, look: FloatArray) -> list[tuple[str, str]]:
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
    shade = base * _light(surface.normal, look)[:, None]
    seen, owner = _whole([1e3 * shapes[k] @ look[:2].T for k in order], facet[order])
    colours = shade[owner]
    axes.add_collection(
        PolyCollection(seen, facecolors=colours.tolist(), edgecolors=(0.8 * colours).tolist(), linewidths=0.4)
    )
    entries = [("coarse body", COARSE)] if not is_fine.all() else []
    entries += [("fine body", FINE)] if is_fine.any() else []
    return entries + ([("wall of a notch", NOTCH)] if (notched[facet[order]]).any() else [])


def _names(axes: Axes, surface: SurfaceFacets, look: FloatArray) -> list[str]:
    """Write names of surfaces where they are seen; return those that are not."""
    facing = surface.normal @ look[2]
    unseen = []
    for name, k in named_facets(surface, np.where(facing > 0.05, surface.area * facing, 0.0)).items():
        if k is None:
            unseen.append(name)
            continue
        at = 1e3 * look[:2] @ surface.centroid[k]
        axes.text(
            at[0], at[1], literal(name), ha="center", va="center", fontsize=8.5, color=INK, zorder=20,
            bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
        )  # fmt: skip
    return unseen


def _plates(axes: Axes, signs: Signs, look: FloatArray) -> list[tuple[Line2D, str]]:
    """Draw platens: those that face the eye before the specimen, others behind it; return entries of the legend."""
    for plate in signs.plates:
        facing = np.flatnonzero(plate.normals @ look[2] > 1e-9)
        facing = facing[np.argsort([plate.faces[k].mean(axis=0) @ look[2] for k in facing])]
        shade = np.array(to_rgb(plate.colour)) * _light(plate.normals[facing], look)[:, None]
        axes.add_collection(
            PolyCollection(
                [1e3 * plate.faces[k] @ look[:2].T for k in facing],
                facecolors=shade.tolist(),
                edgecolors=shade.tolist(),
                linewidths=0.3,
                zorder=BEFORE if plate.outward @ look[2] > 0.0 else BEHIND,
            )
        )
    return [(_square(plate.colour), plate.label) for plate in signs.plates]


def _conditions(axes: Axes, signs: Signs, look: FloatArray, size: float) -> list[tuple[Line2D, str]]:
    """Draw supports, loads and gauges; return entries of the legend."""
    entries = []
    for support in signs.supports:
        marker = MARKERS.get(support.kind, "h")
        _points(axes, support.spots, look, marker, SUPPORT)
        sign = Line2D([], [], marker=marker, ls="", ms=7, color=SUPPORT)
        entries.append((sign, support.label))
    for load in signs.loads:
        begin, end = load.arrows(1e-3 * size)
        for points in zip(1e3 * begin @ look[:2].T, 1e3 * end @ look[:2].T, strict=True):
            _arrow(axes, *points, load.colour)
        if np.linalg.norm(look[:2] @ load.direction) < 0.15:  # along the line of sight
            _points(axes, load.spots, look, "x", load.colour)
        entries.append((_arrow_sign(load.colour), load.label))
    for gauge in signs.gauges:
        for spots in gauge.places:
            _points(axes, spots, look, "o", gauge.colour, size=3.0)
        line = 1e3 * gauge.line @ look[:2].T
        axes.add_collection(LineCollection([line], colors=gauge.colour, linewidths=1.2, zorder=16))
        entries.append((Line2D([], [], marker="o", ms=4, lw=1.2, color=gauge.colour), gauge.label))
    return entries


def _weight(axes: Axes, way: FloatArray, low: FloatArray, high: FloatArray, look: FloatArray) -> tuple[Line2D, str]:
    """Draw the weight as an arrow beside the specimen; return its entry of the legend."""
    size = float((high - low).max())
    middle, half = np.array([low[0] - 0.08 * size, 0.5 * (low[1] + high[1])]), 0.1 * size * (look[:2] @ way)
    if np.linalg.norm(half) < 0.015 * size:  # along the line of sight
        axes.plot(*middle, "x", ms=9, mew=2.5, color=WEIGHT, zorder=17)
    else:
        _arrow(axes, middle - half, middle + half, WEIGHT, width=3.0)
    return _arrow_sign(WEIGHT), "gravity"


def _light(normals: FloatArray, look: FloatArray) -> FloatArray:
    """Brightness of faces: light comes from above the eye, so that faces of one body differ; (f, 3) -> (f,)."""
    return np.asarray(0.62 + 0.38 * np.clip(normals @ unit(look[2] + 0.6 * look[1] - 0.35 * look[0]), 0.0, 1.0))


def _points(axes: Axes, spots: Spots, look: FloatArray, marker: str, colour: str, size: float = 4.5) -> None:
    """Mark points of a place; those on the far side are pale."""
    at, seen = 1e3 * spots.points @ look[:2].T, spots.normals @ look[2] > 0.0
    for which, alpha in ((seen, 1.0), (~seen, HIDDEN)):
        (marks,) = axes.plot(*at[which].T, marker, ms=size, color=colour, alpha=alpha, zorder=15)
        if marker != "x":
            marks.set(markeredgecolor="white", markeredgewidth=0.4)


def _arrow(axes: Axes, start: FloatArray, end: FloatArray, colour: str, width: float = 1.4) -> None:
    # Where it acts on the far side but its arrow stands out of the specimen, it is seen all the same.
    axes.annotate(
        "", xy=tuple(end), xytext=tuple(start), zorder=17, annotation_clip=False,
        arrowprops={"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip


def _arrow_sign(colour: str) -> Line2D:
    return Line2D([], [], marker=r"$\rightarrow$", ls="", ms=13, color=colour)


def _square(colour: str) -> Line2D:
    return Line2D([], [], marker="s", ls="", ms=9, color=colour)
