"""The equation that, added to equilibrium, tells how far along its path a structure goes in a step."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import limits
from fissura.equilibrium.response import Response
from fissura.equilibrium.system import System
from fissura.linear.krylov import dot


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
        Error, relative to `scale`, with which it counts as met.
    scale : float
        Size of what is to be met: that of `value`, or more where it is zero or nearly so.
    prescribed : bool
        `value` is that of the controlled quantity, to round-off.
    begun : Response, optional
        Where energy leads, the state at which the step begins.
    """

    vector: FloatArray
    load_factor: float
    value: float
    tolerance: float
    scale: float
    prescribed: bool = False
    begun: Response | None = None

    def gap(self, u: FloatArray, load: float) -> float:
        """What is missing."""
        return self.value - dot(self.vector, u) - self.load_factor * load

    def met(self, u: FloatArray, load: float) -> bool:
        """Whether the equation holds."""
        return abs(self.gap(u, load)) <= self.tolerance * self.scale

    @property
    def by_force(self) -> bool:
        """Whether it prescribes the load multiplier."""
        return self.prescribed and self.load_factor != 0.0

    @property
    def in_energy(self) -> bool:
        """Whether energy leads."""
        return self.begun is not None


def prescribed(system: System, value: float, begun: float = 0.0) -> Constraint:
    """Let the controlled quantity take a value: a gauge [m] (de Borst 1987), a displacement [m], or the load [N].

    Parameters
    ----------
    system : System
        What is controlled.
    value : float
        Its value.
    begun : float, optional
        Its value where the step begins.
    """
    scale = max(abs(value), abs(begun))
    if system.by_force:
        return Constraint(np.zeros(system.size), 1.0, value, limits.VALUE_ERROR, scale, prescribed=True)
    return Constraint(system.control, 0.0, value, limits.VALUE_ERROR, scale, prescribed=True)


def dissipating(system: System, begun: Response, multiplier: float, energy: float) -> Constraint:
    """Control by dissipated energy: a step away from an equilibrium takes a given energy [J].

    All unloading goes to the origin, so the energy that a step dissipates is linear in where it ends, ``(F . u_new -
    F_new . u) / 2`` with all external forces ``F = multiplier load + dead`` (Gutierrez 2004; Verhoosel, Remmers &
    Gutierrez 2009). Where contacts close, that counts work as dissipated which is stored (:func:`dissipation`): whether
    enough was dissipated is to be seen at the end.

    Parameters
    ----------
    system : System
        Loads.
    begun : Response
        The equilibrium where the step begins.
    multiplier : float
        Its load multiplier [N].
    energy : float
        Energy to dissipate.
    """
    kept = 0.0 if system.dead is None else 0.5 * dot(system.dead, begun.u)
    vector, factor = 0.5 * system.external(multiplier), -0.5 * dot(system.load, begun.u)
    return Constraint(vector, factor, energy + kept, limits.ENERGY_ERROR, energy, begun=begun)


def holding(system: System, before: Response, after: Response) -> Constraint | None:
    """Hold the contacts whose damage grew from one state to another where they are in the latter; None if none grew.

    Where damage localizes, the energy dissipated is stationary along the branch on which all contacts that were damaged
    so far go on, and Newton's method fails. The contacts whose damage runs away under a kept displacement are those of
    the branch on which the others unload; their opening is a gauge for it, as a crack mouth opening would be (weighted
    by growth, after Geers 1999).
    """
    damage = system.law.damage
    growth = np.maximum(damage(after.history) - damage(before.history), 0.0)
    traction = np.zeros_like(after.traction)
    traction[system.damageable] = growth[:, None] * after.traction[system.damageable]
    vector = system.internal(traction, np.zeros(system.size))
    value = dot(vector, after.u)
    return Constraint(vector, 0.0, value, limits.HELD_ERROR, value) if value > 0.0 else None
