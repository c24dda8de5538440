"""Elastic calibration of the coarse part.

Elastic behaviour does not depend on body size in the bulk (theory section 2), but a layer one body thick along every
surface is biased, and coarse bodies have thick layers. One elastic solution at full resolution removes what this does
to the measured stiffness: coarse contacts of every coarser discretization of the specimen get one common factor on
their stiffness, such that the gauge opens under unit load exactly as at full resolution.
"""

from __future__ import annotations

import logging

import numpy as np

from fissura.equilibrium import System

__all__ = ["calibrated", "gauge_compliance"]

_log = logging.getLogger(__name__)

_LIMITS = (0.5, 2.0)
_ACCURACY = 1e-4
_SMALLEST_SHARE = 0.01  # of the compliance: below it the coarse part cannot matter

#: Error of the elastic solutions in the energy norm; their gauge is as exact, about.
_TOLERANCE = 1e-5

#: A change of the factor by less than this share needs no check: its square is what the slope leaves out.
_SMALL = 0.02


def gauge_compliance(system: System) -> float:
    """Controlled quantity per unit load of the undamaged structure [m/N]."""
    system.factor_secant(system.virgin())
    return float(system.control @ system.symmetric.solve(system.load, _TOLERANCE))


def calibrated(system: System, target: float, start: float = 1.0) -> System:
    """Calibrate a system so that its undamaged gauge compliance is the given one.

    Compliance is close to linear in the inverse of the factor; the slope is the mutual energy of the coarse contacts
    under the load and under a unit force at the gauge.

    Parameters
    ----------
    system : System
        Equations of a discretization.
    target : float
        Compliance at full resolution [m/N].
    start : float
        Factor to begin with, such as that of a similar discretization.

    Returns
    -------
    System
        The same equations with coarse contacts scaled.
    """
    if start != 1.0 and len(system.coarse):
        system = system.scaled(start)
    for _ in range(4):
        if not len(system.coarse):
            break
        system.factor_secant(system.virgin())
        solutions = system.symmetric.solve(np.stack([system.load, system.control], axis=1), _TOLERANCE)
        compliance = float(system.control @ solutions[:, 0])
        if abs(compliance / target - 1.0) < _ACCURACY:
            break
        slope = system.elastic_share(solutions) * system.elastic_scale
        if abs(slope) < _SMALLEST_SHARE * target:
            break
        inverse = 1.0 / system.elastic_scale + (target - compliance) / slope
        scale = min(max(1.0 / inverse, _LIMITS[0]), _LIMITS[1]) if inverse > 0.0 else _LIMITS[1]
        before, system = system.elastic_scale, system.scaled(scale)
        if abs(scale / before - 1.0) < _SMALL:
            break
    _log.info("stiffness of elastic contacts times %.4f", system.elastic_scale)
    return system
