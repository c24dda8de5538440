"""Constants of the contacts from those of the material as a whole, and back (theory section 2).

A uniform volumetric strain is in equilibrium in every Voronoi structure, so that ``E_macro = E (1 - 2 nu)`` holds
exactly for bulk averages. What is left to be known is Poisson's ratio as a function of `alpha`. It is tabulated in
``bulk_elasticity.csv``, mean values of periodic saturated structures written by ``benchmarks/bulk_elasticity.py``, and
interpolated over the root of `alpha` by monotone cubics, which err by less than the table does. A table rather than
structures made when they are needed: reading a case must take no time and give the same constants on every machine.

This module needs nothing but the standard library, since cases are read with it.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from itertools import pairwise

from fissura.errors import InputError

__all__ = ["BulkLaw", "bulk_law", "voigt"]


def voigt(alpha: float) -> tuple[float, float]:
    """Voigt's estimate of ``E_macro / E`` and Poisson's ratio: no fluctuations, all directions of contacts alike."""
    return (2.0 + 3.0 * alpha) / (4.0 + alpha), (1.0 - alpha) / (4.0 + alpha)


def _slopes(x: tuple[float, ...], y: tuple[float, ...]) -> tuple[float, ...]:
    """Slopes with which cubics between the points are monotone where the points are (Fritsch & Butland 1984)."""
    width = [b - a for a, b in pairwise(x)]
    steep = [(b - a) / w for (a, b), w in zip(pairwise(y), width, strict=True)]
    inner = []
    for (w, v), (d, e) in zip(pairwise(width), pairwise(steep), strict=True):
        inner.append(3.0 * (w + v) / ((w + 2.0 * v) / d + (2.0 * w + v) / e) if d * e > 0.0 else 0.0)

    def end(w: float, v: float, d: float, e: float) -> float:
        slope = ((2.0 * w + v) * d - w * e) / (w + v)
        if slope * d <= 0.0:
            return 0.0
        return 3.0 * d if d * e <= 0.0 and abs(slope) > 3.0 * abs(d) else slope

    return (end(*width[:2], *steep[:2]), *inner, end(*width[:-3:-1], *steep[:-3:-1]))


@dataclass(frozen=True)
class BulkLaw:
    """Poisson's ratio as a function of `alpha`, tabulated.

    Attributes
    ----------
    alpha : tuple of float
        Ascending, the last one 1.
    nu : tuple of float
        Poisson's ratios there, descending to 0.
    error : tuple of float
        Their standard errors.
    """

    alpha: tuple[float, ...]
    nu: tuple[float, ...]
    error: tuple[float, ...]

    @cached_property
    def _curve(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        x = tuple(map(math.sqrt, self.alpha))
        return x, _slopes(x, self.nu)

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest Poisson's ratio."""
        return self.nu[-1], self.nu[0]

    def _value(self, x: float) -> float:
        """Poisson's ratio at the root of `alpha`."""
        places, slopes = self._curve
        k = min(max(bisect_right(places, x) - 1, 0), len(places) - 2)
        width = places[k + 1] - places[k]
        t = (x - places[k]) / width
        s = 1.0 - t
        low = s * s * ((1.0 + 2.0 * t) * self.nu[k] + t * width * slopes[k])
        return low + t * t * ((1.0 + 2.0 * s) * self.nu[k + 1] - s * width * slopes[k + 1])

    def macroscopic(self, E: float, alpha: float) -> tuple[float, float]:
        """Modulus of elasticity [Pa] and Poisson's ratio of the bulk.

        Parameters
        ----------
        E : float
            Normal modulus of the contacts [Pa].
        alpha : float
            Their tangential over normal stiffness, at most 1.

        Raises
        ------
        InputError
            An `alpha` below the table, or above 1.
        """
        if not self.alpha[0] <= alpha <= self.alpha[-1]:
            raise InputError("alpha", f"{alpha:g} is outside the table", f"{self.alpha[0]:g} to {self.alpha[-1]:g}")
        nu = self._value(math.sqrt(alpha))
        return E * (1.0 - 2.0 * nu), nu

    def contact(self, E: float, nu: float) -> tuple[float, float]:
        """Normal modulus of the contacts [Pa] and `alpha`, the inverse of :meth:`macroscopic` to round-off.

        Parameters
        ----------
        E : float
            Modulus of elasticity of the bulk [Pa].
        nu : float
            Its Poisson's ratio.

        Raises
        ------
        InputError
            A modulus that is not positive, or a Poisson's ratio that no `alpha` gives.
        """
        if not 0.0 < E < math.inf:
            raise InputError("E", f"{E:g} Pa is not possible", "a stress, positive")
        least, most = self.range
        if not least <= nu <= most:
            raise InputError("nu", f"{nu:g} cannot be reached", self.allowed)
        low, high = self._curve[0][0], self._curve[0][-1]
        while True:
            x = 0.5 * (low + high)
            if not low < x < high:
                break
            low, high = (x, high) if self._value(x) > nu else (low, x)
        # Of two neighbouring numbers the one that comes closer; both ends of the table are met exactly.
        x = min((low, high), key=lambda place: abs(self._value(place) - nu))
        alpha = self.alpha[-1] if x == self._curve[0][-1] else max(x * x, self.alpha[0])
        return E / (1.0 - 2.0 * nu), alpha

    @property
    def allowed(self) -> str:
        """Which Poisson's ratios there are, in words."""
        least, most = self.range
        return f"a number from {least:g} (alpha = {self.alpha[-1]:g}) to {most:.4g} (alpha = {self.alpha[0]:g})"


@cache
def bulk_law() -> BulkLaw:
    """The law that the package brings along."""
    lines = (files("fissura") / "bulk_elasticity.csv").read_text(encoding="utf-8").splitlines()
    rows = [tuple(map(float, line.split(","))) for line in lines if line[:1].isdigit()]
    alpha, nu, error = zip(*((row[0], row[1], row[2]) for row in rows), strict=True)
    return BulkLaw(alpha, nu, error)
