"""Gaussian distribution with a Weibull lower tail grafted on.

Source: Z. P. Bažant, J.-L. Le, *Probabilistic Mechanics of Quasibrittle Structures*, Cambridge 2017; S.-D. Pang,
Z. P. Bažant, J.-L. Le, Int. J. Fract. 154 (2008) 131-145.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import brentq
from scipy.special import gamma, gammainc, log_ndtr, ndtri_exp

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.material.field import limits
from fissura.material.field.normal import ROOT_2_PI, hazard


@dataclass(frozen=True)
class Grafted:
    """``F = 1 - exp(-(h/scale)^shape)`` up to the graft, a Gaussian core above it.

    The core is scaled so that ``F`` reaches 1, and placed so that the density has no jump at the graft.

    Attributes
    ----------
    shape, scale : float
        Of the Weibull tail.
    probability, point : float
        ``F`` at the graft, and where that is.
    mean, deviation : float
        Of the Gaussian core.
    """

    shape: float
    scale: float
    probability: float
    point: float
    mean: float
    deviation: float

    @classmethod
    def create(cls, cov: float, shape: float = 24.0, graft: float = 1e-3) -> Self:
        """Solve for mean 1 and the given coefficient of variation of the whole distribution.

        With ``a`` the graft in deviations of the core from its centre, a continuous density means
        ``shape L / point = hazard(a) / deviation``, ``L = -log(1 - graft)``. This leaves one unknown, ``a``, for the
        scatter, and a common scale for the mean.

        Raises
        ------
        InputError
            A shape or a grafting probability that is not possible, or a scatter that they do not allow.
        """
        if shape <= 1.0:
            raise InputError("field.shape", f"{shape:g} is not possible", "a number above 1")
        if not limits.GRAFTED[0] <= graft <= limits.GRAFTED[1]:
            raise InputError(
                "field.graft", f"{graft:g} is not possible", "a probability, {:g} to {:g}".format(*limits.GRAFTED)
            )
        log_kept = -float(np.log1p(-graft))

        def moments(a: float) -> tuple[float, float, float]:
            """Mean, mean square, and position of the graft, in deviations of the core."""
            rate = hazard(a)
            point = shape * log_kept / rate
            scale, centre = point * log_kept ** (-1.0 / shape), point - a
            tail = [
                scale**n * gamma(1.0 + n / shape) * gammainc(1.0 + n / shape, log_kept)  # integrals of h^n dF
                for n in (1, 2)
            ]
            first = tail[0] + (1.0 - graft) * (centre + rate)
            second = tail[1] + (1.0 - graft) * (centre**2 + 2.0 * centre * rate + 1.0 + a * rate)
            return first, second, point

        def scatter(a: float) -> float:
            first, second, _ = moments(a)
            return float(np.sqrt(max(second / first**2 - 1.0, 0.0)))

        low, high = limits.GRAFTS
        if not scatter(low) < cov < scatter(high):
            raise InputError(
                "field.cov",
                f"{cov:g} is not possible with a Weibull tail of shape {shape:g} grafted at {graft:g}",
                f"above {scatter(low):.2g} and below {scatter(high):.2g}",
            )
        a = brentq(lambda a: scatter(a) - cov, low, high, xtol=1e-14, rtol=1e-14)
        first, _, point = moments(a)
        deviation = 1.0 / first
        point *= deviation
        return cls(shape, point * log_kept ** (-1.0 / shape), graft, point, point - a * deviation, deviation)

    @property
    def _log_core(self) -> float:
        """Logarithm of the factor on the Gaussian core, without its deviation."""
        a = (self.point - self.mean) / self.deviation
        return float(np.log1p(-self.probability) - log_ndtr(-a))

    def from_gaussian(self, z: FloatArray) -> FloatArray:
        """``F^-1(Phi(z))``, the same shape."""
        log_survival = log_ndtr(-z)
        tail = self.scale * (-log_survival) ** (1.0 / self.shape)
        core = self.mean - self.deviation * ndtri_exp(np.minimum(log_survival - self._log_core, 0.0))
        return np.where(log_ndtr(z) <= np.log(self.probability), tail, core)

    def log_cdf(self, h: FloatArray) -> FloatArray:
        """Logarithm of ``F(h)``."""
        with np.errstate(divide="ignore"):
            tail = np.log(-np.expm1(-((np.minimum(h, self.point) / self.scale) ** self.shape)))
        survival = np.exp(self._log_core + log_ndtr((self.mean - np.maximum(h, self.point)) / self.deviation))
        return np.where(h <= self.point, tail, np.log1p(-np.minimum(survival, 1.0 - self.probability)))

    def pdf(self, h: FloatArray) -> FloatArray:
        """Density."""
        t = (np.minimum(h, self.point) / self.scale) ** self.shape
        u = (np.maximum(h, self.point) - self.mean) / self.deviation
        core = np.exp(self._log_core - 0.5 * u * u) / (ROOT_2_PI * self.deviation)
        return np.where(h <= self.point, self.shape / h * t * np.exp(-t), core)
