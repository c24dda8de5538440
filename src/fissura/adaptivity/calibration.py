"""Elastic calibration of the coarse part.

Elastic behaviour does not depend on body size in the bulk (theory section 2), but a layer one body thick along every
surface is biased, and coarse bodies have thick layers. One elastic solution at full resolution removes what this does
to the measured stiffness: coarse contacts of every coarser discretization of the specimen get one common factor on
their stiffness, such that the gauge opens under unit load exactly as at full resolution.
"""

import logging

import numpy as np

from fissura.adaptivity import limits
from fissura.arrays import FloatArray
from fissura.equilibrium import System

_log = logging.getLogger(__name__)


def gauge_compliance(system: System) -> float:
    """Controlled quantity per unit load of the undamaged structure [m/N]."""
    system.symmetric.factor_contacts(system.geometry, system.moduli)
    return float(system.control @ system.symmetric.solve(system.load, limits.TOLERANCE))


def _unit_solutions(system: System) -> FloatArray:
    """Undamaged displacements under the unit load, and under a unit force at the gauge, (6 n, 2)."""
    system.symmetric.factor_contacts(system.geometry, system.moduli)
    if np.array_equal(system.load, system.control):
        return np.stack([system.symmetric.solve(system.load, limits.TOLERANCE_OF_TWO)] * 2, axis=1)
    return system.symmetric.solve(np.stack([system.load, system.control], axis=1), limits.TOLERANCE_OF_TWO)


def _compliance(system: System, solutions: FloatArray) -> float:
    """Gauge compliance [m/N] with an error of the second order in those of the solutions.

    Forces that the first solution leaves out of balance move the gauge by their work on the second one.
    """
    loaded, gauged = (np.ascontiguousarray(u) for u in solutions.T)
    forces = system.internal(system.strain(loaded) * system.moduli, loaded)
    return float(system.control @ loaded + gauged @ (system.load - forces))


def elastic_share(system: System, solutions: FloatArray) -> float:
    """Part of the undamaged gauge compliance that is due to coarse contacts [m/N].

    Parameters
    ----------
    system : System
        Equations.
    solutions : (6 n, 2) array
        Undamaged displacements under the unit load, and under a unit force at the controlled quantity.
    """
    a, b = (system.strain(np.ascontiguousarray(u)) for u in solutions.T)
    each = system.geometry.volume * np.einsum("ca,ca,ca->c", a, system.moduli, b)
    return float(each[system.coarse].sum())


def calibrated(system: System, target: float, start: float = 1.0) -> System:
    """Calibrate a system so that its undamaged gauge compliance is the given one.

    Compliance is close to linear in the inverse of the factor; the slope is the mutual energy of the coarse contacts
    under the load and under a unit force at the gauge.

    Parameters
    ----------
    system : System
        Equations of a discretization.
    target : float
        Compliance at full resolution [m/N]; 0 leaves the system as it is.
    start : float
        Factor to begin with, such as that of a similar discretization.

    Returns
    -------
    System
        The same equations with coarse contacts scaled.
    """
    if target == 0.0:  # nothing to be met: the load does not move the gauge
        return system
    if start != 1.0 and len(system.coarse):
        system = system.scaled(start)
    for attempt in range(limits.MOST_SOLUTIONS):
        if not len(system.coarse):
            break
        solutions = _unit_solutions(system)
        compliance = _compliance(system, solutions)
        if abs(compliance / target - 1.0) < limits.ACCURACY:
            break
        slope = elastic_share(system, solutions) * system.elastic_scale
        if attempt == 0 and abs(slope) < limits.SMALLEST_SHARE * target:
            break
        inverse = 1.0 / system.elastic_scale + (target - compliance) / slope
        scale = min(max(1.0 / inverse, limits.SCALES[0]), limits.SCALES[1]) if inverse > 0.0 else limits.SCALES[1]
        before, system = system.elastic_scale, system.scaled(scale)
        if abs(scale / before - 1.0) < limits.SMALL_CHANGE:
            break
    _log.info("stiffness of elastic contacts times %.4f", system.elastic_scale)
    return system
