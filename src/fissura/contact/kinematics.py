"""Strains of contacts and forces on bodies (theory section 1)."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.tessellation import Contacts, Tessellation


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


@njit(**INNER)
def _cross(a, b, out):  # type: ignore[no-untyped-def]
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@njit()
def _frames(normal, out):  # type: ignore[no-untyped-def]
    axis = np.zeros(3)
    for c in range(len(normal)):
        n = normal[c]
        # The axis least aligned with n never gives a vanishing cross product.
        least = 0
        for a in range(1, 3):
            if abs(n[a]) < abs(n[least]):
                least = a
        frame = out[c]
        for a in range(3):
            axis[a] = 1.0 if a == least else 0.0
            frame[0, a] = n[a]
        _cross(n, axis, frame[1])
        length = np.sqrt(frame[1, 0] ** 2 + frame[1, 1] ** 2 + frame[1, 2] ** 2)
        for a in range(3):
            frame[1, a] /= length
        _cross(n, frame[1], frame[2])


@njit()
def _strain_rows(frame, centroid, x_i, x_j, length, out):  # type: ignore[no-untyped-def]
    for c in range(len(frame)):
        i0, i1, i2 = centroid[c, 0] - x_i[c, 0], centroid[c, 1] - x_i[c, 1], centroid[c, 2] - x_i[c, 2]
        j0, j1, j2 = centroid[c, 0] - x_j[c, 0], centroid[c, 1] - x_j[c, 1], centroid[c, 2] - x_j[c, 2]
        for a in range(3):
            a0, a1, a2 = frame[c, a, 0] / length[c], frame[c, a, 1] / length[c], frame[c, a, 2] / length[c]
            out[c, a, 0], out[c, a, 1], out[c, a, 2] = -a0, -a1, -a2
            # a . (theta x r) = theta . (r x a)
            out[c, a, 3], out[c, a, 4], out[c, a, 5] = i2 * a1 - i1 * a2, i0 * a2 - i2 * a0, i1 * a0 - i0 * a1
            out[c, a, 6], out[c, a, 7], out[c, a, 8] = a0, a1, a2
            out[c, a, 9], out[c, a, 10], out[c, a, 11] = j1 * a2 - j2 * a1, j2 * a0 - j0 * a2, j0 * a1 - j1 * a0


@njit()
def _contacts_of(bodies, first, adjacent):  # type: ignore[no-untyped-def]
    """Contacts of each body: counted, then put in place; `first` begins as zeros."""
    n = len(first) - 1
    for c in range(len(bodies)):
        for side in range(2):
            first[bodies[c, side] + 1] += 1
    for b in range(n):
        first[b + 1] += first[b]
    free = first[:n].copy()
    for c in range(len(bodies)):
        for side in range(2):
            b = bodies[c, side]
            adjacent[free[b]] = 2 * c + side
            free[b] += 1


def kinematics(tessellation: Tessellation) -> Kinematics:
    """Geometry of all contacts in the form that the kernels use."""
    x, contacts = tessellation.x, tessellation.contacts
    return kinematics_of(contacts, x[contacts.bodies[:, 0]], x[contacts.bodies[:, 1]], len(x))


def kinematics_of(contacts: Contacts, x_i: FloatArray, x_j: FloatArray, n: int) -> Kinematics:
    """Geometry of contacts whose bodies need not be where their numbers say, as images in periodic structures.

    Parameters
    ----------
    contacts : Contacts
        The contacts.
    x_i, x_j : (m, 3) array
        Nuclei of the two bodies of each [m].
    n : int
        Number of bodies.
    """
    bodies = contacts.bodies
    frame, rows = np.empty((len(contacts), 3, 3)), np.empty((len(contacts), 3, 12))
    _frames(contacts.normal, frame)
    _strain_rows(frame, contacts.centroid, x_i, x_j, contacts.length, rows)
    first, adjacent = np.zeros(n + 1, dtype=np.int64), np.empty(bodies.size, dtype=np.int64)
    _contacts_of(bodies, first, adjacent)
    return Kinematics(bodies, rows, frame, contacts.area * contacts.length, first, adjacent)


@njit()
def _strains(bodies, rows, u, out):  # type: ignore[no-untyped-def]
    for c in range(len(rows)):
        i, j = bodies[c, 0], bodies[c, 1]
        for a in range(3):
            e = 0.0
            for d in range(6):
                e += rows[c, a, d] * u[i, d] + rows[c, a, d + 6] * u[j, d]
            out[c, a] = e


@njit(fastmath={"contract"})
def _forces(bodies, rows, volume, traction, out):  # type: ignore[no-untyped-def]
    for c in range(len(rows)):
        t0, t1, t2 = volume[c] * traction[c, 0], volume[c] * traction[c, 1], volume[c] * traction[c, 2]
        i, j = bodies[c, 0], bodies[c, 1]
        for d in range(6):
            out[i, d] += rows[c, 0, d] * t0 + rows[c, 1, d] * t1 + rows[c, 2, d] * t2
            out[j, d] += rows[c, 0, d + 6] * t0 + rows[c, 1, d + 6] * t1 + rows[c, 2, d + 6] * t2


@njit(fastmath={"contract"})
def _add_stiffness(bodies, rows, volume, chosen, stiffness, u, out):  # type: ignore[no-untyped-def]
    e, t = np.empty(3), np.empty(3)
    for k in range(len(chosen)):
        c = chosen[k]
        i, j = bodies[c, 0], bodies[c, 1]
        for a in range(3):
            e[a] = 0.0
            for d in range(6):
                e[a] += rows[c, a, d] * u[i, d] + rows[c, a, d + 6] * u[j, d]
        for a in range(3):
            t[a] = volume[c] * (stiffness[k, a, 0] * e[0] + stiffness[k, a, 1] * e[1] + stiffness[k, a, 2] * e[2])
        for d in range(6):
            out[i, d] += rows[c, 0, d] * t[0] + rows[c, 1, d] * t[1] + rows[c, 2, d] * t[2]
            out[j, d] += rows[c, 0, d + 6] * t[0] + rows[c, 1, d + 6] * t[1] + rows[c, 2, d + 6] * t[2]


def contact_strains(geometry: Kinematics, u: FloatArray) -> FloatArray:
    """Contact strains ``e_N, e_M, e_L`` for displacements and rotations u; (n, 6) -> (m, 3)."""
    out = np.empty((len(geometry), 3))
    _strains(geometry.bodies, geometry.rows, u, out)
    return out


def nodal_forces(geometry: Kinematics, traction: FloatArray) -> FloatArray:
    """Forces and moments of contacts at the nuclei, work-conjugate to u; tractions (m, 3) [Pa] -> (n, 6) [N, N m]."""
    out = np.zeros((len(geometry.first) - 1, 6))
    _forces(geometry.bodies, geometry.rows, geometry.volume, traction, out)
    return out


def add_stiffness(
    geometry: Kinematics, chosen: IntArray, stiffness: FloatArray, u: FloatArray, forces: FloatArray
) -> None:
    """Add the forces of some contacts with the given stiffness to `forces`, in place.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    chosen : (k,) array
        Which of them act.
    stiffness : (k, 3, 3) array
        ``ds/de`` of each [Pa].
    u : (n, 6) array
        Displacements and rotations.
    forces : (n, 6) array
        Forces and moments at the nuclei.
    """
    _add_stiffness(geometry.bodies, geometry.rows, geometry.volume, chosen, stiffness, u, forces)
