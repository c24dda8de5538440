"""Stiffness of supports, and traces of stiffness that hold what contacts leave loose."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array, diags_array

from fissura.arrays import FloatArray, IntArray
from fissura.equilibrium import limits
from fissura.equilibrium.platens import WithPlatens
from fissura.linear.low_rank import LowRank
from fissura.tessellation import Tessellation


@dataclass(frozen=True)
class Supports:
    """What supports resist with.

    Attributes
    ----------
    dofs : (d,) array
        Unknowns that they hold.
    rows : (r, d) array
        Coefficients of their functionals on these.
    stiffness : (r,) array
        Of the functionals [N/m].
    constant : (6 n, 6 n) sparse array
        Stiffness of those that hold few bodies, and a trace that holds platens.
    low_rank : LowRank
        Stiffness of those that hold many, as few rows.
    """

    dofs: IntArray
    rows: FloatArray
    stiffness: FloatArray
    constant: csr_array
    low_rank: LowRank

    @classmethod
    def of(cls, rows: csr_array, tessellation: Tessellation, platens: WithPlatens, elastic: FloatArray) -> Supports:
        """Supports of a discretization.

        Parameters
        ----------
        rows : (r, 6 n) sparse array
            Coefficients of their functionals.
        tessellation : Tessellation
            Bodies of the specimen.
        platens : WithPlatens
            The same with platens.
        elastic : (m, 3) array
            Elastic moduli of all contacts [Pa].
        """
        area = platens.tessellation.contacts.area
        # That of short contacts of a platen has no bounds: with it, reactions would be round-off of displacements.
        behind = [float((elastic[own, 0] * np.sqrt(area[own])).sum()) for own in platens.contacts]
        stiffness = _stiffness(rows, tessellation, platens, float(elastic[:, 0].max()), behind)
        held = np.array([len(np.unique(rows.indices[a:b] // 6)) for a, b in pairwise(rows.indptr)])
        scaled = csr_array(rows.multiply(np.sqrt(stiffness)[:, None]))
        narrow = csr_array(scaled[held <= limits.NARROW])
        # Solvers treat what holds platens as they treat supports, which is last.
        anchors = np.zeros((len(platens.tessellation), 6))
        for k, own in enumerate(platens.contacts):
            anchors[len(tessellation) + k] = limits.ANCHOR * behind[k] * np.repeat([1.0, area[own].sum()], 3)
        constant = csr_array(narrow.T @ narrow + csr_array(diags_array(anchors.ravel())))
        low_rank = LowRank.of(csr_array(scaled[held > limits.NARROW]), 1.0)
        dofs = np.unique(rows.indices).astype(np.int64)
        return cls(dofs, rows[:, dofs].toarray(), stiffness, constant, low_rank)

    def forces(self, u: FloatArray) -> FloatArray:
        """Force of every functional on the specimen for displacements (6 n,) [N], shape (r,)."""
        return np.asarray(-self.stiffness * (self.rows @ u[self.dofs]), dtype=np.float64)


def _stiffness(
    rows: csr_array, tessellation: Tessellation, platens: WithPlatens, stiffest: float, behind: list[float]
) -> FloatArray:
    """Stiffness of functionals [N/m], shape (r,): it goes with the bodies that one holds.

    A functional whose coefficients are shared by N bodies moves by the mean of their displacements, and the structure
    resists that with some contacts of each of them.
    """
    inner, contacts = tessellation.contacts, platens.tessellation.contacts
    ends, length = contacts.bodies.ravel(), np.repeat(contacts.length, 2)
    count = np.bincount(ends, minlength=len(platens.tessellation))
    arm = 0.5 * np.bincount(ends, length, len(count)) / np.maximum(count, 1)
    entries = rows.tocoo()
    share = entries.data / np.where(entries.col % 6 < 3, 1.0, arm[entries.col // 6])
    shares = np.bincount(entries.row, share**2, rows.shape[0])
    typical = stiffest * float(np.median(inner.area / inner.length))
    stiffness = limits.SUPPORT_STIFFNESS * typical / shares
    platen = np.full(rows.shape[0], -1)
    platen[entries.row] = entries.col // 6 - len(tessellation)
    for k, own in enumerate(behind):
        stiffness[platen == k] = limits.SUPPORT_STIFFNESS * own
    return np.asarray(stiffness, dtype=np.float64)


def spin_stiffness(tessellation: Tessellation, platens: WithPlatens, elastic: FloatArray) -> FloatArray:
    """A trace of rotational stiffness in every contact [N m], shape (m,), given elastic moduli (m, 3) [Pa].

    Contacts act at one point of their facets, so a body at a corner that touches only two others may spin freely about
    the line between these points, and so may one with five of which three are broken: the load could not be found where
    that begins. The stiffness against relative rotation of a facet glued over its whole area, ``E A^2 / (12 L)``, times
    a tiny factor stops that; it does no work in uniform strain, where rotations are equal.
    """
    contacts = platens.tessellation.contacts
    count = np.bincount(contacts.bodies.ravel(), minlength=len(platens.tessellation))
    few = (count[contacts.bodies] <= limits.FEW).any(axis=1)
    share = np.where(few, limits.SPIN_STIFFNESS_OF_FEW, limits.SPIN_STIFFNESS)
    stiffness: FloatArray = share * elastic[:, 0] * contacts.area**2 / (12.0 * contacts.length)
    stiffness[len(tessellation.contacts) :] = 0.0  # platens that can turn transmit no moment at all
    return stiffness
