"""How sure the mean and the scatter of an ensemble are, and how that grows with the number of runs."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, stdtrit

from fissura.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Convergence:
    """Mean and coefficient of variation of the first ``n`` values.

    Attributes
    ----------
    n : (k,) array
        2, 3, ...
    mean, cov : (k, 3) array
        Estimate, lower and upper confidence bound.
    """

    n: IntArray
    mean: FloatArray
    cov: FloatArray


def convergence(values: FloatArray, confidence: float = 0.95) -> Convergence:
    """Running mean and coefficient of variation.

    Parameters
    ----------
    values : (n,) array
        In order of the number of the realisation. The order in which runs happen to end would not do: quick runs, which
        come first, may be the weak ones.
    confidence : float, optional
        Level of the intervals.
    """
    values = np.asarray(values, dtype=np.float64)
    n = np.arange(2, len(values) + 1)
    mean = (np.cumsum(values) / np.arange(1, len(values) + 1))[1:]
    # Sums of squares about the last mean lose no digits when the scatter is small.
    about = values - values.mean() if len(values) else values
    squares, sums = np.cumsum(about**2)[1:], np.cumsum(about)[1:]
    deviation = np.sqrt(np.maximum(squares - sums**2 / n, 0.0) / (n - 1))
    cov = np.divide(deviation, np.abs(mean), out=np.full(len(n), np.nan), where=mean != 0.0)
    return Convergence(
        n,
        np.stack([mean, *mean_interval(n, mean, deviation, confidence)], axis=-1),
        np.stack([cov, *cov_interval(n, cov, confidence)], axis=-1),
    )


def mean_interval(
    n: IntArray, mean: FloatArray, deviation: FloatArray, confidence: float
) -> tuple[FloatArray, FloatArray]:
    """Confidence interval of the mean by Student's t.

    Parameters
    ----------
    n : array
        Numbers of values, at least 2.
    mean, deviation : array
        Their means and standard deviations (with ``n - 1``).
    confidence : float
        Level.
    """
    half = stdtrit(n - 1.0, 0.5 + confidence / 2.0) * deviation / np.sqrt(n)
    return mean - half, mean + half


def cov_interval(n: IntArray, cov: FloatArray, confidence: float) -> tuple[FloatArray, FloatArray]:
    """Confidence interval of a coefficient of variation (Vangel 1996, modified McKay).

    It is for Gaussian populations and coefficients below about 0.33. The upper bound is infinite where there is none.

    Parameters
    ----------
    n : array
        Numbers of values, at least 2.
    cov : array
        Sample coefficients of variation.
    confidence : float
        Level.
    """
    v, tail = n - 1.0, (1.0 - confidence) / 2.0
    bounds = []
    for part in (tail, 1.0 - tail):
        u = chdtri(v, part)
        inside = ((u + 2.0) / n - 1.0) * cov**2 + u / v
        bounds.append(np.where(inside > 0.0, cov / np.sqrt(np.where(inside > 0.0, inside, 1.0)), np.inf))
    return bounds[0], bounds[1]
