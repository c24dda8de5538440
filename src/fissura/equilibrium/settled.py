"""States of equilibrium, and the one that damage as it is has at a value of the controlled quantity."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import limits
from fissura.equilibrium.response import Response
from fissura.equilibrium.system import System
from fissura.linear.krylov import dot
from fissura.linear.protocol import SingularMatrixError


class UnmovedGaugeError(SingularMatrixError):
    """The load does not move the controlled quantity."""


@dataclass(frozen=True)
class Equilibrium:
    """A state of equilibrium.

    Attributes
    ----------
    response : Response
        Displacements, strains, tractions, history.
    load : float
        Load multiplier [N].
    value : float
        Controlled quantity ``g . u`` [m].
    residual, energy : float
        Norm of the residual over that of the load, and work of the residual on the last correction over that of the
        load on the displacements; 0 where the equations were linear.
    iterations : int
        Nonlinear iterations it took.
    """

    response: Response
    load: float
    value: float
    residual: float = 0.0
    energy: float = 0.0
    iterations: int = 0


def reach_of(control: FloatArray, unit: FloatArray) -> float:
    """Controlled quantity per unit load, from its coefficients and the displacements under the unit load, (6 n,) each.

    Raises
    ------
    UnmovedGaugeError
        The load does not move it, but for round-off.
    """
    reach = dot(control, unit)
    if not np.isfinite(reach) or abs(reach) <= limits.UNMOVED * float(np.abs(control * unit).sum()):
        raise UnmovedGaugeError("the load does not move the controlled quantity")
    return reach


def settle(system: System, history: FloatArray, value: float) -> Equilibrium:
    """Solution with the damage that is there: the controlled quantity takes the given value, other loads are kept.

    Used for the first elastic state, and to find the state of the last accepted step on a new discretization. It is
    linear but for contacts that open or close, under laws for which these differ: they are found one linear solution
    after another.

    Raises
    ------
    SingularMatrixError
        The structure is a mechanism.
    UnmovedGaugeError
        The load does not move the controlled quantity, but for round-off.
    """
    for iterations in range(1, limits.CLOSINGS + 1):
        unit = system.prepared.solve(history)
        dead = None if system.dead is None else system.prepared.dead(history)
        reach, missing = 1.0, value
        if not system.by_force:
            reach = reach_of(system.control, unit)
            missing = value if dead is None else value - dot(system.control, dead)
        load = missing / reach
        u = unit * load if dead is None else unit * load + dead
        strain = system.strain(u)
        moved = system.law.unloaded(strain[system.damageable], history)
        if system.prepared.is_for(moved) or iterations == limits.CLOSINGS:
            break
        history = moved
    damaged = strain[system.damageable] * system.moduli[system.damageable] * system.law.intact(history)
    return Equilibrium(system.answer(u, strain, damaged, history), load, value, iterations=iterations)
