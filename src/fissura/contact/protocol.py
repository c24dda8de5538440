"""What a contact law is to everything outside this room."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fissura.material import Material

__all__ = ["ContactLaw"]

FloatArray = NDArray[np.float64]


class ContactLaw(Protocol):
    """A law for a set of k contacts: tractions from strains and history.

    It keeps no state. What it has to remember of a contact is a row of history, of as many columns as it likes; what
    they mean only the law knows.
    """

    @classmethod
    def create(
        cls,
        material: Material,
        length: FloatArray,
        scale: FloatArray | None = None,
        ductility: FloatArray | None = None,
    ) -> Self:
        """Prepare the law.

        Parameters
        ----------
        material : Material
            Parameters where the field has its mean.
        length : (k,) array
            Contact lengths [m]; k may be 0.
        scale : (k,) array, optional
            Relative strength; 1 by default.
        ductility : (k,) array, optional
            Relative fracture energy over the square of the relative strength; 1 by default.

        Raises
        ------
        InputError
            Lengths or constants for which the law does not hold.
        """

    @property
    def scale(self) -> FloatArray:
        """Relative strength, shape (k,)."""

    @property
    def elastic(self) -> FloatArray:
        """Elastic moduli of the three strain components [Pa], shape (3,)."""

    def initial_history(self) -> FloatArray:
        """History of virgin contacts, shape (k, h)."""

    def damage(self, history: FloatArray) -> FloatArray:
        """Damage, 0 to 1: the share of the elastic stiffness that unloading has lost; (k, h) -> (k,)."""

    def loading(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far contacts are strained now, and have been at most.

        Parameters
        ----------
        strain : (k, 3) array
            ``e_N, e_M, e_L``.
        history : (k, h) array
            Accepted history of these strains.

        Returns
        -------
        now, largest : (k,) arrays
            Squares of effective strains, as energies are. A law that does not remember the largest strain gives `now`
            twice: its contacts never count as unloaded, and stay fine.
        """

    def response(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tractions ``s_N, s_M, s_L`` [Pa], shape (k, 3), and what history becomes; from strain and accepted history.

        All unloading goes to the origin: tractions are elastic ones times one minus damage.
        """

    def tangent(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """Consistent tangent ``ds/de`` [Pa], shape (k, 3, 3)."""

    def utilisation(self, strain: FloatArray) -> FloatArray:
        """Elastic effective traction over strength, which goes with the size of strains; (k, 3) -> (k,)."""
