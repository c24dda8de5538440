"""Constants of the contacts from those of the material as a whole, and back (theory section 2).

A uniform volumetric strain is in equilibrium in every Voronoi structure, so that ``E_macro = E (1 - 2 nu)`` holds
exactly for bulk averages. What is left to be known is Poisson's ratio as a function of `alpha`. It is tabulated in
``macroscopic_elasticity.csv``, mean values of periodic saturated structures written by
``benchmarks/macroscopic_elasticity.py``, and interpolated over the root of `alpha` by monotone cubics, which err by
less than the table does. A table rather than structures made when they are needed: reading a case must take no time and
give the same constants on every machine.

Cases are read with this module, so that SciPy is imported where it is needed and not before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from typing import TYPE_CHECKING

from fissura.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator


def voigt(alpha: float) -> tuple[float, float]:
    """Voigt's estimate of ``E_macro / E`` and Poisson's ratio: no fluctuations, all directions of contacts alike."""
    return (2.0 + 3.0 * alpha) / (4.0 + alpha), (1.0 - alpha) / (4.0 + alpha)


@dataclass(frozen=True)
class MacroscopicElasticity:
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
    def _curve(self) -> PchipInterpolator:
        """Poisson's ratio over the root of `alpha`; it is monotone, as the table is."""
        from scipy.interpolate import PchipInterpolator  # cases are read without SciPy

        return PchipInterpolator([math.sqrt(alpha) for alpha in self.alpha], self.nu)

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest Poisson's ratio."""
        return self.nu[-1], self.nu[0]

    def _value(self, x: float) -> float:
        """Poisson's ratio at the root of `alpha`, 0 at the end of the table without round-off."""
        return self.nu[-1] if x >= math.sqrt(self.alpha[-1]) else float(self._curve(x))

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
        from scipy.optimize import brentq  # cases are read without SciPy

        low, high = math.sqrt(self.alpha[0]), math.sqrt(self.alpha[-1])
        x = brentq(lambda place: self._value(place) - nu, low, high, xtol=1e-16, rtol=1e-15)
        alpha = self.alpha[-1] if x == high else max(x * x, self.alpha[0])
        return E / (1.0 - 2.0 * nu), alpha

    @property
    def allowed(self) -> str:
        """Which Poisson's ratios there are, in words."""
        least, most = self.range
        return f"a number from {least:g} (alpha = {self.alpha[-1]:g}) to {most:.4g} (alpha = {self.alpha[0]:g})"


@cache
def macroscopic_elasticity() -> MacroscopicElasticity:
    """The law that the package brings along."""
    lines = (files("fissura.case") / "macroscopic_elasticity.csv").read_text(encoding="utf-8").splitlines()
    rows = [tuple(map(float, line.split(","))) for line in lines if line[:1].isdigit()]
    alpha, nu, error = zip(*((row[0], row[1], row[2]) for row in rows), strict=True)
    return MacroscopicElasticity(alpha, nu, error)
