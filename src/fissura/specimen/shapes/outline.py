"""Outlines in the plane of x and y, extruded along z."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from fissura.arrays import FloatArray
from fissura.case.shape import Corner
from fissura.specimen.shapes.arcs import flattened
from fissura.specimen.shapes.convex_parts import check_simple, convex_parts
from fissura.specimen.shapes.prism import prism_half_spaces
from fissura.specimen.solid import Solid


def extruded(
    corners: Sequence[Corner], thickness: float, names: Sequence[str] | None, l_f: float, key: str = "specimen.outline"
) -> Solid:
    """An outline extruded from z = 0.

    Parameters
    ----------
    corners : sequence of Corner
        The outline.
    thickness : float
        Dimension along z [m].
    names : sequence of str or None
        Surface of each side, that from the first corner to the second first. Without names, sides at the ends of the
        outline are called ``left``, ``right``, ``bottom`` and ``top``, others ``side 3`` and so on.
    l_f : float
        Spacing of fine nuclei [m].
    key : str, optional
        Where the outline stands in the case file.

    Returns
    -------
    Solid
        Its ends are called ``front`` (z = 0) and ``back``.

    Raises
    ------
    InputError
        An outline that crosses itself, arcs that do not meet.
    """
    points, side = flattened(corners, l_f, key)
    check_simple(points, key)
    given = _default_names(corners) if names is None else list(names)
    low, high = points.min(axis=0), points.max(axis=0)
    solid = Solid([*low, 0.0], [*high, thickness])
    solid.surfaces += [name for name in dict.fromkeys([*given, "front", "back"]) if name not in solid.surfaces]
    rim = {(k, (k + 1) % len(points)): given[side[k]] for k in range(len(points))}
    for part in convex_parts(points):
        edges = list(zip(part, part[1:] + part[:1], strict=True))
        half_spaces = prism_half_spaces(points[part], 0.0, thickness)
        solid.add(half_spaces, [*(rim.get(edge) for edge in edges), "front", "back"])
    _name_parts(solid, points, rim, thickness)
    return solid


def _default_names(corners: Sequence[Corner]) -> list[str]:
    ends = np.array([corner.to for corner in corners])
    low, high = ends.min(axis=0), ends.max(axis=0)
    near = 1e-9 * float((high - low).max())
    out = []
    for k in range(len(corners)):
        a, b = ends[k], ends[(k + 1) % len(corners)]
        found = f"side {k + 1}"
        if corners[(k + 1) % len(corners)].radius is None:
            for axis, pair in enumerate((("left", "right"), ("bottom", "top"))):
                for bound, name in zip((low, high), pair, strict=True):
                    if max(abs(a[axis] - bound[axis]), abs(b[axis] - bound[axis])) <= near:
                        found = name
        out.append(found)
    return out


def _name_parts(solid: Solid, points: FloatArray, rim: dict[tuple[int, int], str], thickness: float) -> None:
    """Where sides of different names lie in one plane, each names its own part of it."""
    sides = defaultdict(list)
    for (k, m), name in rim.items():
        a, b = points[k], points[m]
        normal = np.array([b[1] - a[1], a[0] - b[0], 0.0])
        face = solid.planes.find(normal, float(0.5 * normal[:2] @ (a + b)))
        polygon = np.array([[*a, 0.0], [*b, 0.0], [*b, thickness], [*a, thickness]])
        sides[face].append((polygon, name))
    for face, parts in sides.items():
        if len({name for _, name in parts}) > 1:
            solid.regions[face] = parts
