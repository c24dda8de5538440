"""Specimens and nuclei for the tests of tessellations."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import permutations
from typing import Any

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from fissura.adaptivity import RefinedRegion
from fissura.case.shape import Corner
from fissura.specimen import Domain, Solid
from fissura.specimen.assemble import complex_of
from fissura.specimen.cutting import cut_notches
from fissura.specimen.notches import Slot
from fissura.specimen.shapes.outline import extruded
from fissura.specimen.shapes.prism import FACES, box, box_half_spaces, cylinder, prism_half_spaces
from fissura.specimen.tetrahedra import solid_of_tetrahedra
from fissura.tessellation import Nuclei, Tessellation, discretize

SIZE = (0.12, 0.06, 0.04)
L_F = 0.008
L_C = 4 * L_F

#: Notches by a name for the test's report; the values are those of a case file.
NOTCHES: dict[str, tuple[dict[str, Any], ...]] = {
    "none": (),
    "cut": ({"position": 0.06, "depth": 0.03},),
    "saw": ({"position": 0.06, "depth": 0.03, "width": 0.004},),
    "wide": ({"position": 0.06, "depth": 0.03, "width": 0.02},),
    "asymmetric": ({"position": 0.047, "depth": 0.011},),
    "deep": ({"position": 0.06, "depth": 0.0595},),
    "shallow saw": ({"position": 0.06, "depth": 0.0005, "width": 0.004},),
    "left": ({"face": "left", "normal": "y", "position": 0.03, "depth": 0.015},),
    "left saw": ({"face": "left", "normal": "y", "position": 0.03, "depth": 0.015, "width": 0.004},),
    "right along z": ({"face": "right", "normal": "z", "position": 0.02, "depth": 0.05, "width": 0.002},),
    "top": ({"face": "top", "position": 0.06, "depth": 0.02},),
    "top saw": ({"face": "top", "position": 0.06, "depth": 0.02, "width": 0.004},),
    "front": ({"face": "front", "position": 0.06, "depth": 0.015},),
    "back saw along y": ({"face": "back", "normal": "y", "position": 0.03, "depth": 0.015, "width": 0.003},),
    "double edge": (
        {"position": 0.06, "depth": 0.01, "width": 0.003},
        {"face": "top", "position": 0.06, "depth": 0.01},
    ),
    "near the end": ({"position": 0.003, "depth": 0.03},),
    "close together": ({"position": 0.055, "depth": 0.03}, {"position": 0.065, "depth": 0.02}),
}


def expected_count(size, spacing: float) -> float:
    """Number of nuclei in a saturated box with free walls, as measured."""
    return float(0.734 * np.prod(np.asarray(size) / spacing + 0.6))


def slot_of(size: tuple[float, float, float], position: float, depth: float, **part: Any) -> Slot:
    """A notch straight across a face of a box, as cases give it."""
    axis, side = divmod(FACES.index(part.get("face", "bottom")), 2)
    normal = "xyz".index(part.get("normal", "x"))
    at = 0.5 * np.asarray(size)
    at[axis], at[normal] = side * size[axis], position
    inward = np.eye(3)[axis] * (1.0 - 2.0 * side)
    return Slot(at, inward, np.eye(3)[3 - axis - normal], depth, part.get("width", 0.0))


def notched(solid: Solid, *slots: Slot) -> Domain:
    notches = cut_notches(solid, slots) if slots else ()
    return Domain(*complex_of(solid), notches=notches)


def box_with(*notches: dict[str, Any], size: tuple[float, float, float] = SIZE) -> Domain:
    return notched(box(size), *(slot_of(size, **part) for part in notches))


def _slot(at: Any, direction: Any, along: Any, depth: float, width: float = 0.0) -> Slot:
    return Slot(np.asarray(at, float), np.asarray(direction, float), np.asarray(along, float), depth, width)


def _outline(points: Any, thickness: float) -> Solid:
    return extruded(
        [Corner.model_validate(p if isinstance(p, dict) else {"to": p}) for p in points], thickness, None, L_F
    )


def _l_panel() -> Domain:
    points = [[0, 0], [0.05, 0], [0.05, 0.05], [0.1, 0.05], [0.1, 0.1], [0, 0.1]]
    return notched(_outline(points, 0.02))


def _dog_bone() -> Domain:
    c = 0.02 * np.sin(np.pi / 3)
    points = [
        *([-0.025, 0], [0.025, 0], [0.025, 0.03], {"to": [0.015, 0.03 + c], "radius": -0.02}, [0.015, 0.07 - c]),
        *({"to": [0.025, 0.07], "radius": -0.02}, [0.025, 0.1], [-0.025, 0.1], [-0.025, 0.07]),
        *({"to": [-0.015, 0.07 - c], "radius": -0.02}, [-0.015, 0.03 + c], {"to": [-0.025, 0.03], "radius": -0.02}),
    ]
    return notched(_outline(points, 0.04))


def _ring(radius: float, count: int, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)], axis=1)


def _disc_with_hole() -> Domain:
    solid = cylinder(0.1, 0.02, 2, L_F)
    half_spaces = prism_half_spaces(_ring(0.015, 16), -1.0, 1.0)
    solid.minus(half_spaces, ["hole"] * len(half_spaces))
    return notched(solid)


def _anchor() -> Domain:
    """A block with a blind hole from its top."""
    solid = box((0.08, 0.06, 0.08))
    half_spaces = prism_half_spaces(_ring(0.012, 12, (0.04, 0.04)), 0.03, 1.0, axis=1)
    solid.minus(half_spaces, ["hole"] * len(half_spaces))
    return notched(solid)


def _wedge() -> Domain:
    """A groove with a starter notch at its bottom."""
    solid = box((0.08, 0.08, 0.04))
    solid.minus(box_half_spaces((0.03, 0.06, -1.0), (0.05, 1.0, 1.0)), ["groove"] * 6)
    return notched(solid, _slot((0.04, 0.06, 0.02), (0, -1, 0), (0, 0, 1), 0.02))


def _crossing() -> Domain:
    """Two cuts from neighbouring faces of a prism."""
    return box_with({"position": 0.06, "depth": 0.03}, {"face": "front", "position": 0.06, "depth": 0.015})


def _torsion() -> Domain:
    return notched(box((0.12, 0.04, 0.04)), _slot((0.06, 0.04, 0.02), (0, -1, 0), (1, 0, -1), 0.02, 0.003))


def _inclined() -> Domain:
    return notched(box(SIZE), _slot((0.05, 0.0, 0.02), (0.5, 1.0, 0.0), (0, 0.2, 1), 0.03))


def _blocks() -> Domain:
    """A block of equal tetrahedra, six to a cube, with coplanar faces everywhere."""
    n = 3
    points = np.stack(np.meshgrid(*[np.arange(n + 1) / n] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for corner in np.ndindex(n, n, n):
        for order in permutations(range(3)):
            steps = np.cumsum([np.zeros(3, int), *(np.eye(3, dtype=int)[a] for a in order)], axis=0) + corner
            tets.append(steps @ [(n + 1) ** 2, n + 1, 1])
    return Domain(*complex_of(solid_of_tetrahedra(points * SIZE, np.array(tets))))


def _ball() -> Domain:
    """A ball of irregular tetrahedra, some of them nearly flat."""
    rng = np.random.default_rng(4)
    skin = rng.normal(size=(80, 3))
    points = np.concatenate([skin / np.linalg.norm(skin, axis=1)[:, None], 0.4 * rng.normal(size=(40, 3))]) * 0.04
    points = points[np.linalg.norm(points, axis=1) <= 0.04 * (1.0 + 1e-12)]
    return Domain(*complex_of(solid_of_tetrahedra(points, Delaunay(points).simplices)))


#: Specimens of all kinds.
SHAPES: dict[str, Callable[[], Domain]] = {
    **{name: (lambda parts=parts: box_with(*parts)) for name, parts in NOTCHES.items()},
    "inclined": _inclined,
    "crossing": _crossing,
    "torsion": _torsion,
    "L-panel": _l_panel,
    "dog-bone": _dog_bone,
    "cylinder": lambda: notched(cylinder(0.06, 0.08, 1, L_F)),
    "disc with hole": _disc_with_hole,
    "anchor": _anchor,
    "wedge": _wedge,
    "blocks": _blocks,
    "ball": _ball,
}


@cache
def shape(name: str) -> Domain:
    return SHAPES[name]()


def nuclei_in(domain: Domain, seed: int, l_f: float = L_F, given: Any = None) -> Nuclei:
    return Nuclei.placed(domain.complex, l_f, np.random.default_rng(seed), given)


def farthest(nuclei, domain: Domain) -> float:
    """Largest distance of a corner of a body, or of a random point, from its nearest nucleus, in spacings."""
    t = discretize(nuclei, domain, np.zeros(len(nuclei)))
    low, high = domain.bounds
    points = low + (high - low) * np.random.default_rng(0).random((20_000, 3))
    places = [t.contacts.polygons.points, t.surface.polygons.points, points[domain.contains(points)]]
    return float(cKDTree(nuclei.x).query(np.concatenate(places))[0].max()) / nuclei.spacing


def region(domain: Domain, centers: Any = (), *, everywhere: bool = False, r_f: float = 2 * L_F) -> RefinedRegion:
    """Fine at the tips of all notches and around centres."""
    lines = [notch.tip_lines() for notch in domain.notches]
    return RefinedRegion(
        L_F,
        L_C,
        r_f,
        2 * L_C,
        centers=np.asarray(centers, float).reshape(-1, 3),
        lines=np.concatenate([np.empty((0, 2, 3)), *lines]),
        everywhere=everywhere,
    )


def discretized(nuclei: Nuclei, domain: Domain, where: RefinedRegion) -> Tessellation:
    return discretize(nuclei, domain, where.spacing(nuclei.x))
