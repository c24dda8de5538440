"""The law of Cusatis & Cedolin with cracks that close (theory section "Cracks that close").

Damage grows as in the published law. A contact that is pressed (``e_N < 0``) has its undamaged normal stiffness, so
that the faces of a crack stay apart; there is no friction, shear keeps what damage has left of it.
"""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.contact.law import CusatisCedolin
from fissura.kernels import njit

#: Column of history behind those of the published law: 1 where the contact is pressed.
_CLOSED = 3


@njit()
def _close(strain, E, traction, new, tangent, with_tangent):  # type: ignore[no-untyped-def]
    for c in range(len(strain)):
        new[c, 3] = 0.0
        if strain[c, 0] < 0.0:
            new[c, 3] = 1.0
            traction[c, 0] = E * strain[c, 0]
            if with_tangent:
                tangent[c, 0, 0] = E
                tangent[c, 0, 1] = 0.0
                tangent[c, 0, 2] = 0.0


@dataclass(frozen=True)
class ClosingCusatisCedolin(CusatisCedolin):
    """The law for a set of contacts; see :class:`CusatisCedolin` for its attributes."""

    def initial_history(self) -> FloatArray:
        """History of a virgin contact: damage, largest ``e_N``, largest ``e_T``, whether it is pressed; (m, 4)."""
        return np.zeros((len(self.length), 4))

    def intact(self, history: FloatArray) -> FloatArray:
        """Share of each modulus that is left: ``1 - D``, but 1 of the normal one where pressed; (m, 4) -> (m, 3)."""
        out = super().intact(history)
        out[history[:, _CLOSED] > 0.0, 0] = 1.0
        return out

    def unloaded(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """History with the contacts pressed that these strains press; (m, 3), (m, 4) -> (m, 4)."""
        out = history.copy()
        out[:, _CLOSED] = strain[:, 0] < 0.0
        return out

    def _run(
        self, strain: FloatArray, history: FloatArray, tangent: FloatArray, with_tangent: bool
    ) -> tuple[FloatArray, FloatArray]:
        traction, new = super()._run(strain, history, tangent, with_tangent)
        _close(strain, self.material.E, traction, new, tangent, with_tangent)
        return traction, new
