"""Marginal distributions of a field: positive numbers with mean 1 and a given coefficient of variation.

Each turns a standard Gaussian value into its own, ``H = F^-1(Phi(z))``, through logarithms of probabilities, so that
both tails keep their digits however far out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np
from scipy.optimize import brentq
from scipy.special import gammaln, log_ndtr, ndtri_exp

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.material.field import limits
from fissura.material.field.grafted import Grafted
from fissura.material.field.normal import ROOT_2_PI, hazard


class Marginal(Protocol):
    """What a field asks of its marginal distribution."""

    def from_gaussian(self, z: FloatArray) -> FloatArray:
        """``F^-1(Phi(z))``, the same shape."""
        ...

    def log_cdf(self, h: FloatArray) -> FloatArray:
        """Logarithm of ``F(h)``, for h > 0."""
        ...

    def pdf(self, h: FloatArray) -> FloatArray:
        """Density at h > 0."""
        ...


def _log1mexp(y: FloatArray) -> FloatArray:
    """``log(1 - exp(y))`` for y <= 0."""
    with np.errstate(divide="ignore"):
        out: FloatArray = np.where(y > -0.6931, np.log(-np.expm1(y)), np.log1p(-np.exp(y)))
    return out


@dataclass(frozen=True)
class Gaussian:
    """Gaussian truncated at a positive bound, below which there is nothing.

    Attributes
    ----------
    mean, deviation : float
        Of the Gaussian before truncation.
    lower : float
        The bound.
    """

    mean: float
    deviation: float
    lower: float

    @classmethod
    def create(cls, cov: float, lower: float = 0.1) -> Self:
        """Solve for mean 1 and the given coefficient of variation after truncation.

        Raises
        ------
        InputError
            A bound that is not between 0 and 1, or a scatter that is too large above it.
        """
        if not 0.0 < lower < 1.0:
            raise InputError("field.lower", f"{lower:g} is not between 0 and the mean, 1", "a number above 0, below 1")

        def ratio(a: float) -> float:
            """Deviation over the distance of the mean from the bound, truncated a deviations above the centre."""
            rate = hazard(a)
            return float(np.sqrt(1.0 + a * rate - rate * rate) / (rate - a))

        wanted = cov / (1.0 - lower)
        if wanted >= ratio(limits.FAR):
            raise InputError(
                "field.cov",
                f"{cov:g} is too large for a Gaussian truncated at {lower:g}",
                f"below {ratio(limits.FAR) * (1.0 - lower):.3g}, or a smaller field.lower",
            )
        a = brentq(lambda a: ratio(a) - wanted, -1.0 / wanted - 1.0, limits.FAR, xtol=1e-15, rtol=1e-14)
        deviation = (1.0 - lower) / (hazard(a) - a)
        return cls(lower - a * deviation, deviation, lower)

    @property
    def _cut(self) -> float:
        return (self.lower - self.mean) / self.deviation

    def from_gaussian(self, z: FloatArray) -> FloatArray:
        """``F^-1(Phi(z))``, the same shape."""
        # The probability of more than H is Phi(-z) of what the bound leaves: the upper half is taken from above.
        kept = log_ndtr(-self._cut)
        above = -ndtri_exp(log_ndtr(-z) + kept)
        below = ndtri_exp(np.logaddexp(log_ndtr(self._cut), log_ndtr(z) + kept))
        return np.maximum(self.mean + self.deviation * np.where(z > 0.0, above, below), self.lower)

    def log_cdf(self, h: FloatArray) -> FloatArray:
        """Logarithm of ``F(h)``."""
        survival = log_ndtr((self.mean - h) / self.deviation) - log_ndtr(-self._cut)
        return _log1mexp(np.minimum(survival, 0.0))

    def pdf(self, h: FloatArray) -> FloatArray:
        """Density."""
        u = (h - self.mean) / self.deviation
        density = np.exp(-0.5 * u * u - log_ndtr(-self._cut)) / (ROOT_2_PI * self.deviation)
        return np.where(h < self.lower, 0.0, density)


@dataclass(frozen=True)
class Lognormal:
    """Lognormal distribution.

    Attributes
    ----------
    mean, deviation : float
        Of its logarithm.
    """

    mean: float
    deviation: float

    @classmethod
    def create(cls, cov: float) -> Self:
        """With mean 1 and the given coefficient of variation."""
        variance = float(np.log1p(cov * cov))
        return cls(-0.5 * variance, float(np.sqrt(variance)))

    def from_gaussian(self, z: FloatArray) -> FloatArray:
        """``F^-1(Phi(z))``, the same shape."""
        out: FloatArray = np.exp(self.mean + self.deviation * z)
        return out

    def log_cdf(self, h: FloatArray) -> FloatArray:
        """Logarithm of ``F(h)``."""
        out: FloatArray = log_ndtr((np.log(h) - self.mean) / self.deviation)
        return out

    def pdf(self, h: FloatArray) -> FloatArray:
        """Density."""
        u = (np.log(h) - self.mean) / self.deviation
        out: FloatArray = np.exp(-0.5 * u * u) / (ROOT_2_PI * self.deviation * h)
        return out


@dataclass(frozen=True)
class Weibull:
    """Weibull distribution, ``F = 1 - exp(-(h/scale)^shape)``.

    Attributes
    ----------
    shape, scale : float
        Its parameters.
    """

    shape: float
    scale: float

    @classmethod
    def create(cls, cov: float) -> Self:
        """With mean 1 and the given coefficient of variation, for which the shape is solved.

        Raises
        ------
        InputError
            A scatter out of bounds.
        """
        if not limits.WEIBULL[0] <= cov <= limits.WEIBULL[1]:
            raise InputError(
                "field.cov", f"{cov:g} is not possible", "{:g} to {:g} for Weibull".format(*limits.WEIBULL)
            )
        wanted = float(np.log1p(cov * cov))
        # log E[h^2] - 2 log E[h] at the inverse of the shape.
        inverse = brentq(
            lambda q: gammaln(1.0 + 2.0 * q) - 2.0 * gammaln(1.0 + q) - wanted, 0.0009, 2.01, xtol=1e-16, rtol=1e-14
        )
        return cls(1.0 / inverse, float(np.exp(-gammaln(1.0 + inverse))))

    def from_gaussian(self, z: FloatArray) -> FloatArray:
        """``F^-1(Phi(z))``, the same shape."""
        out: FloatArray = self.scale * (-log_ndtr(-z)) ** (1.0 / self.shape)
        return out

    def log_cdf(self, h: FloatArray) -> FloatArray:
        """Logarithm of ``F(h)``."""
        return _log1mexp(-((h / self.scale) ** self.shape))

    def pdf(self, h: FloatArray) -> FloatArray:
        """Density."""
        t = (h / self.scale) ** self.shape
        out: FloatArray = self.shape / h * t * np.exp(-t)
        return out


#: Marginal distributions by the name that a case file gives: what makes them, and the parameters that it takes.
MARGINALS: dict[str, tuple[Callable[..., Marginal], tuple[str, ...]]] = {
    "grafted": (Grafted.create, ("shape", "graft")),
    "gaussian": (Gaussian.create, ("lower",)),
    "lognormal": (Lognormal.create, ()),
    "weibull": (Weibull.create, ()),
}


def marginal_named(name: str, cov: float, key: str = "field", **parameters: float | None) -> Marginal:
    """The marginal distribution of a case.

    Parameters
    ----------
    name : str
        Key of `MARGINALS`.
    cov : float
        Coefficient of variation.
    key : str, optional
        Table of the case file, for messages.
    **parameters : float or None
        Further parameters by their keys; None where the case does not give one.

    Raises
    ------
    InputError
        Unknown name, a parameter that this distribution does not have, or a value that is not possible.
    """
    if name not in MARGINALS:
        raise InputError(f"{key}.marginal", f"{name!r} is not known", ", ".join(sorted(MARGINALS)))
    create, known = MARGINALS[name]
    given: dict[str, Any] = {item: value for item, value in parameters.items() if value is not None}
    for item in given:
        if item not in known:
            owners = " or ".join(f'"{other}"' for other, (_, its) in MARGINALS.items() if item in its)
            raise InputError(f"{key}.{item}", f"the {name} distribution has none", f"only with marginal = {owners}")
    try:
        return create(cov, **given)
    except InputError as error:
        raise InputError(error.key.replace("field", key, 1), error.problem, error.allowed) from None
