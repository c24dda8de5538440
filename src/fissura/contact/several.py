"""One law with several materials: contacts of each kind are a set of their own."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.contact.protocol import AppliedLaw, ContactLaw
from fissura.material import Material, Materials

_NONE = np.empty(0)


@dataclass(frozen=True)
class _Several:
    """Sets of contacts with different materials as one set of m contacts.

    Attributes
    ----------
    parts : tuple of (array, ContactLaw)
        Numbers of contacts, and their law.
    count : int
        How many contacts there are in all.
    """

    parts: tuple[tuple[IntArray, ContactLaw], ...]
    count: int

    def _gathered(self, ask: Callable[[ContactLaw, IntArray], FloatArray]) -> FloatArray:
        """What all parts answer, in the order of the contacts."""
        answers = [ask(law, which) for which, law in self.parts]
        out = np.empty((self.count, *answers[0].shape[1:]))
        for (which, _), answer in zip(self.parts, answers, strict=True):
            out[which] = answer
        return out

    @property
    def scale(self) -> FloatArray:
        """Relative strength, shape (m,)."""
        return self._gathered(lambda law, _: law.scale)

    def initial_history(self) -> FloatArray:
        """History of virgin contacts, shape (m, h)."""
        return self._gathered(lambda law, _: law.initial_history())

    def damage(self, history: FloatArray) -> FloatArray:
        """Damage; (m, h) -> (m,)."""
        return self._gathered(lambda law, which: law.damage(history[which]))

    def intact(self, history: FloatArray) -> FloatArray:
        """Share of each elastic modulus that is left; (m, h) -> (m, 3)."""
        return self._gathered(lambda law, which: law.intact(history[which]))

    def unloaded(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """History at strains that were reached without any growth of damage; (m, 3), (m, h) -> (m, h)."""
        return self._gathered(lambda law, which: law.unloaded(strain[which], history[which]))

    def loading(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Squares of effective strains now and at most; (m, 3), (m, h) -> (m,), (m,)."""
        both = self._gathered(lambda law, which: np.stack(law.loading(strain[which], history[which]), axis=1))
        return both[:, 0], both[:, 1]

    def response(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tractions [Pa] and new history; (m, 3), (m, h) -> (m, 3), (m, h)."""
        both = self._gathered(lambda law, which: np.hstack(law.response(strain[which], history[which])))
        return np.ascontiguousarray(both[:, :3]), np.ascontiguousarray(both[:, 3:])

    def tangent(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """Consistent tangent [Pa]; (m, 3), (m, h) -> (m, 3, 3)."""
        return self._gathered(lambda law, which: law.tangent(strain[which], history[which]))

    def utilisation(self, strain: FloatArray) -> FloatArray:
        """Elastic effective traction over strength; (m, 3) -> (m,)."""
        return self._gathered(lambda law, which: law.utilisation(strain[which]))


@dataclass(frozen=True)
class LawOfMaterials:
    """A law and the materials of a specimen.

    Attributes
    ----------
    law : type
        The law.
    materials : Materials
        Its constants by place.
    """

    law: type[ContactLaw]
    materials: Materials

    def _of(self, material: Material) -> ContactLaw:
        """The law for no contacts."""
        return self.law.create(material, _NONE)

    def elastic(self, ends: IntArray) -> FloatArray:
        """Elastic moduli of contacts between bodies of two kinds each [Pa]; (m, 2) -> (m, 3)."""
        out = np.empty((len(ends), 3))
        for which, material in self._groups(ends):
            out[which] = self._of(material).elastic
        return out

    def strength(self, kinds: IntArray) -> FloatArray:
        """Tensile strength in the kinds of bodies [Pa]; (n,) -> (n,)."""
        return np.array([self._of(material).strength for material in self.materials.each])[kinds]

    def create(
        self, ends: IntArray, length: FloatArray, scale: FloatArray | None, ductility: FloatArray | None = None
    ) -> AppliedLaw:
        """The law for contacts between bodies of two kinds each.

        Parameters
        ----------
        ends : (k, 2) array
            Kinds of their bodies.
        length, scale, ductility : (k,) arrays
            See :meth:`ContactLaw.create`.

        Raises
        ------
        InputError
            Lengths or constants for which the law does not hold.
        """
        groups = self._groups(ends)
        if len(groups) <= 1:
            material = groups[0][1] if groups else self.materials.base
            return self.law.create(material, length, scale, ductility)
        parts = []
        for which, material in groups:
            own = [None if value is None else value[which] for value in (scale, ductility)]
            parts.append((which, self.law.create(material, length[which], *own)))
        return _Several(tuple(parts), len(ends))

    def _groups(self, ends: IntArray) -> list[tuple[IntArray, Material]]:
        """Numbers of contacts of each pair of materials, and what these are made of."""
        count = len(self.materials.each)
        if count == 1:
            return [(np.arange(len(ends)), self.materials.base)]
        pair = ends.min(axis=1, initial=count) * count + ends.max(axis=1, initial=0)
        found, number = np.unique(pair, return_inverse=True)
        return [
            (np.flatnonzero(number == k), self.materials.between(*divmod(int(pair), count)))
            for k, pair in enumerate(found)
        ]
