"""The 3D view of a page: what K3D draws, and what the page's JavaScript puts into it step by step."""

import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np
from matplotlib.colors import Colormap, to_rgb

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.pictures.side_view import COARSE, FINE, HEAT, SHOWN, TENSION, magnification
from fissura.pictures.specimen import Sight
from fissura.pictures.specimen_signs import SUPPORT, WEIGHT, signs_of
from fissura.reports.bodies import State
from fissura.specimen import Domain

Marks = tuple[str, FloatArray, FloatArray, str]
"""Points with values: what they are, where (k, 3) [m], their values (k,), and what values are called, with the unit."""

MM = 1e3
STOPS = 17
"""Colours that stand for a colour map."""

ANGLE = 30.0
"""Vertical angle of view [degrees]."""


def scene_of(case: Case, domain: Domain, states: Sequence[State] = (), marks: Marks | None = None) -> dict[str, Any]:
    """What a page needs to draw a specimen, or the states of a run.

    Parameters
    ----------
    case : Case
        The case.
    domain : Domain
        Its specimen, which is drawn where there are no states.
    states : sequence of dict, optional
        Of `fissura.reports.bodies.states_of`.
    marks : Marks, optional
        Points with values in the specimen.

    Returns
    -------
    dict
        For `fissura.reports.packed.packed`.
    """
    bounds = MM * domain.bounds
    return {
        "plot": _plot(case, domain, marks, specimen=not states),
        "states": list(states),
        "bounds": bounds.tolist(),
        "sight": Sight().axes.tolist(),
        "angle": ANGLE,
        "magnify": _magnify(states, float(np.ptp(bounds, axis=0).max())),
        "widest": max((state["cracks"]["opening"]["high"] for state in states), default=0.0),
        "shown": SHOWN,
        "stress": _largest_stress(states),
        "maps": {
            "opening": _stops(HEAT),
            "damage": _stops(HEAT),
            "stress": _stops(TENSION),
            "fine": _two(COARSE, FINE),
        },
        "marks": None
        if marks is None
        else {"name": marks[3], "low": float(marks[2].min()), "high": float(marks[2].max())},
    }


def _plot(case: Case, domain: Domain, marks: Marks | None, *, specimen: bool) -> bytes:
    """K3D's own form of all that does not change from step to step, and of what changes as it is to look."""
    k3d = import_module("k3d")
    # Pages set camera, colours and planes; K3D's own menu would save what needs the network.
    plot = k3d.plot(
        camera_auto_fit=False, menu_visibility=False, axes=["x", "y", "z"], camera_fov=ANGLE, camera_mode="orbit",
        camera_up_axis="y", grid_auto_fit=False, grid=(MM * domain.bounds).ravel().tolist(), name="fissura",
        grid_visible=False, colorbar_object_id=0,
    )  # fmt: skip
    nothing = np.zeros((3, 3), np.float32)
    look: dict[str, Any] = {"attribute": np.zeros(3, np.float32), "color_range": [0.0, 1.0], "color_map": _stops(HEAT)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        things = [
            k3d.mesh(nothing, [[0, 1, 2]], name=name, side="double", roughness=1.0, **look)
            for name in (() if specimen else ("skin", "cracks"))
        ]
        things.append(
            k3d.lines(nothing, [[0, 1]], indices_type="segment", shader="simple", color=0x6B7280, name="edges")
        )
        things += [*_signs(k3d, case, domain), *_specimen(k3d, domain, specimen), *_marks(k3d, domain, marks)]
        for number, thing in enumerate(things, 1):
            thing.id = number  # by itself it would be another one each time
            plot += thing
        return bytes(plot.get_binary_snapshot(9))


def _signs(k3d: Any, case: Case, domain: Domain) -> list[Any]:
    """Supports and ends of gauges as points, loads and gravity as arrows."""
    signs, size = signs_of(case, domain), MM * float(domain.size.max())

    def dots(points: FloatArray, colour: str, share: float) -> Any:
        place = (MM * points).astype(np.float32)
        return k3d.points(place, point_size=share * size, shader="mesh", color=_number(colour), name="sign")

    def arrows(begin: FloatArray, end: FloatArray, colour: str) -> Any:
        begin, end = (MM * points for points in (begin, end))
        return k3d.vectors(
            begin.astype(np.float32), (end - begin).astype(np.float32), color=_number(colour), head_size=0.03 * size,
            line_width=0.004 * size, name="sign",
        )  # fmt: skip

    found = [dots(support.spots.points, SUPPORT, 0.022) for support in signs.supports]
    for gauge in signs.gauges:
        found += [dots(spots.points, gauge.colour, 0.014) for spots in gauge.places]
    found += [arrows(*load.arrows(0.12 * size / MM), load.colour) for load in signs.loads]
    if signs.weight is not None:
        low, high = domain.bounds
        start = np.array([[low[0] - 0.05 * size / MM, 0.5 * (low[1] + high[1]), high[2]]])
        found.append(arrows(start, start + 0.2 * size / MM * signs.weight, WEIGHT))
    return found


def _specimen(k3d: Any, domain: Domain, wanted: bool) -> list[Any]:
    """The surface of the specimen, with what is seen of its edges."""
    if not wanted:
        return []
    polygons = [MM * part.polygon for part in domain.faces()]
    points = np.concatenate(polygons).astype(np.float32)
    start = np.cumsum([0, *(len(polygon) for polygon in polygons)])
    fans = [
        [first, first + k, first + k + 1]
        for first, polygon in zip(start, polygons, strict=False)
        for k in range(1, len(polygon) - 1)
    ]
    colour = _number(COARSE)
    return [k3d.mesh(points, fans, color=colour, opacity=0.35, side="double", roughness=1.0, name="specimen")]


def _marks(k3d: Any, domain: Domain, marks: Marks | None) -> list[Any]:
    if marks is None:
        return []
    name, points, values, _ = marks
    low, high = float(values.min()), float(values.max())
    look: dict[str, Any] = {
        "attribute": values.astype(np.float32),
        "color_map": _stops(TENSION),
        "color_range": [low, high if high > low else low + 1.0],
        "point_size": 0.02 * MM * float(domain.size.max()),
    }
    return [k3d.points((MM * points).astype(np.float32), shader="mesh", name=name, **look)]


def _magnify(states: Sequence[State], size: float) -> float:
    """A round factor on displacements such that the largest is a few per cent of the specimen."""
    moved = [axis["high"] for state in states for axis in state["skin"]["moved"] or ()]
    return magnification(max(moved, default=0.0), size)


def _largest_stress(states: Sequence[State]) -> float:
    """Stress [MPa] that the dark end of the map stands for: some bodies are beyond it."""
    most = 0.0
    for state in states:
        found = state["skin"]["stress"]
        values = found["low"] + (found["high"] - found["low"]) / 65535.0 * found["codes"]
        most = max(most, float(np.quantile(values, 0.99)) if len(values) else 0.0)
    return most or 1.0


def _stops(colours: Colormap) -> list[float]:
    """A colour map as K3D takes it: place, red, green, blue, and so on."""
    at = np.linspace(0.0, 1.0, STOPS)
    return np.column_stack([at, np.asarray(colours(at))[:, :3]]).ravel().tolist()


def _two(low: str, high: str) -> list[float]:
    """A map of two colours."""
    a, b = to_rgb(low), to_rgb(high)
    return [0.0, *a, 0.499, *a, 0.501, *b, 1.0, *b]


def _number(colour: str) -> int:
    return int(colour.removeprefix("#"), 16)
