"""Boxes, convex prisms and cylinders: their half-spaces, and solids of one of them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from fissura.arrays import FloatArray
from fissura.specimen.shapes.arcs import circle
from fissura.specimen.solid import Solid

#: Axes by name.
AXES = {"x": 0, "y": 1, "z": 2}

#: Names of the faces of a box, in the order of `box_half_spaces`.
FACES = ("left", "right", "bottom", "top", "front", "back")

#: For each axis the two others, in an order that makes them right-handed with it.
_ACROSS = {0: (1, 2), 1: (2, 0), 2: (0, 1)}


def box_half_spaces(low: ArrayLike, high: ArrayLike) -> list[tuple[FloatArray, float]]:
    """Half-spaces of a box, lower and upper side of each axis in turn.

    Parameters
    ----------
    low, high : (3,) array
        Its corners [m].
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    out = []
    for axis, normal in enumerate(np.eye(3)):
        out += [(-normal, -float(low[axis])), (normal, float(high[axis]))]
    return out


def prism_half_spaces(polygon: ArrayLike, low: float, high: float, axis: int = 2) -> list[tuple[FloatArray, float]]:
    """Half-spaces of a prism: its sides in the order of the polygon's edges, then its lower and upper end.

    Parameters
    ----------
    polygon : (k, 2) array
        Convex, counterclockwise seen from the end of the axis; coordinates along x and y for a prism along z, along y
        and z for one along x, along z and x for one along y [m].
    low, high : float
        Coordinates of its ends along the axis [m].
    axis : int
        Number of the axis.
    """
    corners = np.asarray(polygon, float)
    u, v = _ACROSS[axis]
    out = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = b - a
        normal = np.zeros(3)
        normal[u], normal[v] = along[1], -along[0]
        normal /= np.linalg.norm(normal)
        out.append((normal, float(0.5 * (normal[u] * (a[0] + b[0]) + normal[v] * (a[1] + b[1])))))
    end = np.eye(3)[axis]
    return [*out, (-end, -low), (end, high)]


def box(size: Sequence[float]) -> Solid:
    """A box that occupies ``[0, size]``.

    Parameters
    ----------
    size : three floats
        Length along x, depth along y, thickness along z [m].
    """
    solid = Solid(np.zeros(3), size)
    solid.add(box_half_spaces(np.zeros(3), size), FACES)
    return solid


def cylinder(diameter: float, length: float, axis: int, l_f: float) -> Solid:
    """A cylinder around an axis, from the origin.

    Parameters
    ----------
    diameter, length : float
        Dimensions [m].
    axis : int
        Number of its axis.
    l_f : float
        Spacing of fine nuclei, which decides how many sides stand for its round surface [m].

    Returns
    -------
    Solid
        Its surfaces are called ``lateral``, ``bottom`` (at the origin) and ``top``.
    """
    polygon = circle(diameter, l_f)
    high = np.full(3, float(np.abs(polygon).max()))
    low = -high
    low[axis], high[axis] = 0.0, length
    solid = Solid(low, high)
    solid.surfaces += ["lateral", "bottom", "top"]
    solid.add(prism_half_spaces(polygon, 0.0, length, axis), [*["lateral"] * len(polygon), "bottom", "top"])
    return solid
