"""Strength and fracture energy of the material as a whole in direct tension, as measured on prisms.

`f_t` and `G_t` belong to the contacts. A crack runs between bodies: its facets are larger than the section, most are
inclined and carry shear, too, and damage begins in a volume before it becomes a crack. So the whole is a little
stronger than its contacts and dissipates more. ``macroscopic_tension.csv``, written by ``benchmarks/meaning.py``,
has means and scatter of prisms; they depend on shape, on `alpha` and on brittleness, but not on units.

This module needs nothing but the standard library, as :mod:`fissura.case.macroscopic` does.
"""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from itertools import pairwise

from fissura.elasticity import limits


@dataclass(frozen=True)
class Prisms:
    """Prisms that differ in their seed only.

    Attributes
    ----------
    width, length : float
        Size of the part that may crack, in ``l_f``.
    brittleness : float
        ``l_t / l_f`` with ``l_t = 2 E G_t / f_t^2``.
    alpha : float
        Of the contacts.
    prisms : int
        How many.
    strength, strength_std : float
        Peak load over section and ``f_t``: mean and standard deviation of single prisms.
    energy, energy_std : float
        Dissipated energy over section and ``G_t``, likewise.
    """

    width: float
    length: float
    brittleness: float
    alpha: float
    prisms: int
    strength: float
    strength_std: float
    energy: float
    energy_std: float


@dataclass(frozen=True)
class MacroscopicTension:
    """What was measured.

    Attributes
    ----------
    groups : tuple of Prisms
        Prisms of several shapes with the brittleness and `alpha` of the first one, and prisms of one of these shapes
        in which one of both numbers differs.
    """

    groups: tuple[Prisms, ...]

    @cached_property
    def shapes(self) -> tuple[Prisms, ...]:
        """Those that differ from the first one in their shape only."""
        first = self.groups[0]
        return tuple(g for g in self.groups if (g.brittleness, g.alpha) == (first.brittleness, first.alpha))

    def limits(self, number: str) -> tuple[float, float]:
        """Smallest and largest ``"brittleness"`` or ``"alpha"`` measured."""
        values = [getattr(group, number) for group in self.groups]
        return min(values), max(values)

    def strength(self, brittleness: float, alpha: float) -> tuple[float, float]:
        """Range of the strength over ``f_t``; see :meth:`energy`."""
        return self._range("strength", brittleness, alpha)

    def energy(self, brittleness: float, alpha: float) -> tuple[float, float]:
        """Range of the dissipated energy over section and ``G_t``.

        From the least mean less its standard deviation to the largest mean plus its own, among all shapes. Both ends
        are multiplied by what brittleness and `alpha` do to the mean of one shape, interpolated over their logarithms;
        beyond what was measured the nearest value counts.
        """
        return self._range("energy", brittleness, alpha)

    def contact(self, strength: float, energy: float, E: float, alpha: float, l_f: float) -> tuple[float, float]:
        """Tensile strength and fracture energy of contacts that give these of the material as a whole.

        They are such that the wanted values lie in the middle of the ranges of :meth:`strength` and :meth:`energy`,
        whose factors depend on ``l_t / l_f`` and with it on what is looked for: a fixed point.

        Parameters
        ----------
        strength : float
            Direct tensile strength of the whole [Pa].
        energy : float
            Fracture energy of the whole [J/m^2], over the section.
        E : float
            Normal modulus of the contacts [Pa].
        alpha : float
            Of the contacts.
        l_f : float
            Size of the bodies [m].

        Returns
        -------
        f_t, G_t : float
            Constants of the contacts [Pa], [J/m^2].

        Examples
        --------
        >>> f_t, G_t = macroscopic_tension().contact(3.0e6, 100.0, 60e9, 0.29, 0.01)
        >>> f"{f_t / 1e6:.2f} MPa, {G_t:.0f} J/m^2"
        '2.60 MPa, 52 J/m^2'
        """
        f_t, G_t = strength, energy
        for _ in range(limits.MOST_ROUNDS):
            before = f_t, G_t
            brittleness = 2.0 * E * G_t / f_t**2 / l_f
            f_t = 2.0 * strength / sum(self.strength(brittleness, alpha))
            G_t = 2.0 * energy / sum(self.energy(brittleness, alpha))
            if (f_t, G_t) == before:
                break
        return f_t, G_t

    def _range(self, quantity: str, brittleness: float, alpha: float) -> tuple[float, float]:
        factor = self._factor(quantity, "brittleness", brittleness) * self._factor(quantity, "alpha", alpha)
        pairs = [(getattr(group, quantity), getattr(group, f"{quantity}_std")) for group in self.shapes]
        return factor * min(mean - std for mean, std in pairs), factor * max(mean + std for mean, std in pairs)

    def _factor(self, quantity: str, number: str, x: float) -> float:
        """Mean for a brittleness or `alpha` over that of the same shape with the usual one."""
        first = self.groups[0]
        others = [g for g in self.groups if getattr(g, number) != getattr(first, number)]
        same = next(g for g in self.shapes if (g.width, g.length) == (others[0].width, others[0].length))
        points = sorted(
            (math.log(getattr(g, number)), getattr(g, quantity) / getattr(same, quantity)) for g in (same, *others)
        )
        place = min(max(math.log(x), points[0][0]), points[-1][0])
        for (a, low), (b, high) in pairwise(points):
            if place <= b:
                return float(low + (high - low) * (place - a) / (b - a))
        raise AssertionError("a place between the ends")


@cache
def macroscopic_tension() -> MacroscopicTension:
    """The numbers that the package brings along."""
    lines = (files("fissura.elasticity") / "macroscopic_tension.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines if line[:1].isdigit()]
    groups = []
    for row in rows:
        width, length, brittleness, alpha, prisms, *found = map(float, row)
        groups.append(Prisms(width, length, brittleness, alpha, int(prisms), *found))
    return MacroscopicTension(tuple(groups))
