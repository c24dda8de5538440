"""The search: which runs come next, and when the unknowns are known well enough.

First the start with all seeds, then a step of each unknown with half of them. From then on
`scipy.optimize.least_squares` finds the best place on the surrogate, not farther than a radius from the best place that
was run; it is run, the surrogate is fitted again, and so on, until the best place on the surrogate is near one that was
run, measured by its standard error.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from fissura.arrays import FloatArray
from fissura.calibration.observed import Observed
from fissura.calibration.problem import Problem
from fissura.calibration.surrogate import Samples, Surrogate, fitted
from fissura.calibration.uncertainty import Uncertainty, residuals, uncertainty, weighted_jacobian
from fissura.errors import InputError

Simulate = Callable[[FloatArray, int], tuple[FloatArray, Sequence[Samples]]]
"""What is called with wanted coordinates, shape (designs, m), and a number of seeds: gives those that were run, and the
runs of every test."""

STEP = 0.1
"""Step of an unknown from which its slope is found: a tenth of its value, or of its range."""

#: Radius of a move at first; part of the standard error of the mean of the seeds below which a move is not worth runs;
#: how far from the first steps slopes are found anew.
_RADIUS, _SMALL, _FAR = 0.5, 0.5, 0.25

#: Sensitivity over the peak below which an unknown does not affect the curve; singular value below which unknowns
#: cannot be told apart.
_WEAK, _SINGULAR = 0.004, 0.03


@dataclass(frozen=True)
class Found:
    """Where a search has ended.

    Attributes
    ----------
    coordinates : (m,) array
        The estimate.
    nearest : (m,) array
        The place with all seeds run that is nearest to it, in standard errors.
    uncertainty : Uncertainty
    tests : tuple of Observed
        What was measured, at the points that were compared.
    samples : tuple of Samples
        All runs of each test, at these points.
    surrogates : tuple of Surrogate
    runs, seeds : int
        Runs of all tests, and seeds of a full round.
    converged : bool
        Whether the last move was small.
    move : float
        What was left to move, in standard errors of the mean of the seeds.
    """

    coordinates: FloatArray
    nearest: FloatArray
    uncertainty: Uncertainty
    tests: tuple[Observed, ...]
    samples: tuple[Samples, ...]
    surrogates: tuple[Surrogate, ...]
    runs: int
    seeds: int
    converged: bool
    move: float


def least_runs(problem: Problem, seeds: int) -> int:
    """Runs of the first two rounds and of one move, of all tests."""
    return len(problem.tests) * (2 * seeds + len(problem.unknowns) * few(seeds))


def few(seeds: int) -> int:
    """Seeds with which slopes are found: differences between runs of the same seed scatter little."""
    return max(2, seeds // 2)


def search(problem: Problem, tests: Sequence[Observed], simulate: Simulate, seeds: int, most: int) -> Found:
    """Find the unknowns.

    Parameters
    ----------
    problem : Problem
    tests : sequence of Observed
    simulate : callable
        Computes runs.
    seeds : int
        Seeds, at least 2.
    most : int
        Runs at most, of all tests together.

    Raises
    ------
    InputError
        An unknown does not affect the curves, or some cannot be told apart.
    """
    state = _Search(problem, tuple(tests), simulate, seeds, most)
    best = sloped = state.run(problem.start[None, :], seeds)[0]
    state.run(_steps(problem, best), few(seeds))
    _check_sensitivity(problem, state.fit(best).uncertainty)
    radius = _RADIUS
    while True:
        found = state.fit(best)
        target = state.best_near(found, best, radius)
        sure = uncertainty(problem, found.tests, found.surrogates, target)
        found = replace(found, coordinates=target, uncertainty=sure)
        move = _move(found, target - best)
        far = float(np.linalg.norm(best - sloped)) > _FAR
        if move < _SMALL and far and state.affords(few(seeds) * len(problem.unknowns)):
            state.run(_steps(problem, best), few(seeds))
            sloped = best
            continue
        converged = move < _SMALL
        if converged or not state.affords(seeds):
            _check_sensitivity(problem, found.uncertainty)
            return replace(found, nearest=best, converged=converged, move=move)
        target = state.run(target[None, :], seeds)[0]
        if state.cost(target) < state.cost(best):
            best = target
        else:
            radius = 0.5 * min(radius, float(np.abs(target - best).max()))


def _steps(problem: Problem, centre: FloatArray) -> FloatArray:
    """A step of each unknown, inside its bounds."""
    lower, upper = problem.bounds
    found = np.repeat(centre[None, :], len(centre), axis=0)
    for k in range(len(centre)):
        up = centre[k] + STEP <= upper[k] or upper[k] - centre[k] >= centre[k] - lower[k]
        found[k, k] = min(centre[k] + STEP, upper[k]) if up else max(centre[k] - STEP, lower[k])
    return found


def _move(found: Found, way: FloatArray) -> float:
    """Length of a way in standard errors of the mean of the seeds, the largest over the unknowns."""
    errors = np.sqrt(found.uncertainty.simulated)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmax(np.where(way == 0.0, 0.0, np.abs(way) / np.maximum(errors, 1e-4))))


class _Search:
    """What was run so far.

    Parameters
    ----------
    problem, tests, simulate, seeds, most
        As of `search`.
    """

    def __init__(
        self, problem: Problem, tests: tuple[Observed, ...], simulate: Simulate, seeds: int, most: int
    ) -> None:
        self.problem, self.tests, self.simulate, self.seeds, self.most = problem, tests, simulate, seeds, most
        self.samples = tuple(Samples.none(len(problem.unknowns), len(test.x)) for test in tests)
        self.runs = 0

    def affords(self, runs: int) -> bool:
        """Whether so many more runs of each test are allowed."""
        return self.runs + runs * len(self.tests) <= self.most

    def run(self, designs: FloatArray, seeds: int) -> FloatArray:
        """Compute designs and keep what came out; the designs that were run."""
        used, new = self.simulate(designs, seeds)
        self.samples = tuple(old.joined(more) for old, more in zip(self.samples, new, strict=True))
        self.runs += len(used) * seeds * len(self.tests)
        return used

    def fit(self, centre: FloatArray) -> Found:
        """Surrogates around a centre, and how sure its coordinates are."""
        tests, samples = compared(self.problem, self.tests, self.samples)
        surrogates = tuple(fitted(of, centre, test.peak) for of, test in zip(samples, tests, strict=True))
        sure = uncertainty(self.problem, tests, surrogates, centre)
        return Found(centre, centre, sure, tests, samples, surrogates, self.runs, self.seeds, False, np.inf)

    def best_near(self, found: Found, centre: FloatArray, radius: float) -> FloatArray:
        """The best place on the surrogate, not farther than a radius from the centre in any coordinate."""
        lower, upper = self.problem.bounds
        low, high = np.maximum(lower, centre - radius), np.minimum(upper, centre + radius)
        width = np.maximum(high - low, 1e-12)

        def left(at: FloatArray) -> FloatArray:
            return residuals(self.problem, found.tests, [of.mean(at) for of in found.surrogates])

        def slope(at: FloatArray) -> FloatArray:
            return -weighted_jacobian(self.problem, found.tests, found.surrogates, at)

        start = np.clip(centre, low + 1e-6 * width, high - 1e-6 * width)
        solution = least_squares(left, start, slope, bounds=(low, low + width), xtol=1e-10, ftol=1e-12, gtol=1e-12)
        return np.asarray(np.clip(solution.x, lower, upper))

    def cost(self, at: FloatArray) -> float:
        """Sum of the squared weighted residuals of the mean curves that were run at a place."""
        tests, samples = compared(self.problem, self.tests, self.samples)
        left = residuals(self.problem, tests, [of.mean_at(at) for of in samples])
        return float(left @ left)


def compared(
    problem: Problem, tests: Sequence[Observed], samples: Sequence[Samples]
) -> tuple[tuple[Observed, ...], tuple[Samples, ...]]:
    """Tests and runs at the points that runs got to.

    A seed of which any run has no more than half of the points is left out everywhere; then the points count that all
    runs got to.

    Raises
    ------
    InputError
        Fewer than two seeds, or too few points, are left.
    """
    bad = {int(seed) for of in samples for seed in of.seed[np.isfinite(of.loads).mean(axis=1) <= 0.5]}
    out_tests, out_samples = [], []
    for test, of, named in zip(tests, samples, problem.tests, strict=True):
        rows = np.asarray(~np.isin(of.seed, list(bad)))
        if len(np.unique(of.seed[rows])) < 2:
            raise InputError(
                f"test {named.name}",
                "fewer than two seeds have curves over half of the measured range",
                "a control.target as large as the measured range, and no stop_load; runs.csv tells how runs ended",
            )
        points = np.asarray(np.isfinite(of.loads[rows]).all(axis=0))
        out_samples.append(of.chosen(rows, points))
        names = ("x", "load", "lower", "upper", "deviation", "emphasis")
        at = {name: getattr(test, name)[points] for name in names}
        out_tests.append(replace(test, **at, curves=test.curves[:, points]))
    return tuple(out_tests), tuple(out_samples)


def _check_sensitivity(problem: Problem, sure: Uncertainty) -> None:
    """Refuse unknowns that the curves say nothing about.

    Raises
    ------
    InputError
        There is one, or some cannot be told apart.
    """
    for unknown, strength in zip(problem.unknowns, sure.strength.tolist(), strict=True):
        if strength < _WEAK:
            raise InputError(
                f"unknown {unknown.key}",
                f"does not affect the curves: they change by {100 * strength * STEP:.2g} % of the peak for a step of"
                f" {100 * STEP:.0f} %",
                "unknowns that the measured curves depend on",
            )
    if sure.singular[-1] < _SINGULAR * sure.singular[0] and len(problem.unknowns) > 1:
        names = ", ".join(unknown.key for unknown in problem.unknowns)
        raise InputError(
            "unknowns",
            f"{names} cannot be told apart: some change of all of them together leaves the curves as they are",
            "fewer unknowns, or further tests (other sizes, other notches) whose curves depend on them otherwise",
        )
