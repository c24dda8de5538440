"""What a structure answers to displacements, and the energy that contacts lose from one answer to the next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray
from fissura.linear.krylov import dot

if TYPE_CHECKING:
    from fissura.equilibrium.system import System


@dataclass(frozen=True)
class Response:
    """What the structure answers to displacements.

    Attributes
    ----------
    u : (6 n,) array
        Displacements and rotations.
    strain, traction : (m, 3) array
        Of all contacts; tractions in Pa.
    history : (k, h) array
        History of the contacts with damage, if these displacements were accepted.
    forces : (6 n,) array
        Internal forces and moments, supports included.
    """

    u: FloatArray
    strain: FloatArray
    traction: FloatArray
    history: FloatArray
    forces: FloatArray

    @property
    def stored(self) -> float:
        """Elastic energy of contacts, ``sum A L s . e / 2``, of the stiffness against spinning and of supports [J]."""
        return 0.5 * dot(self.forces, self.u)


def dissipation(system: System, old: Response, new: Response) -> tuple[FloatArray, FloatArray]:
    """Energy that contacts dissipate between two responses.

    It is ``A L (s_old.e_new - s_new.e_old)/2``, their work by the trapezoidal rule less what they store. That counts
    too much where a contact opens or closes, one of which is stiffer: its normal traction is zero on the way, so all
    work of it is stored. Laws that do not close have none of this.

    Parameters
    ----------
    system : System
        Their equations.
    old, new : Response
        States at the ends of a step.

    Returns
    -------
    dissipated, stored : (m,) arrays
        Energy dissipated by each contact [J], and what the trapezoidal rule counts as that although it is stored.
    """
    volume = system.geometry.volume
    work = np.einsum("ca,ca->c", old.traction, new.strain) - np.einsum("ca,ca->c", new.traction, old.strain)
    stored = np.zeros(len(volume))
    turned = system.damageable[old.strain[system.damageable, 0] * new.strain[system.damageable, 0] < 0.0]
    if len(turned):
        uneven = np.zeros(len(volume), dtype=np.bool_)
        for history in (old.history, new.history):
            left = system.law.intact(history)
            uneven[system.damageable] |= left[:, 0] != left[:, 1]
        turned = turned[uneven[turned]]
        normal = old.traction[turned, 0] * new.strain[turned, 0] - new.traction[turned, 0] * old.strain[turned, 0]
        stored[turned] = 0.5 * volume[turned] * normal
    return np.asarray(0.5 * volume * work - stored, dtype=np.float64), stored
