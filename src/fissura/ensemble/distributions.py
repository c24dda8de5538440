"""Gaussian and Weibull distributions fitted by maximum likelihood, with exact confidence bounds.

Both are location-scale families: the Gaussian in the values, the two-parameter Weibull in their logarithms, which
follow the distribution of smallest extremes. For estimates ``a, b`` of location and scale, ``(a - location)/b`` and
``b/scale`` then have distributions that depend on the sample's size only (pivots; Thoman, Bain, Antle 1969; Lawless
2003, chapter 5). So a parametric bootstrap of standard samples gives bounds whose coverage is exact up to the
bootstrap's own noise, for small samples, too.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri

from fissura.arrays import FloatArray

BOOTSTRAPS = 4000
"""Standard samples for bounds: their 5 % points are then known within about 0.35 %."""


def _gaussian(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    return values.mean(axis=-1), values.std(axis=-1)


def _smallest_extreme(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Location and scale of smallest extremes for samples in rows, by Newton's method on ``k = 1/scale``.

    The likelihood's derivative ``mean_w(y) - mean(y) - 1/k``, with weights ``w = exp(k y)``, grows with ``k``.
    """
    top = values.max(axis=-1, keepdims=True)
    y = values - top
    mean = y.mean(axis=-1)
    k = math.pi / math.sqrt(6.0) / np.maximum(y.std(axis=-1), 1e-300)
    for _ in range(60):
        weights = np.exp(k[..., None] * y)
        total = weights.sum(axis=-1)
        weighted = (weights * y).sum(axis=-1) / total
        variance = (weights * (y - weighted[..., None]) ** 2).sum(axis=-1) / total
        new = k - (weighted - mean - 1.0 / k) / (variance + 1.0 / k**2)
        new = np.clip(new, k / 3.0, 3.0 * k)
        done = np.abs(new - k) <= 1e-13 * k
        k = new
        if done.all():
            break
    location = np.log(np.exp(k[..., None] * y).mean(axis=-1)) / k + top[..., 0]
    return location, 1.0 / k


@dataclass(frozen=True)
class Family:
    """A location-scale family, perhaps of a transform of the values.

    Attributes
    ----------
    name : str
        Its name.
    parameters : (str, str)
        Names of its two parameters.
    transform, back : callable
        From values to what has location and scale, and back.
    estimate : callable
        Maximum likelihood location and scale of samples in rows.
    standard, log_standard : callable
        Distribution function for location 0 and scale 1, and the logarithms of it and of its complement.
    quantile : callable
        Its inverse.
    """

    name: str
    parameters: tuple[str, str]
    transform: Callable[[FloatArray], FloatArray]
    back: Callable[[FloatArray], FloatArray]
    estimate: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    standard: Callable[[FloatArray], FloatArray]
    log_standard: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    quantile: Callable[[FloatArray], FloatArray]


def _extreme_quantile(p: FloatArray) -> FloatArray:
    return np.asarray(np.log(-np.log1p(-p)))


def _same(values: FloatArray) -> FloatArray:
    return values


GAUSSIAN = Family(
    "Gaussian",
    ("mean", "standard deviation"),
    _same,
    _same,
    _gaussian,
    lambda z: np.asarray(ndtr(z)),
    lambda z: (np.asarray(log_ndtr(z)), np.asarray(log_ndtr(-z))),
    lambda p: np.asarray(ndtri(p)),
)
WEIBULL = Family(
    "Weibull",
    ("scale", "shape"),
    lambda values: np.asarray(np.log(values)),
    lambda y: np.asarray(np.exp(y)),
    _smallest_extreme,
    lambda z: np.asarray(-np.expm1(-np.exp(z))),
    lambda z: (np.log(np.maximum(-np.expm1(-np.exp(z)), 1e-300)), -np.exp(z)),
    _extreme_quantile,
)
FAMILIES = (GAUSSIAN, WEIBULL)


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted distribution and what is known about it.

    Attributes
    ----------
    family : Family
        Which.
    n : int
        Number of values.
    location, scale : float
        Of the transformed values, by maximum likelihood.
    confidence : float
        Level of the bounds, for example 0.9.
    pivots : (2, b) array
        ``(a - location)/b`` and ``b/scale`` of standard samples.
    anderson_darling, p_value : float
        Statistic of Anderson and Darling, and the probability of a larger one if the family is right; from the same
        samples, so that the parameters' being fitted is accounted for.
    """

    family: Family
    n: int
    location: float
    scale: float
    confidence: float
    pivots: FloatArray
    anderson_darling: float
    p_value: float

    @property
    def parameters(self) -> dict[str, tuple[float, float, float]]:
        """Parameters with lower and upper bound: mean and standard deviation; scale and shape for Weibull."""
        tail = (1.0 - self.confidence) / 2.0
        low, high = np.quantile(self.pivots[0], [1.0 - tail, tail])
        location = (self.location, self.location - self.scale * low, self.location - self.scale * high)
        small, large = self.scale / np.quantile(self.pivots[1], [1.0 - tail, tail])
        first, second = self.family.parameters
        if self.family is WEIBULL:
            return {
                first: (math.exp(location[0]), math.exp(location[1]), math.exp(location[2])),
                second: (1.0 / self.scale, 1.0 / float(large), 1.0 / float(small)),
            }
        return {
            first: (location[0], float(location[1]), float(location[2])),
            second: (self.scale, float(small), float(large)),
        }

    def quantile(self, p: FloatArray) -> FloatArray:
        """Value below which a share ``p`` lies, any shape."""
        return self.family.back(self.location + self.scale * self.family.quantile(np.asarray(p, dtype=np.float64)))

    def bounds(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Confidence bounds of these values, each for itself (not of the whole line at once)."""
        p = np.asarray(p, dtype=np.float64)
        z = self.family.quantile(p)
        # (estimated - true quantile)/b is a pivot, too: that of the location, and (1 - scale/b) z.
        pivot = self.pivots[0] + (1.0 - 1.0 / self.pivots[1]) * z[..., None]
        tail = (1.0 - self.confidence) / 2.0
        low, high = np.quantile(pivot, [1.0 - tail, tail], axis=-1)
        return (
            self.family.back(self.location + self.scale * (z - low)),
            self.family.back(self.location + self.scale * (z - high)),
        )

    def density(self, values: FloatArray) -> FloatArray:
        """Probability density, any shape."""
        x = np.asarray(values, dtype=np.float64)
        if self.family is WEIBULL:
            z = (np.log(x) - self.location) / self.scale
            return np.asarray(np.exp(z - np.exp(z)) / (self.scale * x))
        z = (x - self.location) / self.scale
        return np.asarray(np.exp(-0.5 * z * z) / (math.sqrt(2.0 * math.pi) * self.scale))


def fit(family: Family, values: FloatArray, rng: np.random.Generator, confidence: float = 0.9) -> Fit | None:
    """Fit a distribution by maximum likelihood.

    Parameters
    ----------
    family : Family
        `GAUSSIAN` or `WEIBULL`.
    values : (n,) array
        The sample.
    rng : Generator
        For the bootstrap.
    confidence : float, optional
        Level of all bounds.

    Returns
    -------
    Fit or None
        None if there are fewer than 3 different values, or if some are not positive and the family needs that.
    """
    values = np.sort(np.asarray(values, dtype=np.float64))
    if len(np.unique(values)) < 3 or (family is WEIBULL and values[0] <= 0.0):
        return None
    n, y = len(values), family.transform(values)
    location, scale = (float(v) for v in family.estimate(y))
    standard = np.sort(family.quantile(rng.uniform(np.finfo(float).tiny, 1.0, (BOOTSTRAPS, n))), axis=-1)
    a, b = family.estimate(standard)
    distances = _anderson_darling(family, (standard - a[:, None]) / b[:, None])
    distance = float(_anderson_darling(family, (y - location) / scale))
    return Fit(
        family,
        n,
        location,
        scale,
        confidence,
        # The first pivot is over the estimated scale, as only that is known.
        np.stack([a / b, b]),
        distance,
        float(np.mean(distances >= distance)),
    )


def _anderson_darling(family: Family, z: FloatArray) -> FloatArray:
    """Statistic of standardised samples in ascending rows (Anderson, Darling 1954)."""
    n = z.shape[-1]
    below, above = family.log_standard(z)
    weights = 2.0 * np.arange(1, n + 1) - 1.0
    return np.asarray(-n - ((below + above[..., ::-1]) * weights).sum(axis=-1) / n)


def median_ranks(n: int) -> FloatArray:
    """Plotting positions of ordered values, shape (n,): ``(i - 0.3)/(n + 0.4)`` (Benard, Bos-Levenbach 1953)."""
    return np.asarray((np.arange(1, n + 1) - 0.3) / (n + 0.4))
