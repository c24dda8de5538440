"""What a contact law is to everything outside this room."""

from collections.abc import Mapping
from typing import ClassVar, Protocol, Self

from pydantic import BaseModel

from fissura.arrays import FloatArray
from fissura.material import Material


class AppliedLaw(Protocol):
    """A law for a set of k contacts: tractions from strains and history.

    It keeps no state. What it has to remember of a contact is a row of history, of as many columns as it likes; what
    they mean only the law knows. Its stiffness without growth of damage is linear in pieces: tractions are elastic ones
    times shares :meth:`intact`, which change at most where a contact opens or closes.
    """

    @property
    def scale(self) -> FloatArray:
        """Relative strength, shape (k,)."""

    def initial_history(self) -> FloatArray:
        """History of virgin contacts, shape (k, h)."""

    def damage(self, history: FloatArray) -> FloatArray:
        """Damage, 0 to 1, as results show it and by which cracks are told; never falls; (k, h) -> (k,)."""

    def intact(self, history: FloatArray) -> FloatArray:
        """Share of each elastic modulus that an accepted state has left; (k, h) -> (k, 3), positive.

        Where damage does not grow, tractions are ``intact(history) * elastic * strain`` with the history that belongs
        to the strain.
        """

    def unloaded(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """History at strains (k, 3) that were reached without any growth of damage; (k, h) -> (k, h).

        The same for laws that do not remember where contacts are now.
        """

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

        All unloading goes to the origin: tractions are the elastic ones times `intact` of the new history.
        """

    def tangent(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """Consistent tangent ``ds/de`` [Pa], shape (k, 3, 3)."""

    def utilisation(self, strain: FloatArray) -> FloatArray:
        """Elastic effective traction over strength, which goes with the size of strains; (k, 3) -> (k,)."""


class ContactLaw(AppliedLaw, Protocol):
    """A law as a class, and what all contacts of one material have in common."""

    #: Model of the table ``[material.NAME]`` of the case file, for constants of this law alone; None: it has none.
    Parameters: ClassVar[type[BaseModel] | None] = None

    @classmethod
    def limits(cls, material: Material) -> Mapping[str, float]:
        """Lengths [m] that contacts with damage must not reach, by what would go wrong there; empty where none would.

        ``fissura check`` shows a limit named "in tension" as "limit in tension"; the least one counts.
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
            Constants of ``[material]`` where the field has its mean; `parameters` are those of the law's own table.
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
    def elastic(self) -> FloatArray:
        """Elastic moduli of the three strain components [Pa], shape (3,)."""

    @property
    def strength(self) -> float:
        """Tensile strength of a contact of unit relative strength [Pa]."""
