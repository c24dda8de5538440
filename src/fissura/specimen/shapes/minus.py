"""Boxes, round holes and prisms taken away from a specimen."""

from typing import TypeAlias

import numpy as np

from fissura.arrays import FloatArray
from fissura.case.shape import Bore, Prism, Void
from fissura.errors import InputError
from fissura.specimen.planes import unit
from fissura.specimen.shapes.arcs import circle, flattened
from fissura.specimen.shapes.convex_parts import check_simple, convex_parts
from fissura.specimen.shapes.prism import AXES, box_half_spaces, prism_half_spaces
from fissura.specimen.solid import Solid

#: Half-spaces of a convex void, and for each the surface that it leaves.
_Convex: TypeAlias = tuple[list[tuple[FloatArray, float]], list[str | None]]


def subtract(solid: Solid, void: Void, l_f: float, key: str) -> None:
    """Take a void away.

    Parameters
    ----------
    solid : Solid
        What it is taken from.
    void : Void part of the case
        What is taken.
    l_f : float
        Spacing of fine nuclei [m].
    key : str
        Where it stands in the case file.

    Raises
    ------
    InputError
        It takes nothing or everything, or its outline is wrong.
    """
    if void.name not in solid.surfaces:
        solid.surfaces.append(void.name)
    if void.box is not None:
        half_spaces = box_half_spaces(void.box.lower, void.box.upper)
        parts: list[_Convex] = [(half_spaces, [void.name] * len(half_spaces))]
    elif void.cylinder is not None:
        half_spaces = _bore(void.cylinder, l_f)
        parts = [(half_spaces, [void.name] * len(half_spaces))]
    else:
        assert void.outline is not None
        parts = _prism(void.outline, void.name, l_f, f"{key}.outline")
    touched = [solid.minus(*part) for part in parts]
    if not any(touched):
        raise InputError(key, "the void does not meet the specimen", "a void that takes something away")
    if not solid.cells:
        raise InputError(key, "the void takes the whole specimen away", "a void that leaves something")


def _bore(part: Bore, l_f: float) -> list[tuple[FloatArray, float]]:
    """A round hole, without ends where it goes through everything."""
    polygon = circle(part.diameter, l_f)
    if part.through is not None:
        assert part.axis is not None
        axis = AXES[part.axis]
        u, v = (axis + 1) % 3, (axis + 2) % 3
        return prism_half_spaces(polygon + np.array([part.through[u], part.through[v]]), 0.0, 0.0, axis)[:-2]
    assert part.start is not None
    assert part.end is not None
    start, end = np.asarray(part.start, float), np.asarray(part.end, float)
    along = unit(end - start)
    across = np.eye(3)[int(np.argmin(np.abs(along)))]
    first = unit(np.cross(across, along))
    frame = np.array([first, np.cross(along, first)])
    out = []
    for normal, offset in prism_half_spaces(polygon, 0.0, 0.0)[:-2]:
        turned = normal[:2] @ frame
        out.append((turned, offset + float(turned @ start)))
    return [*out, (-along, -float(along @ start)), (along, float(along @ end))]


def _prism(part: Prism, name: str, l_f: float, key: str) -> list[_Convex]:
    """A prism as convex ones, which are open to each other."""
    points, _ = flattened(part.corners, l_f, key)
    check_simple(points, key)
    axis = AXES[part.axis]
    if axis == 1:
        points = points[::-1, ::-1]  # x and z are given, z and x are right-handed with y
    ends = [value for value in (part.lower, part.upper) if value is not None]
    out: list[_Convex] = []
    for loop in convex_parts(points):
        half_spaces = prism_half_spaces(points[loop], part.lower or 0.0, part.upper or 0.0, axis)
        names: list[str | None] = [
            name if (b - a) % len(points) == 1 else None for a, b in zip(loop, loop[1:] + loop[:1], strict=True)
        ]
        if len(ends) < 2:
            kept = [half_spaces[-2 + k] for k, value in enumerate((part.lower, part.upper)) if value is not None]
            half_spaces = [*half_spaces[:-2], *kept]
        out.append((half_spaces, [*names, *[name] * len(ends)]))
    return out
