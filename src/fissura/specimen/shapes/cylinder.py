"""Cylinders: one convex cell of many sides."""

from __future__ import annotations

import numpy as np

from fissura.specimen.shapes.arcs import circle
from fissura.specimen.shapes.prism import prism_half_spaces
from fissura.specimen.solid import Solid

__all__ = ["cylinder"]


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
