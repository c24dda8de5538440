"""Strains of contacts and forces on bodies (theory section 1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fissura.tessellation import Contacts, Tessellation

__all__ = ["Kinematics", "contact_strains", "kinematics", "nodal_forces", "tangent_directions"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Kinematics:
    """What strains and forces of contacts need of the geometry.

    Attributes
    ----------
    bodies : (m, 2) array
        Bodies ``i, j`` of each contact.
    rows : (m, 3, 12) array
        ``B / L``: strains ``e_N, e_M, e_L`` are ``rows @ [q_i, q_j]``.
    frame : (m, 3, 3) array
        Unit vectors n, m, l as rows.
    volume : (m,) array
        ``A L`` [m^3], so that virtual work is ``sum A L s . e``.
    first, adjacent : (n + 1,), (2 m,) array
        Contacts of body ``b`` are ``adjacent[first[b]:first[b + 1]]``: ``2 c`` where it is the ``i`` of contact ``c``,
        ``2 c + 1`` where it is the ``j``.
    """

    bodies: IntArray
    rows: FloatArray
    frame: FloatArray
    volume: FloatArray
    first: IntArray
    adjacent: IntArray

    def __len__(self) -> int:
        return len(self.volume)


def tangent_directions(normal: FloatArray) -> FloatArray:
    """Two unit vectors m, l that complete each normal to a right-handed frame; (m, 3) -> (m, 2, 3)."""
    # The axis least aligned with n never gives a vanishing cross product.
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    m = np.cross(normal, axis)
    m /= np.linalg.norm(m, axis=1, keepdims=True)
    return np.stack([m, np.cross(normal, m)], axis=1)


def kinematics(tessellation: Tessellation) -> Kinematics:
    """Geometry of all contacts in the form that the kernels use."""
    contacts: Contacts = tessellation.contacts
    x, bodies, n = tessellation.x, contacts.bodies, len(tessellation)
    frame = np.concatenate([contacts.normal[:, None, :], tangent_directions(contacts.normal)], axis=1)
    rows = np.empty((len(contacts), 3, 12))
    for side, sign in ((0, -1.0), (1, 1.0)):
        arm = contacts.centroid - x[bodies[:, side]]
        rows[:, :, 6 * side : 6 * side + 3] = sign * frame
        # a . (theta x r) = theta . (r x a)
        rows[:, :, 6 * side + 3 : 6 * side + 6] = sign * np.cross(arm[:, None, :], frame)
    rows /= contacts.length[:, None, None]
    owner = bodies.ravel()
    adjacent = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[adjacent], np.arange(n + 1))
    return Kinematics(bodies, rows, frame, contacts.area * contacts.length, first, adjacent)


@njit(cache=True)
def _strains(bodies, rows, u, out):  # type: ignore[no-untyped-def]
    for c in range(len(rows)):
        i, j = bodies[c, 0], bodies[c, 1]
        for a in range(3):
            e = 0.0
            for d in range(6):
                e += rows[c, a, d] * u[i, d] + rows[c, a, d + 6] * u[j, d]
            out[c, a] = e


@njit(cache=True)
def _forces(rows, volume, first, adjacent, traction, out):  # type: ignore[no-untyped-def]
    for b in range(len(first) - 1):
        for k in range(first[b], first[b + 1]):
            c, shift = adjacent[k] // 2, 6 * (adjacent[k] % 2)
            for d in range(6):
                f = 0.0
                for a in range(3):
                    f += rows[c, a, shift + d] * traction[c, a]
                out[b, d] += volume[c] * f


def contact_strains(geometry: Kinematics, u: FloatArray) -> FloatArray:
    """Contact strains ``e_N, e_M, e_L`` for displacements and rotations u; (n, 6) -> (m, 3)."""
    out = np.empty((len(geometry), 3))
    _strains(geometry.bodies, geometry.rows, u, out)
    return out


def nodal_forces(geometry: Kinematics, traction: FloatArray) -> FloatArray:
    """Forces and moments of contacts at the nuclei, work-conjugate to u; tractions (m, 3) [Pa] -> (n, 6) [N, N m]."""
    out = np.zeros((len(geometry.first) - 1, 6))
    _forces(geometry.rows, geometry.volume, geometry.first, geometry.adjacent, traction, out)
    return out
