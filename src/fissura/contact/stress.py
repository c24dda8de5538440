"""Average stress in bodies (theory section 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.tessellation import Tessellation

__all__ = ["body_stress"]

FloatArray = NDArray[np.float64]


def body_stress(
    tessellation: Tessellation,
    frame: FloatArray,
    traction: FloatArray,
    point_body: NDArray[np.int64] | None = None,
    point: FloatArray | None = None,
    point_force: FloatArray | None = None,
) -> FloatArray:
    """Stress ``sigma_i = (1/V_i) sym sum_j A_ij t_ij (x) (c_ij - x_i)``.

    Parameters
    ----------
    tessellation : Tessellation
        Bodies and contacts.
    frame : (m, 3, 3) array
        Unit vectors n, m, l of contacts as rows.
    traction : (m, 3) array
        ``s_N, s_M, s_L`` [Pa].
    point_body, point, point_force : (k,), (k, 3), (k, 3) array, optional
        Bodies, places [m] and values [N] of external forces.

    Returns
    -------
    (n, 3, 3) array
        Symmetric stress tensors [Pa], tension positive.
    """
    contacts = tessellation.contacts
    force = contacts.area[:, None] * np.einsum("ca,cai->ci", traction, frame)
    n = len(tessellation)
    total = np.zeros((n, 9))
    parts = [
        (contacts.bodies[:, 0], contacts.centroid, force),
        (contacts.bodies[:, 1], contacts.centroid, -force),
    ]
    if point_body is not None and point is not None and point_force is not None:
        parts.append((point_body, point, point_force))
    for body, place, f in parts:
        moment = (f[:, :, None] * (place - tessellation.x[body])[:, None, :]).reshape(-1, 9)
        for k in range(9):
            total[:, k] += np.bincount(body, moment[:, k], n)
    sigma = total.reshape(n, 3, 3) / tessellation.volume[:, None, None]
    stress: FloatArray = 0.5 * (sigma + sigma.transpose(0, 2, 1))
    return stress
