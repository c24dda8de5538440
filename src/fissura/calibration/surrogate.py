"""Curves as functions of the unknowns, fitted to the runs: what the search works on instead of runs.

The load of seed ``s`` at a point of the curve is ``a_s + B (t - c) + 1/2 (t - c) Q (t - c)`` at coordinates ``t``:
each seed has its own level, all share slopes and curvatures. So a seed that was run at some points only still tells
slopes, and the scatter between seeds is kept apart from them. Slopes and curvatures have Gaussian priors (ridge), so
that a few runs suffice; runs near the centre count most.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray

#: Standard deviations of the priors, loads over their peak, coordinates as they are: slopes and curvatures.
_SLOPE, _CURVATURE = 3.0, 0.7

#: Noise of a run beside the smooth dependence, over the peak: at least, and at first. Runs farther than this from the
#: centre count less.
_LEAST_NOISE, _NOISE, _NEAR = 0.003, 0.01, 0.4


@dataclass(frozen=True)
class Samples:
    """Runs of one test.

    Attributes
    ----------
    coordinates : (k, m) array
        Of the unknowns.
    seed : (k,) array
        Number of the seed, from 0.
    loads : (k, n) array
        Loads at the points [N]; nan where a run did not get to.
    """

    coordinates: FloatArray
    seed: IntArray
    loads: FloatArray

    @classmethod
    def none(cls, unknowns: int, points: int) -> Samples:
        """No runs."""
        return cls(np.empty((0, unknowns)), np.empty(0, dtype=np.int64), np.empty((0, points)))

    def joined(self, other: Samples) -> Samples:
        """These runs and others."""
        return Samples(
            np.concatenate([self.coordinates, other.coordinates]),
            np.concatenate([self.seed, other.seed]),
            np.concatenate([self.loads, other.loads]),
        )

    def chosen(self, rows: BoolArray, points: BoolArray) -> Samples:
        """Some of the runs, at some of the points."""
        return Samples(self.coordinates[rows], self.seed[rows], self.loads[np.ix_(rows, points)])

    def mean_at(self, coordinates: FloatArray) -> FloatArray:
        """Mean loads of the runs at coordinates, shape (n,) [N]."""
        here = (np.abs(self.coordinates - coordinates) < 1e-12).all(axis=1)
        return np.asarray(self.loads[here].mean(axis=0))


@dataclass(frozen=True)
class Surrogate:
    """Loads of one test as a function of the coordinates.

    Attributes
    ----------
    centre : (m,) array
    levels : (seeds, n) array
        Loads of each seed at the centre [N].
    slopes : (m, n) array
        [N per coordinate].
    curvatures : (m, m, n) array
        [N per coordinate squared].
    noise : float
        Standard deviation of what is left of the runs, over the peak.
    """

    centre: FloatArray
    levels: FloatArray
    slopes: FloatArray
    curvatures: FloatArray
    noise: float

    def mean(self, coordinates: FloatArray) -> FloatArray:
        """Mean load over the seeds, shape (n,) [N]."""
        d = coordinates - self.centre
        return np.asarray(
            self.levels.mean(axis=0) + d @ self.slopes + 0.5 * np.einsum("i,j,ijn", d, d, self.curvatures)
        )

    def jacobian(self, coordinates: FloatArray) -> FloatArray:
        """Derivative of the load, shape (n, m) [N per coordinate]."""
        d = coordinates - self.centre
        return np.asarray((self.slopes + np.einsum("j,ijn->in", d, self.curvatures)).T)

    @property
    def scatter(self) -> FloatArray:
        """How far each seed is from the mean, shape (seeds, n) [N]."""
        return np.asarray(self.levels - self.levels.mean(axis=0))


def fitted(samples: Samples, centre: FloatArray, peak: float) -> Surrogate:
    """Fit a surrogate around a centre.

    Parameters
    ----------
    samples : Samples
        Runs without gaps.
    centre : (m,) array
        Coordinates near which it is to be good.
    peak : float
        Load by which noise and priors are told [N].
    """
    found = _fitted(samples, centre, peak, _NOISE)
    return _fitted(samples, centre, peak, max(found.noise, _LEAST_NOISE))


def _fitted(samples: Samples, centre: FloatArray, peak: float, noise: float) -> Surrogate:
    d = samples.coordinates - centre
    m = d.shape[1]
    pairs = list(combinations_with_replacement(range(m), 2))
    squares = np.stack([d[:, i] * d[:, j] * (0.5 if i == j else 1.0) for i, j in pairs], axis=1)
    seeds = np.unique(samples.seed)
    own = (samples.seed[:, None] == seeds[None, :]).astype(np.float64)
    basis = np.concatenate([own, d, squares], axis=1)
    weights = 1.0 / (1.0 + (np.linalg.norm(d, axis=1) / _NEAR) ** 4)
    prior = np.concatenate([np.zeros(len(seeds)), np.full(m, _SLOPE**-2.0), np.full(len(pairs), _CURVATURE**-2.0)])
    normal = basis.T @ (weights[:, None] * basis) + noise**2 * np.diag(prior)
    loads = samples.loads / peak
    solution = np.linalg.solve(normal, basis.T @ (weights[:, None] * loads))
    left = loads - basis @ solution
    freedom = max(weights.sum() - len(seeds) - m, 1.0)
    spread = float(np.sqrt((weights[:, None] * left**2).sum() / freedom / loads.shape[1]))
    curvatures = np.empty((m, m, loads.shape[1]))
    for (i, j), row in zip(pairs, solution[len(seeds) + m :], strict=True):
        curvatures[i, j] = curvatures[j, i] = row * peak
    return Surrogate(
        centre, solution[: len(seeds)] * peak, solution[len(seeds) : len(seeds) + m] * peak, curvatures, spread
    )
