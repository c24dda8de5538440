"""Macroscopic stiffness of periodic cells under prescribed strain (theory section 2).

Displacements are ``u = eps x + w`` with a fluctuation w that is the same for all images of a body, so that they jump by
``eps shift`` between images. Then the strain of a contact is that of the affine part, ``frame (eps n)``, plus that of
the fluctuation, and equilibrium of the bodies determines the fluctuation.
"""

import numpy as np
from scipy.sparse import csr_array

from fissura.arrays import FloatArray
from fissura.contact import contact_strains, kinematics_of, nodal_forces
from fissura.elasticity.stiffness import unit_strains
from fissura.linear.assembly import pattern
from fissura.linear.symmetric import SymmetricSolver
from fissura.tessellation.periodic import PeriodicCell


class Homogenisation:
    """Elastic equations of one periodic cell, for contact constants yet to be given.

    Parameters
    ----------
    cell : PeriodicCell
        Bodies and contacts.

    Attributes
    ----------
    affine : (6, m, 3) array
        Contact strains of the six unit strains without any fluctuation.
    """

    def __init__(self, cell: PeriodicCell) -> None:
        contacts = cell.contacts
        i, j = contacts.bodies.T
        self.cell = cell
        self.geometry = kinematics_of(contacts, cell.x[i], cell.x[j] + cell.shift, len(cell))
        self.affine: FloatArray = np.einsum("cai,kij,cj->kca", self.geometry.frame, unit_strains(), contacts.normal)
        # Equilibrium leaves a translation of everything free. Forces of the affine part have no resultant, so a spring
        # at one body holds it without taking any force.
        typical = float(np.median(contacts.area / contacts.length))
        size = 6 * len(cell)
        held = csr_array((np.full(3, typical), (range(3), range(3))), shape=(size, size))
        self._pattern = pattern(self.geometry, held)
        self._solver = SymmetricSolver(self._pattern, cell.x)

    def _solve(self, alpha: float, elastic: FloatArray) -> FloatArray:
        """Total contact strains under the affine strains `elastic`; both (k, m, 3)."""
        moduli = np.array([1.0, alpha, alpha])
        self._solver.factor_contacts(self.geometry, np.tile(moduli, (len(self.geometry), 1)))
        forces = np.stack([nodal_forces(self.geometry, moduli * e).ravel() for e in elastic], axis=1)
        found = self._solver.solve(-forces)
        w = [np.ascontiguousarray(column).reshape(-1, 6) for column in found.T]
        return elastic + np.stack([contact_strains(self.geometry, each) for each in w])

    def stiffness(self, alpha: float, E: float = 1.0) -> FloatArray:
        """Macroscopic stiffness for contact constants.

        Columns are the average stresses ``(1/V) sum A sym(t (x) (x_j + shift - x_i))`` under unit strains.

        Parameters
        ----------
        alpha : float
            Tangential over normal stiffness of contacts, above 0.
        E : float
            Normal modulus of contacts [Pa].

        Returns
        -------
        (6, 6) array
            In Voigt's notation, strains with shear angles [Pa].
        """
        return self._average(alpha, E, self._solve(alpha, self.affine))

    def voigt(self, alpha: float, E: float = 1.0) -> FloatArray:
        """The same without fluctuations: an upper bound for this very cell; (6, 6) [Pa]."""
        return self._average(alpha, E, self.affine)

    def _average(self, alpha: float, E: float, strain: FloatArray) -> FloatArray:
        geometry, moduli = self.geometry, E * np.array([1.0, alpha, alpha])
        # The product of a stress tensor with a unit strain of Voigt's notation is its component.
        average: FloatArray = np.einsum("c,kca,a,lca->kl", geometry.volume, self.affine, moduli, strain)
        return average / self.cell.side**3
