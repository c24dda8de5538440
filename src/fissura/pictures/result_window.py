"""A step of a run in three dimensions: cracks inside the skin of the bodies; needs the extra ``view``."""

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.pictures.curves import INK
from fissura.pictures.lettering import literal
from fissura.pictures.meshes import meshes_of, step_of
from fissura.pictures.pyvista_tools import legend, plotter, pyvista, toggled
from fissura.pictures.side_view import COARSE, FINE, HEAT, SHOWN, magnification
from fissura.pictures.specimen import Sight
from fissura.results.run_data import RunData
from fissura.text import quantities as text

SEE_THROUGH = 0.3
"""Opacity of the skin."""


def result_view(
    result: RunData, step: int | None = None, *, magnify: float | None = None, off_screen: bool | None = None
) -> Any:
    """Show a step: what bodies have of the surface, transparent, and the cracks inside, coloured by their opening.

    Parameters
    ----------
    result : Result
        The run.
    step : int, optional
        Which step; the last one by default.
    magnify : float, optional
        Factor on displacements; by default a round number such that the largest is a few per cent of the specimen.
    off_screen : bool, optional
        Whether it is drawn into memory instead of a window; None where PyVista decides, as in a notebook.

    Returns
    -------
    pyvista.Plotter
        Its method ``show`` opens the window, or shows the view in a notebook.

    Raises
    ------
    InputError
        There is no state of this step, or PyVista is not installed.
    """
    number = step_of(result, step)
    view, meshes = plotter(off_screen=off_screen), meshes_of(result, number)
    bodies, cracks = meshes["bodies"], meshes["cracks"]
    if magnify is None:
        largest = float(np.linalg.norm(bodies.point_data["displacement"], axis=1).max())
        magnify = magnification(largest, bodies.length)
    skin = skin_of(bodies).warp_by_vector("displacement", factor=magnify).scale(1e3)
    fine, actors, entries = skin.cell_data["fine"].astype(bool), [], []
    for own, label, colour in ((~fine, "coarse body", COARSE), (fine, "fine body", FINE)):
        if own.any():
            part = skin.extract_cells(np.flatnonzero(own))
            look: dict[str, Any] = {"opacity": SEE_THROUGH, "show_edges": True, "edge_color": "#8a8f98"}
            actors.append(view.add_mesh(part, color=colour, line_width=0.6, **look))
            entries.append((label, colour))
    opening = cracks.cell_data["opening"]
    wide = np.flatnonzero(opening > SHOWN * max(float(opening.max(initial=0.0)), 1e-300))
    if len(wide):
        shown = cracks.extract_cells(wide).warp_by_vector("displacement", factor=magnify).scale(1e3)
        shown.cell_data["crack opening [µm]"] = 1e6 * opening[wide]
        bar = {"vertical": True, "position_x": 0.86, "position_y": 0.25, "height": 0.5, "fmt": "%.3g", "color": INK}
        bar |= {"title_font_size": 15, "label_font_size": 13}
        most = 1e6 * float(opening.max())
        view.add_mesh(shown, scalars="crack opening [µm]", cmap=HEAT, clim=[0.0, most], scalar_bar_args=bar)
    view.add_text(_title(result, number, magnify), font_size=11, color=INK)
    legend(view, entries)
    toggled(view, actors, SEE_THROUGH, "skin opaque or not")
    look_from = Sight().axes
    view.view_vector(look_from[2], viewup=look_from[1])
    return view


def skin_of(bodies: Any) -> Any:
    """Faces of bodies that lie on the surface of the specimen, as a PyVista mesh with the data of the bodies.

    Parameters
    ----------
    bodies : pyvista.UnstructuredGrid
        Polyhedra that share no points, where they were before they moved.
    """
    with warnings.catch_warnings():  # versions of PyVista differ in how they want to be asked
        warnings.simplefilter("ignore")
        faces = bodies.extract_surface()
    near = 1e-6 * float(bodies.length)
    pairs: NDArray[np.int64] = cKDTree(_centroids(faces)).query_pairs(near, output_type="ndarray")
    # Two bodies look at each other through their common face; walls of an ideal cut that match by chance do, too.
    lone = np.ones(faces.n_cells, bool)
    lone[pairs.ravel()] = False
    return faces.extract_cells(np.flatnonzero(lone))


def _centroids(faces: Any) -> NDArray[np.float64]:
    """Centroids of polygons, shape (f, 3), which do not depend on the corner with which a polygon begins."""
    polygons = faces.GetPolys()
    offsets = np.asarray(pyvista().convert_array(polygons.GetOffsetsArray()), np.int64)
    corner = np.asarray(pyvista().convert_array(polygons.GetConnectivityArray()), np.int64)
    points, start = np.asarray(faces.points, float)[corner], offsets[:-1]
    origin = np.repeat(points[start], np.diff(offsets), axis=0)
    following = np.arange(len(points)) + 1
    following[offsets[1:] - 1] = start
    a, b = points - origin, points[following] - origin
    doubled = np.cross(a, b)
    normal = np.repeat(np.add.reduceat(doubled, start), np.diff(offsets), axis=0)
    area = np.einsum("ca,ca->c", doubled, normal)[:, None]
    moment = np.add.reduceat(area * (a + b) / 3.0, start)
    return np.asarray(points[start] + moment / np.maximum(np.add.reduceat(area, start), 1e-300))


def _title(result: RunData, number: int, magnify: float) -> str:
    at = np.flatnonzero(result.curve["step"] == number)
    load = f", load {text.force(float(result.load_values[at[0]]))}" if len(at) else ""
    return literal(f"{result.case.name}: step {number}{load}, displacements x {magnify:g}")
