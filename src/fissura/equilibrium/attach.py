"""Attaching supports, loads and gauges to the bodies that own their points (theory section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.specimen import Functional
from fissura.tessellation import Tessellation

__all__ = ["attach", "owners"]

FloatArray = NDArray[np.float64]


def owners(tessellation: Tessellation, points: FloatArray) -> NDArray[np.int64]:
    """Body that owns each point: the one with the nearest nucleus; (k, 3) -> (k,)."""
    _, body = cKDTree(tessellation.x).query(points)
    return np.asarray(body, dtype=np.int64)


def attach(functional: Functional, tessellation: Tessellation) -> FloatArray:
    """Coefficients of a functional on the bodies' unknowns.

    A point moves by ``u + theta x r``, so that ``a . u(x) = a . u + (r x a) . theta`` (theory section 1).

    Returns
    -------
    (n, 6) array
        As a load: forces [N] and moments [N m] at the nuclei.
    """
    body = owners(tessellation, functional.points)
    arm = functional.points - tessellation.x[body]
    out = np.zeros((len(tessellation), 6))
    np.add.at(out[:, :3], body, functional.coefficients)
    np.add.at(out[:, 3:], body, np.cross(arm, functional.coefficients))
    return out
