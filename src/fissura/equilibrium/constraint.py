"""The equation that, added to equilibrium, tells how far along its path a structure goes in a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Constraint", "prescribed"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Constraint:
    """``vector . u + load_factor * load = value``.

    Attributes
    ----------
    vector : (6 n,) array
        Coefficients of displacements and rotations.
    load_factor : float
        Coefficient of the load multiplier.
    value : float
        What to meet.
    tolerance : float
        Error, relative to `value`, with which it counts as met.
    prescribed : bool
        `value` is that of the controlled quantity, to round-off.
    """

    vector: FloatArray
    load_factor: float
    value: float
    tolerance: float
    prescribed: bool = False

    def gap(self, u: FloatArray, load: float) -> float:
        """What is missing."""
        return self.value - float(self.vector @ u) - self.load_factor * load

    def met(self, u: FloatArray, load: float) -> bool:
        """Whether the equation holds."""
        return abs(self.gap(u, load)) <= self.tolerance * abs(self.value)


def prescribed(control: FloatArray, value: float) -> Constraint:
    """Indirect displacement control: a gauge takes the given value [m] (de Borst 1987)."""
    return Constraint(control, 0.0, value, 1e-9, prescribed=True)
