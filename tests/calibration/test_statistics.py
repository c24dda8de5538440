"""Surrogate and standard errors against what they must be on linear models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.calibration.observed import Observed, at_points, observed
from fissura.calibration.problem import Problem, Test, Unknown
from fissura.calibration.surrogate import Samples, Surrogate, fitted
from fissura.calibration.uncertainty import uncertainty
from fissura.case import Case, load_case
from fissura.errors import InputError
from fissura.results.load_path import LoadPath
from fissura.results.measured import MeasuredBand

N = 30


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(Path(__file__).parents[2] / "examples" / "gregoire_d50_halfnotch.toml")


@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(2, 6))
def test_the_surrogate_of_quadratic_curves_is_those_curves(seed: int, m: int, seeds: int) -> None:
    rng = np.random.default_rng(seed)
    levels, slopes = rng.normal(size=(seeds, N)), rng.normal(size=(m, N))
    bent = rng.normal(size=(m, m, N)) * 0.3
    bent = bent + bent.swapaxes(0, 1)
    designs = rng.uniform(-0.4, 0.4, size=(4 * (m + 1) ** 2, m))
    rows = [(d, s) for d in designs for s in range(seeds)]
    loads = [levels[s] + d @ slopes + 0.5 * np.einsum("i,j,ijn", d, d, bent) for d, s in rows]
    samples = Samples(np.array([d for d, _ in rows]), np.array([s for _, s in rows]), 1e3 * np.array(loads))
    found = fitted(samples, np.zeros(m), 1e3)
    at = rng.uniform(-0.3, 0.3, size=m)
    expected = levels.mean(axis=0) + at @ slopes + 0.5 * np.einsum("i,j,ijn", at, at, bent)
    np.testing.assert_allclose(found.mean(at) / 1e3, expected, atol=0.01)  # priors pull by the square of the noise
    np.testing.assert_allclose(found.scatter / 1e3, levels - levels.mean(axis=0), atol=1e-6)
    step = 1e-6 * np.eye(m)
    numeric = np.stack([(found.mean(at + d) - found.mean(at - d)) / 2e-6 for d in step], axis=1)
    np.testing.assert_allclose(found.jacobian(at), numeric, atol=1e-4)


def made(case: Case, rng: np.random.Generator, specimens: int, seeds: int) -> tuple[Problem, Observed, Surrogate]:
    """A linear test with random derivative and scatter, at random points."""
    slopes = rng.normal(size=(2, N))
    mix = rng.normal(size=(3, N)) * 0.1
    measured = rng.normal(size=(specimens, 3)) @ mix
    levels = rng.normal(size=(seeds, 3)) @ mix
    unknowns = tuple(Unknown(name, 1.0, 0.5, 2.0) for name in ("a", "b"))
    test = Test("one", case, (), 1.0, specimens, "gauge")
    x = np.linspace(0.1, 1.0, N)
    low, high = measured.min(axis=0), measured.max(axis=0)
    of = Observed(x, measured.mean(axis=0), measured, low, high, 1.0, np.zeros(N), np.ones(N))
    return Problem("p", unknowns, (test,)), of, Surrogate(np.zeros(2), levels, slopes, np.zeros((2, 2, N)), 0.0)


@given(st.integers(0, 10_000), st.integers(1, 5), st.integers(2, 9))
def test_errors_are_those_of_each_seed_taken_for_a_specimen(case: Case, seed: int, specimens: int, seeds: int) -> None:
    problem, of, surrogate = made(case, np.random.default_rng(seed), specimens, seeds)
    found = uncertainty(problem, (of,), (surrogate,), np.zeros(2))

    def solved(load: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(surrogate.slopes.T, load, rcond=None)[0]

    computed = np.array([solved(load) for load in surrogate.levels])
    measured = np.array([solved(load) for load in of.curves])
    of_seeds = np.cov(computed.T)
    squares = of_seeds * (seeds - 1)
    if specimens > 1:
        squares = squares + np.cov(measured.T) * (specimens - 1)
    one = squares / (seeds - 1 + specimens - 1)
    np.testing.assert_allclose(found.covariance, of_seeds / seeds + one / specimens, rtol=1e-8)
    assert found.freedom == seeds - 1 + specimens - 1
    np.testing.assert_allclose(np.diag(found.correlation), 1.0)


def test_linear_gaussian_experiments_are_covered_as_said(case: Case) -> None:
    rng, inside, count = np.random.default_rng(0), np.zeros(2), 400
    for _ in range(count):
        problem, of, surrogate = made(case, rng, 1, 6)
        found = uncertainty(problem, (of,), (surrogate,), np.zeros(2))
        left = of.load - surrogate.levels.mean(axis=0)  # the truth is 0
        estimate = np.linalg.lstsq(surrogate.slopes.T, left, rcond=None)[0]
        inside += np.abs(estimate) < found.factor * found.errors
    # Exactly 95 % here: 400 experiments tell that to 3.6 % at three standard deviations.
    np.testing.assert_allclose(inside / count, 0.95, atol=3.0 * np.sqrt(0.95 * 0.05 / count))


def test_a_band_is_as_unsure_as_its_width(case: Case) -> None:
    x = np.linspace(1e-6, 1e-4, 100)
    load = 1e3 * x / (x + 2e-5)

    def of(width: float, specimens: int) -> Observed:
        band = MeasuredBand(x, load * (1 - width), load * (1 + width))
        return observed(Test("band", case, (band,), 1.0, specimens, "gauge"))

    wide = of(0.1, 2)
    np.testing.assert_allclose(wide.load, np.interp(wide.x, x, load), rtol=1e-3)
    np.testing.assert_allclose(wide.deviation, 0.2 * wide.load / 1.128, rtol=1e-6)
    assert of(0.1, 5).deviation.mean() == pytest.approx(wide.deviation.mean() * 1.128 / 2.326, rel=1e-6)
    assert np.mean(wide.emphasis**2) == pytest.approx(1.0)
    assert wide.emphasis[0] > wide.emphasis[-1]  # narrow where loads are small


def test_points_are_even_along_the_curve(case: Case) -> None:
    x = np.linspace(0.0, 1e-4, 5000)
    load = np.where(x < 1e-5, x / 1e-5, 1.0 - (x - 1e-5) / 2e-4) * 1e3
    noisy = load + np.random.default_rng(1).normal(size=len(x)) * 5.0
    band = MeasuredBand(x, noisy, noisy)
    found = observed(Test("t", case, (band,), 1.0, 1, "gauge"))
    assert (found.x < 1e-5).sum() > 0.35 * len(found.x)  # a tenth of the gauge, half of the way of the curve
    np.testing.assert_allclose(found.load, np.interp(found.x, x, load), atol=25.0)


def test_a_run_that_snaps_back_counts_where_it_gets_first() -> None:
    path = LoadPath("run", np.array([0.0, 1.0, 2.0, 1.5, 3.0]), np.array([0.0, 4.0, 5.0, 1.0, 2.0]), np.zeros(5))
    np.testing.assert_allclose(at_points(path, np.array([0.5, 2.0, 2.5, 4.0])), [2.0, 5.0, 3.5, np.nan])


def test_what_cannot_be_compared_is_told(case: Case) -> None:
    x = np.linspace(0.0, 1e-4, 50)

    def of(*bands: MeasuredBand, until: float = np.inf) -> Observed:
        return observed(Test("t", case, bands, 1.0, len(bands), "gauge", until))

    with pytest.raises(InputError, match="turns back"):
        of(MeasuredBand(x, x, x, back=5e-5))
    with pytest.raises(InputError, match="nothing to be compared with"):
        of(MeasuredBand(x + 1e-3, x, x))  # the case ends at 0.19 mm
    with pytest.raises(InputError, match="nothing to be compared with"):
        of(MeasuredBand(x, x, x), MeasuredBand(x + 1.1e-4, x, x))
    with pytest.raises(InputError, match="all loads are 0"):
        of(MeasuredBand(x, 0 * x, 0 * x))
    with pytest.raises(InputError, match="points"):
        of(MeasuredBand(x[:2], x[:2], x[:2]))
    assert of(MeasuredBand(x, x, x), until=5e-5).x[-1] == pytest.approx(5e-5)
