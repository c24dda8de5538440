"""The compliance at full resolution of large specimens, without a solution there.

Discretizations that are fine around notch tips, loads, supports and gauges, and coarser and coarser elsewhere, are made
homogeneous outside (`adaptivity/homogeneous.py`). Homogeneous parts are exact in uniform strain, so what is left of
their error comes from gradients, goes with the square of the spacing, and hardly scatters: its limit can be
extrapolated. Without the homogeneous part the compliance scatters by 1 % from one discretization to the next.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fissura.adaptivity import limits
from fissura.adaptivity.homogeneous import homogeneous, homogeneous_compliance, is_tabulated
from fissura.adaptivity.region import RefinedRegion
from fissura.arrays import FloatArray
from fissura.equilibrium import System

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Extrapolated:
    """Compliance at full resolution, extrapolated.

    Attributes
    ----------
    compliance : float
        Controlled quantity per unit load of the undamaged structure [m/N].
    error : float
        Estimate of its error, relative.
    radius : float
        Radius of what was fine [m].
    spacings, values : (k,) array
        Coarse spacings of the sequence [m], descending, and their compliances [m/N].
    bodies : tuple of int
        Their numbers of bodies.
    """

    compliance: float
    error: float
    radius: float
    spacings: FloatArray
    values: FloatArray
    bodies: tuple[int, ...]


def bodies_of_calibration(bodies: float) -> float:
    """Bodies of the largest elastic solution that calibration needs, by those of full resolution."""
    return bodies if bodies <= limits.LARGEST_SOLVED else limits.MOST_OF_SEQUENCE


def coarser(region: RefinedRegion, places: FloatArray, radius: float, spacing: float) -> RefinedRegion:
    """A region of the sequence.

    Parameters
    ----------
    region : RefinedRegion
        What is fine at the start of a run.
    places : (p, 3) array
        Points of loads, supports and gauges [m].
    radius : float
        What is fine around them and around notch tips [m]; with 0 only what is at the start of a run.
    spacing : float
        Coarse spacing [m].
    """
    if radius == 0.0:
        places = places[:0]
    ramp = (spacing - region.l_f) / limits.GRADING
    tip = max(radius, region.r_f if region.r_l is None else region.r_l)
    return replace(region, l_c=spacing, ramp=ramp, r_l=tip, r_w=radius, needed=places)


class _Sequence:
    """Solutions one after another."""

    def __init__(self, equations: Callable[[RefinedRegion], System], region: RefinedRegion, places: FloatArray) -> None:
        self._equations, self._region, self._places = equations, region, places
        self.bodies = self.fine = 0

    def system(self, radius: float, spacing: float) -> System:
        """Equations with that radius and spacing, both over the fine one."""
        l_f = self._region.l_f
        return self._equations(coarser(self._region, self._places, radius * l_f, spacing * l_f))

    def compliance(self, radius: float, spacing: float, system: System | None = None) -> float:
        """Compliance with them."""
        l_f = self._region.l_f
        system = self.system(radius, spacing) if system is None else system
        self.bodies, self.fine = len(system.tessellation), int(system.tessellation.fine.sum())
        found = homogeneous_compliance(homogeneous(system, l_f))
        _log.debug("%d bodies, %g l_f beyond %g l_f: %.6g m/N", self.bodies, spacing, radius, found)
        return found


@dataclass(frozen=True)
class _Window:
    """What is fine in a sequence.

    Attributes
    ----------
    radius : float
        Its radius over `l_f`.
    value, change : float
        Compliance with it, and what is new against the radius before [m/N].
    bodies, fine : int
        All bodies, and fine ones.
    """

    radius: float
    value: float
    change: float
    bodies: int
    fine: int


def _window(sequence: _Sequence, spacing: float) -> _Window | None:
    """As large a window as it may have bodies; None where the constants of the bulk are not known."""
    found: _Window | None = None
    for radius in limits.RADII:
        if (
            found is not None
            and found.radius > limits.SURE
            and (found.fine * (radius / found.radius) ** 2 > limits.MOST_FINE)
        ):
            break
        system = sequence.system(radius, spacing)
        fine = int(system.tessellation.fine.sum())
        if found is None and not is_tabulated(system):
            return None
        if found is not None and fine > limits.MOST_FINE:  # loads and supports on whole faces of large specimens
            break
        value = sequence.compliance(radius, spacing, system)
        change = 0.0 if found is None else value - found.value
        found = _Window(radius, value, change, sequence.bodies, fine)
    return found


def extrapolated_compliance(
    equations: Callable[[RefinedRegion], System], region: RefinedRegion, places: FloatArray, bodies: int
) -> Extrapolated | None:
    """Extrapolate the compliance at full resolution from coarser discretizations of a specimen.

    Parameters
    ----------
    equations : callable
        Gives the equations for a region.
    region : RefinedRegion
        What is fine at the start of the run.
    places : (p, 3) array
        Points of loads, supports and gauges [m]: rigid bodies are pressed in less the larger they are.
    bodies : int
        Bodies at full resolution.

    Returns
    -------
    Extrapolated or None
        None where the constants of the bulk are not known.

    Raises
    ------
    SingularMatrixError
        The structure is a mechanism.
    """
    sequence = _Sequence(equations, region, places)
    spacing = max(limits.COARSEST, (bodies / limits.FEWEST_OF_SEQUENCE) ** (1 / 3))
    window = _window(sequence, spacing)
    if window is None:
        return None
    spacings, values, numbers, fine = [spacing], [window.value], [window.bodies], window.fine
    while len(spacings) < limits.MOST_LEVELS:
        spacing /= limits.RATIO
        expected = fine + (numbers[-1] - fine) * limits.RATIO**3
        if spacing < limits.FINEST or (expected > limits.MOST_OF_SEQUENCE and len(spacings) >= limits.LEVELS):
            break
        values.append(sequence.compliance(window.radius, spacing))
        spacings.append(spacing)
        numbers.append(sequence.bodies)
        fine = sequence.fine
    radius = window.radius * region.l_f
    return _extrapolated(np.array(spacings), np.array(values), window.change, radius, tuple(numbers), region.l_f)


def _extrapolated(
    spacings: FloatArray, values: FloatArray, change: float, radius: float, bodies: tuple[int, ...], l_f: float
) -> Extrapolated:
    """Limit of the finest members.

    Its error is what another form would make of it, what the radius did, and how far members are from the form.
    """
    at, found = spacings[-limits.LEVELS :], values[-limits.LEVELS :]
    form = np.polynomial.Polynomial.fit(at**2, found, 1)
    square, scatter = form(1.0), float(np.abs(found - form(at**2)).max())
    straight = np.polynomial.Polynomial.fit(at, found, 1)(1.0)
    error = 0.0
    if square != 0.0:
        error = limits.FLOOR + (abs(square - straight) + limits.SHARE_OF_RADIUS * abs(change) + scatter) / abs(square)
    _log.info("compliance at full resolution extrapolated, to about %.1g", error)
    return Extrapolated(float(square), float(error), radius, spacings * l_f, values, bodies)
