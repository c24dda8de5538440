"""Standard errors from the scatter of random structures.

The unknowns that explain measured loads best move by ``A r`` when these loads move by ``r``: ``A`` is the
pseudo-inverse of the derivative of the computed loads (weighted least squares). A specimen with another random
structure has other loads, all along its curve, and ``A`` turns these into other unknowns. So no covariance of points of
a curve is needed: each seed gives one shift of the unknowns, and the scatter of these shifts is that of the unknowns as
found from one specimen. The mean of ``S`` seeds and that of ``n`` measured specimens are off by it over the roots of
``S`` and ``n``.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from fissura.arrays import FloatArray
from fissura.calibration.observed import Observed
from fissura.calibration.problem import Problem
from fissura.calibration.surrogate import Surrogate

SURE = 0.95
"""Probability of the intervals that are told."""


@dataclass(frozen=True)
class Uncertainty:
    """How sure estimates are.

    Attributes
    ----------
    covariance : (m, m) array
        Of the coordinates of the unknowns.
    simulated, measured : (m,) array
        Variances that the mean of the seeds and that of the specimens contribute.
    freedom : int
        Degrees of freedom: intervals are by Student's t with so many.
    singular : (m,) array
        Singular values of the derivative with columns scaled to length 1, descending: a small one means that some
        unknowns cannot be told apart.
    strength : (m,) array
        Root mean square of the derivative of the loads by each coordinate, over the peak.
    """

    covariance: FloatArray
    simulated: FloatArray
    measured: FloatArray
    freedom: int
    singular: FloatArray
    strength: FloatArray

    @property
    def errors(self) -> FloatArray:
        """Standard errors of the coordinates, shape (m,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def factor(self) -> float:
        """Half width of an interval over the standard error."""
        return float(student.ppf(0.5 + 0.5 * SURE, self.freedom))

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the estimates, shape (m, m)."""
        errors = self.errors
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.where(np.eye(len(errors)) > 0, 1.0, self.covariance / np.outer(errors, errors)))


def residuals(problem: Problem, tests: Sequence[Observed], loads: Sequence[FloatArray]) -> FloatArray:
    """Measured minus computed loads of all tests, weighted: the sum of their squares is what is made least.

    Each test counts by its weight, whatever the number of its points; its loads are over its measured peak, and points
    where a band is narrow count more.
    """
    parts = [
        scale * (test.load - load) for scale, test, load in zip(_scales(problem, tests), tests, loads, strict=True)
    ]
    return np.concatenate(parts)


def weighted_jacobian(
    problem: Problem, tests: Sequence[Observed], surrogates: Sequence[Surrogate], at: FloatArray
) -> FloatArray:
    """Derivative of the weighted computed loads, shape (points of all tests, m)."""
    scales = _scales(problem, tests)
    return np.concatenate([scale[:, None] * of.jacobian(at) for scale, of in zip(scales, surrogates, strict=True)])


def _scales(problem: Problem, tests: Sequence[Observed]) -> list[FloatArray]:
    """Factors of the loads at the points of each test, shape (n,)."""
    return [
        np.sqrt(test.weight / len(of.x)) / of.peak * of.emphasis for test, of in zip(problem.tests, tests, strict=True)
    ]


def uncertainty(
    problem: Problem, tests: Sequence[Observed], surrogates: Sequence[Surrogate], at: FloatArray
) -> Uncertainty:
    """Covariance of the estimate at some coordinates.

    Parameters
    ----------
    problem : Problem
    tests : sequence of Observed
        What was measured, at the points that are compared.
    surrogates : sequence of Surrogate
        Of the tests, with at least two seeds.
    at : (m,) array
        The estimate.
    """
    jacobian = weighted_jacobian(problem, tests, surrogates, at)
    lengths: FloatArray = np.sqrt((jacobian**2).sum(axis=0))
    strength = lengths / np.sqrt(sum(test.weight for test in problem.tests))
    scaled = jacobian / np.where(lengths > 0.0, lengths, 1.0)
    singular = np.asarray(np.linalg.svd(scaled, compute_uv=False), dtype=np.float64)
    inverse = np.linalg.pinv(jacobian)
    ends = np.cumsum([len(of.x) for of in tests])[:-1]
    seeds = len(surrogates[0].levels)
    of_simulated = np.zeros((seeds, len(at)))
    measured = np.zeros((len(at), len(at)))
    freedom = seeds - 1
    for test, of, scale, surrogate, part in zip(
        problem.tests, tests, _scales(problem, tests), surrogates, np.split(inverse, ends, axis=1), strict=True
    ):
        shifts = scale * surrogate.scatter @ part.T
        of_simulated += shifts
        one, more = _one_specimen(of, scale, part, shifts)
        measured += one / test.specimens
        freedom += more
    simulated = of_simulated.T @ of_simulated / (seeds - 1) / seeds
    return Uncertainty(simulated + measured, np.diag(simulated), np.diag(measured), freedom, singular, strength)


def _one_specimen(of: Observed, scale: FloatArray, part: FloatArray, shifts: FloatArray) -> tuple[FloatArray, int]:
    """Covariance of the unknowns as found from one measured specimen, and further degrees of freedom.

    Several curves tell it together with the seeds, pooled. A band tells how far specimens are apart, not along which
    curves: besides what the seeds tell, each specimen is taken to be off by a share of the band's width, the same all
    along its curve.
    """
    squares, count = shifts.T @ shifts, len(shifts) - 1
    n = len(of.curves)
    if n > 1:
        own = scale * (of.curves - of.load) @ part.T
        return (squares + own.T @ own) / (count + n - 1), n - 1
    together = part @ (scale * of.deviation)
    return squares / count + np.outer(together, together), 0
