"""The specimen of a case in a window that turns, before anything is run; needs the extra ``view``."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.pictures.curves import INK
from fissura.pictures.lettering import literal
from fissura.pictures.pyvista_tools import legend, plotter, polygon_mesh, pyvista, toggled
from fissura.pictures.side_view import COARSE, FINE
from fissura.pictures.specimen import NOTCH, Sight
from fissura.pictures.specimen_signs import SUPPORT, WEIGHT, Signs, Spots, named_facets, signs_of
from fissura.specimen.notches import SURFACE
from fissura.tessellation import SurfaceFacets

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

Entries = list[tuple[str, str]]

MM = 1e3
"""Views are in mm."""


def specimen_view(simulation: Simulation, sight: Sight | None = None, *, off_screen: bool | None = None) -> Any:
    """Show the first discretization of a simulation with all that `plot_specimen` draws, in mm.

    Parameters
    ----------
    simulation : Simulation
        It has not been run.
    sight : Sight, optional
        From where one looks first.
    off_screen : bool, optional
        Whether it is drawn into memory instead of a window; None where PyVista decides, as in a notebook.

    Returns
    -------
    pyvista.Plotter
        Its method ``show`` opens the window, or shows the view in a notebook.

    Raises
    ------
    InputError
        PyVista is not installed.

    Examples
    --------
    >>> view = specimen_view(fissura.Simulation(case), off_screen=True)  # doctest: +RENDER
    """
    view, look = plotter(off_screen=off_screen), (sight or Sight()).axes
    surface, domain = simulation.tessellation.surface, simulation.domain
    size = MM * float(domain.size.max())
    bodies, entries = _bodies(view, surface, simulation.tessellation.fine)
    signs = signs_of(simulation.case, domain)
    _plates(view, signs)
    _supports(view, signs, 0.02 * size)
    _loads(view, signs, 0.12 * size)
    _gauges(view, signs, 0.008 * size)
    if signs.weight is not None:
        low, high = MM * domain.bounds
        start = np.array([low[0] - 0.1 * size, 0.5 * (low[1] + high[1]), high[2]]) - 0.1 * size * signs.weight
        arrow = pyvista().Arrow(start=start, direction=signs.weight, scale=0.2 * size)
        view.add_mesh(arrow, color=WEIGHT)
    _names(view, surface, 0.01 * size)
    view.add_text(literal(f"{simulation.case.name}: {simulation.bodies_start} bodies"), font_size=11, color=INK)
    legend(view, [*entries, *((plate.label, plate.colour) for plate in signs.plates), *signs.legend])
    view.show_bounds(
        xtitle="x [mm]", ytitle="y [mm]", ztitle="z [mm]", location="outer", font_size=9, color="#6b7280", n_xlabels=3,
        n_ylabels=3, n_zlabels=3, fmt="%.4g", bounds=(MM * domain.bounds).T.ravel().tolist(),
    )  # fmt: skip
    toggled(view, bodies, 0.25, "look inside")
    view.view_vector(look[2], viewup=look[1])
    view.camera.SetWindowCenter(0.0, -0.12)  # above the legend
    return view


def _bodies(view: Any, surface: SurfaceFacets, fine: BoolArray) -> tuple[list[Any], Entries]:
    """Show what bodies have of the surface, by kinds; return what is not a wall of a notch, and the legend."""
    polygons = surface.polygons
    names = np.array(surface.names)[surface.surface]
    kinds = np.where(names == SURFACE, 2, fine[surface.body].astype(int))[polygons.facet]
    sizes, actors, entries = np.diff(polygons.offsets), [], []
    for kind, (label, colour) in enumerate((("coarse body", COARSE), ("fine body", FINE), ("wall of a notch", NOTCH))):
        own = kinds == kind
        if not own.any():
            continue
        offsets = np.concatenate([[0], np.cumsum(sizes[own])])
        mesh = polygon_mesh(MM * polygons.points[np.repeat(own, sizes)], offsets)
        actor = view.add_mesh(mesh, color=colour, show_edges=True, edge_color="#8a8f98", line_width=0.6)
        actors += [actor] if kind < 2 else []
        entries.append((label, colour))
    return actors, entries


def _plates(view: Any, signs: Signs) -> None:
    for plate in signs.plates:
        offsets = np.cumsum([0, *(len(face) for face in plate.faces)])
        view.add_mesh(polygon_mesh(MM * np.concatenate(plate.faces), offsets), color=plate.colour)


def _supports(view: Any, signs: Signs, size: float) -> None:
    pv = pyvista()
    # Each touches the surface in the origin and stands off it along x.
    shapes = {
        "pin": pv.Cone(center=(0.5, 0, 0), direction=(-1, 0, 0), height=1.0, radius=0.45),
        "roller": pv.Sphere(radius=0.5, center=(0.5, 0, 0)),
        "clamp": pv.Cube(center=(0.4, 0, 0), x_length=0.8, y_length=0.8, z_length=0.8),
        "guide": pv.PlatonicSolid("octahedron", radius=0.5, center=(0.5, 0, 0)),
    }
    for support in signs.supports:
        view.add_mesh(_at(support.spots, shapes.get(support.kind, shapes["clamp"]), size), color=SUPPORT)


def _loads(view: Any, signs: Signs, length: float) -> None:
    shape = pyvista().Arrow(tip_length=0.2, tip_radius=0.06, shaft_radius=0.018)
    for load in signs.loads:
        begin, end = load.arrows(length / MM)
        view.add_mesh(_at(Spots(begin, end - begin), shape, length), color=load.colour)
        if len(signs.loads) > 1:
            _words(view, MM * begin.mean(axis=0)[None, :], [load.label], load.colour, always=True)


def _gauges(view: Any, signs: Signs, radius: float) -> None:
    pv = pyvista()
    for gauge in signs.gauges:
        parts = [_at(spots, pv.Sphere(radius=1.0), radius) for spots in gauge.places]
        for a, b in pairwise(MM * gauge.line):
            parts.append(pv.Line(pointa=a, pointb=b).tube(radius=0.6 * radius))
        view.add_mesh(pv.merge(parts), color=gauge.colour)


def _at(spots: Spots, shape: Any, size: float) -> Any:
    """A shape at every spot, its x axis along the normal there."""
    points = pyvista().PolyData(MM * spots.points)
    points["way"] = spots.normals
    return points.glyph(orient="way", scale=False, factor=size, geom=shape)


def _names(view: Any, surface: SurfaceFacets, lift: float) -> None:
    """Names of surfaces at the facet nearest to their middle."""
    spots, names = [], []
    for name, k in named_facets(surface, surface.area).items():
        if k is None:
            continue
        spots.append(MM * surface.centroid[k] + lift * surface.normal[k])
        names.append(name)
    _words(view, np.array(spots), names, INK, always=False)


def _words(view: Any, points: FloatArray, texts: list[str], colour: str, *, always: bool) -> None:
    view.add_point_labels(
        points, [literal(text) for text in texts], text_color=colour, font_size=15, bold=False, show_points=False,
        shape_color="white", shape_opacity=0.8, always_visible=always,
    )  # fmt: skip
