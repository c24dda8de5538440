"""Attaching supports, loads and gauges to the bodies that own their points (theory section 6)."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from fissura.arrays import FloatArray, IntArray
from fissura.specimen import Functional
from fissura.tessellation import Bodies, Tessellation, owners


def owners_of(functionals: Sequence[Functional], bodies: Bodies) -> IntArray:
    """Bodies that own the points of several functionals, one after the other; platens come after all bodies."""
    points = np.concatenate([f.points for f in functionals])
    found = owners(bodies, points, np.concatenate([f.cells for f in functionals]))
    on = [np.full(len(f.points), -1 if f.platen is None else len(bodies) + f.platen) for f in functionals]
    platen = np.concatenate(on)
    return np.where(platen < 0, found, platen)


def attach(functional: Functional, tessellation: Tessellation) -> FloatArray:
    """Coefficients of a functional on the bodies' unknowns.

    A point moves by ``u + theta x r``, so that ``a . u(x) = a . u + (r x a) . theta`` (theory section 1).

    Returns
    -------
    (n, 6) array
        As a load: forces [N] and moments [N m] at the nuclei.
    """
    row = attach_rows([functional], tessellation, owners_of([functional], tessellation))
    return np.asarray(row.toarray().reshape(-1, 6), dtype=np.float64)


def attach_rows(functionals: Sequence[Functional], bodies: Bodies, body: IntArray) -> csr_array:
    """Coefficients of several functionals, given the owners of all of their points one after the other.

    Returns
    -------
    (k, 6 n) sparse array
        See :func:`attach`.
    """
    points = np.concatenate([f.points for f in functionals])
    force = np.concatenate([f.coefficients for f in functionals])
    moment = np.cross(points - bodies.x[body], force)
    row = np.repeat(np.arange(len(functionals)), [6 * len(f.points) for f in functionals])
    column = (6 * body[:, None] + np.arange(6)).ravel()
    values = np.concatenate([force, moment], axis=1).ravel()
    out = csr_array((values, (row, column)), shape=(len(functionals), 6 * len(bodies)))
    out.eliminate_zeros()
    return out
