"""Average stress in bodies (theory section 4)."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.tessellation import Tessellation


@njit()
def _contact_moments(bodies, area, centroid, x, frame, traction, out):  # type: ignore[no-untyped-def]
    """``sum A t (x) (c - x)`` of every body."""
    for c in range(len(bodies)):
        i, j = bodies[c, 0], bodies[c, 1]
        for a in range(3):
            t = traction[c, 0] * frame[c, 0, a] + traction[c, 1] * frame[c, 1, a] + traction[c, 2] * frame[c, 2, a]
            force = area[c] * t
            for b in range(3):
                out[i, a, b] += force * (centroid[c, b] - x[i, b])
                out[j, a, b] -= force * (centroid[c, b] - x[j, b])


def body_stress(
    tessellation: Tessellation,
    frame: FloatArray,
    traction: FloatArray,
    point_body: IntArray | None = None,
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
    contacts, x = tessellation.contacts, tessellation.x
    total = np.zeros((len(tessellation), 3, 3))
    _contact_moments(contacts.bodies, contacts.area, contacts.centroid, x, frame, traction, total)
    if point_body is not None and point is not None and point_force is not None:
        np.add.at(total, point_body, point_force[:, :, None] * (point - x[point_body])[:, None, :])
    sigma = total / tessellation.volume[:, None, None]
    stress: FloatArray = 0.5 * (sigma + sigma.transpose(0, 2, 1))
    return stress
