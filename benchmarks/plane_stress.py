"""Stiffness of the L-shaped panel by finite elements: squares in plane stress with incompatible modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

FloatArray = NDArray[np.float64]

#: Side of the panel, and of the quarter that is missing; thickness; strip of the load [m].
SIDE, LEG, THICK, PLATEN = 0.5, 0.25, 0.1, (0.46, 0.48)


def panel_stiffness(modulus: float, poisson: float, size: float = 0.0025) -> float:
    """Load over the mean displacement of the platen, the foot fixed [N/m]; `size` is that of the elements [m]."""
    n, half = round(SIDE / size), round(LEG / size)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    inside = ~((i >= half) & (j < half))
    i, j = i[inside], j[inside]
    corners = np.stack([i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1], axis=1)
    used, corners = np.unique(corners, return_inverse=True)
    corners = corners.reshape(-1, 4)
    unknowns = (2 * corners[:, :, None] + np.arange(2)).reshape(-1, 8)
    element = _square(modulus, poisson)
    rows, columns = np.repeat(unknowns, 8, axis=1).ravel(), np.tile(unknowns, (1, 8)).ravel()
    values = np.tile(element.ravel(), len(unknowns))
    stiffness = coo_array((values, (rows, columns)), shape=(2 * len(used), 2 * len(used))).tocsc()
    column, row = used // (n + 1), used % (n + 1)
    force = np.zeros(2 * len(used))
    first, last = (round(x / size) for x in PLATEN)
    on = np.flatnonzero((row == half) & (column >= first) & (column <= last))
    share = np.where((column[on] == first) | (column[on] == last), 0.5, 1.0)
    force[2 * on + 1] = share / share.sum()
    free = np.flatnonzero(np.repeat(~((row == 0) & (column <= half)), 2))
    moved = splu(stiffness[free][:, free]).solve(force[free])
    return 1.0 / float(force[free] @ moved)


def _square(modulus: float, poisson: float) -> FloatArray:
    """Stiffness of a square, (8, 8); that of plane stress does not depend on its size."""
    plane = np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - poisson)]])
    out, point = np.zeros((12, 12)), 1.0 / np.sqrt(3.0)
    for x in (-point, point):
        for y in (-point, point):
            slope_x = 0.5 * np.array([-(1 - y), 1 - y, 1 + y, -(1 + y)])
            slope_y = 0.5 * np.array([-(1 - x), -(1 + x), 1 + x, 1 - x])
            strain = np.zeros((3, 12))
            strain[0, 0:8:2] = strain[2, 1:8:2] = slope_x
            strain[1, 1:8:2] = strain[2, 0:8:2] = slope_y
            strain[0, 8] = strain[2, 9] = -4.0 * x
            strain[2, 10] = strain[1, 11] = -4.0 * y
            out += 0.25 * strain.T @ plane @ strain
    out *= THICK * modulus / (1.0 - poisson**2)
    inner = np.linalg.solve(out[8:, 8:], out[8:, :8])
    return np.asarray(out[:8, :8] - out[:8, 8:] @ inner, dtype=np.float64)
