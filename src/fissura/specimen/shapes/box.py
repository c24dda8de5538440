"""A rectangular block, one corner at the origin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fissura.specimen.shapes.prism import FACES, box_half_spaces
from fissura.specimen.solid import Solid

__all__ = ["box"]


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
