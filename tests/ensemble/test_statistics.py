"""Fits, bounds, convergence and the mean curve, against what is known exactly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from fissura.ensemble.band import band
from fissura.ensemble.convergence import convergence, cov_interval
from fissura.ensemble.distributions import FAMILIES, GAUSSIAN, WEIBULL, Family, fit, median_ranks
from fissura.ensemble.statistics import statistics
from fissura.ensemble.table import table
from fissura.results.load_path import LoadPath

FloatArray = NDArray[np.float64]

#: A distribution of each family that scipy draws from.
TRUE: dict[str, Any] = {"Gaussian": stats.norm(800.0, 80.0), "Weibull": stats.weibull_min(12.0, scale=800.0)}
PARAMETERS = {"Gaussian": (800.0, 80.0), "Weibull": (800.0, 12.0)}


def sample(family: Family, n: int, rng: np.random.Generator) -> FloatArray:
    return np.asarray(TRUE[family.name].rvs(n, random_state=rng))


@given(shape=st.floats(0.5, 60.0), scale=st.floats(1e-6, 1e6), n=st.integers(3, 60), seed=st.integers(0, 10**6))
def test_weibull_fit_is_the_maximum_of_the_likelihood(shape: float, scale: float, n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = scale * rng.weibull(shape, n)
    y = np.log(x)
    location, b = WEIBULL.estimate(y)
    k, s = 1.0 / b, np.exp(location)
    # Both derivatives of the logarithm of the likelihood vanish.
    z = (x / s) ** k
    assert z.mean() == pytest.approx(1.0, rel=1e-8)
    assert (z * np.log(x / s)).sum() - np.log(x / s).sum() == pytest.approx(n / k, rel=1e-6)


def test_fits_are_those_of_scipy() -> None:
    rng = np.random.default_rng(2)
    x = sample(WEIBULL, 40, rng)
    shape, _, scale = stats.weibull_min.fit(x, floc=0.0)
    found = fit(WEIBULL, x, rng)
    assert found is not None
    assert [v[0] for v in found.parameters.values()] == pytest.approx([scale, shape], rel=1e-5)
    normal = fit(GAUSSIAN, x, rng)
    assert normal is not None
    assert [v[0] for v in normal.parameters.values()] == pytest.approx(stats.norm.fit(x))


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_large_samples_recover_the_parameters(family: Family) -> None:
    found = fit(family, sample(family, 800, np.random.default_rng(4)), np.random.default_rng(5))
    assert found is not None
    for (value, low, high), true in zip(found.parameters.values(), PARAMETERS[family.name], strict=True):
        assert low < value < high
        assert value == pytest.approx(true, rel=0.08)
        assert 0.9 * true < low
        assert high < 1.1 * true


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_density_quantile_and_scipy_agree(family: Family) -> None:
    found = fit(family, sample(family, 30, np.random.default_rng(6)), np.random.default_rng(7))
    assert found is not None
    first, second = (v[0] for v in found.parameters.values())
    same: Any = stats.norm(first, second) if family is GAUSSIAN else stats.weibull_min(second, scale=first)
    p = np.array([0.001, 0.3, 0.5, 0.999])
    np.testing.assert_allclose(found.quantile(p), same.ppf(p), rtol=1e-10)
    np.testing.assert_allclose(found.density(found.quantile(p)), same.pdf(same.ppf(p)), rtol=1e-8)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_bounds_cover_as_often_as_they_say(family: Family) -> None:
    # Coverage is exact for pivots. Of 200 samples, 90 % +- 6.4 % is three standard deviations; samples of 8 are small.
    rng = np.random.default_rng(8)
    p = np.array([0.01, 0.5])
    true = TRUE[family.name].ppf(p)
    hits, parameters, rejected = np.zeros(2), np.zeros(2), 0
    for _ in range(200):
        found = fit(family, sample(family, 8, rng), rng)
        assert found is not None
        low, high = found.bounds(p)
        hits += (low < true) & (true < high)
        parameters += [
            low < value < high
            for (_, low, high), value in zip(found.parameters.values(), PARAMETERS[family.name], strict=True)
        ]
        rejected += found.p_value < 0.1
    assert np.abs(np.append(hits, parameters) / 200 - 0.9).max() < 0.064
    assert abs(rejected / 200 - 0.1) < 0.064


def test_anderson_darling_tells_the_families_apart() -> None:
    rng = np.random.default_rng(9)
    x = np.exp(rng.normal(0.0, 0.8, 200))
    assert all((found := fit(family, x, rng)) is not None and found.p_value < 0.01 for family in FAMILIES)


def test_what_cannot_be_fitted_is_not() -> None:
    rng = np.random.default_rng(1)
    assert fit(GAUSSIAN, np.array([1.0, 2.0]), rng) is None
    assert fit(GAUSSIAN, np.array([2.0, 2.0, 2.0, 2.0]), rng) is None
    assert fit(WEIBULL, np.array([-1.0, 2.0, 3.0]), rng) is None


def test_fits_are_the_same_twice() -> None:
    x = sample(WEIBULL, 12, np.random.default_rng(3))
    first, second = (fit(WEIBULL, x, np.random.default_rng(1)) for _ in range(2))
    assert first is not None
    assert second is not None
    assert first.parameters == second.parameters


def test_median_ranks_are_symmetric() -> None:
    ranks = median_ranks(7)
    np.testing.assert_allclose(ranks + ranks[::-1], 1.0)
    assert median_ranks(1) == pytest.approx([0.5])


@given(st.lists(st.floats(1.0, 1e6), min_size=2, max_size=30))
def test_convergence_ends_at_the_sample(values: list[float]) -> None:
    x = np.array(values)
    found = convergence(x)
    np.testing.assert_allclose(found.mean[-1, 0], x.mean(), rtol=1e-12)
    np.testing.assert_allclose(found.cov[-1, 0], x.std(ddof=1) / x.mean(), rtol=1e-6, atol=1e-7)
    half = stats.t.ppf(0.975, len(x) - 1) * x.std(ddof=1) / np.sqrt(len(x))
    np.testing.assert_allclose(found.mean[-1, 1:], [x.mean() - half, x.mean() + half], atol=1e-6 * x.mean())


def test_the_interval_of_the_cov_covers() -> None:
    rng = np.random.default_rng(10)
    x = rng.normal(1.0, 0.15, (4000, 12))
    cov = x.std(axis=1, ddof=1) / x.mean(axis=1)
    low, high = cov_interval(np.full(4000, 12), cov, 0.95)
    assert np.mean((low < 0.15) & (high > 0.15)) == pytest.approx(0.95, abs=0.012)


def test_convergence_of_nothing_is_empty() -> None:
    for values in ([], [3.0]):
        assert len(convergence(np.array(values)).n) == 0


def path(gauge: Any, load: Any, energy: Any) -> LoadPath:
    return LoadPath("a run", *(np.append(0.0, np.asarray(values, dtype=float)) for values in (gauge, load, energy)))


def test_the_band_of_equal_curves_is_the_curve() -> None:
    one = path([1.0, 2.0, 4.0], [3.0, 5.0, 1.0], [0.0, 1.0, 3.0])
    found = band([one, one, one])
    assert found is not None
    assert found.over == "gauge"
    assert found.whole.all()
    for line in (found.mean, *found.percentiles):
        np.testing.assert_allclose(line, np.interp(found.abscissa, one.value, one.load), atol=1e-12)


def test_a_curve_that_ends_early_counts_up_to_its_end_only() -> None:
    long, short = path([4.0], [4.0], [1.0]), path([1.0], [3.0], [1.0])
    found = band([short, long, long])
    assert found is not None
    assert found.abscissa[-1] == 4.0
    np.testing.assert_array_equal(found.count, np.where(found.abscissa <= 1.0, 3, 2))
    np.testing.assert_allclose(found.mean[found.abscissa <= 1.0][-1], (3.0 + 1.0 + 1.0) / 3.0)
    np.testing.assert_allclose(found.mean[~found.whole], found.abscissa[~found.whole])


def test_the_band_ends_where_half_of_the_runs_have_ended() -> None:
    found = band([path([end], [1.0], [1.0]) for end in (1.0, 2.0, 3.0, 4.0)])
    assert found is not None
    assert found.abscissa[-1] == 2.0
    assert found.count[-1] == 3


def test_runs_that_snap_back_are_averaged_over_energy() -> None:
    back = path([1.0, 2.0, 1.5], [2.0, 3.0, 1.0], [0.0, 1.0, 2.0])
    found = band([back, path([1.0, 2.0, 3.0], [2.0, 3.0, 1.0], [0.0, 1.0, 2.0])])
    assert found is not None
    assert found.over == "dissipated energy"
    np.testing.assert_allclose(found.mean, np.interp(found.abscissa, [0.0, 1.0, 2.0], [2.0, 3.0, 1.0]))
    np.testing.assert_allclose(found.value, np.interp(found.abscissa, [0.0, 1.0, 2.0], [1.0, 2.0, 2.25]))
    assert band([back, path([1.0], [1.0], [0.0])]) is None
    assert band([]) is None


def summaries(statuses: str, ends: Callable[[int], float]) -> list[dict[str, Any]]:
    names = {"f": "finished", "s": "stopped", "x": "failed"}
    found = []
    for k, letter in enumerate(statuses):
        about = {"kind": "run", "number": k + 1, "load_at_end_N": ends(k)}
        summary: dict[str, Any] = {"status": names[letter], "realisation": about, "dissipated_energy_J": 1.0 + k}
        found.append(summary | ({} if letter == "x" else {"peak_load_N": 100.0 + k}))
    return found


def test_peaks_count_of_runs_that_finished_or_are_past_them() -> None:
    # Runs 3 and 4 stopped, one of them past its peak; run 5 left nothing.
    found = statistics(table(summaries("ffssx", lambda k: 50.0 if k == 2 else 99.0)), 1)
    assert found.numbers.tolist() == [1, 2, 3]
    assert found.peaks.tolist() == [100.0, 101.0, 102.0]
    assert found.rows["peak_load_N"]["n"] == 3
    assert found.rows["dissipated_energy_J"]["n"] == 2
    assert found.rows["dissipated_energy_J"]["mean"] == 1.5


def test_negative_peaks_count_by_their_magnitude() -> None:
    plus, minus = (summaries("ffssx", lambda k, sign=sign: sign * (50.0 if k == 2 else 99.0)) for sign in (1.0, -1.0))
    minus = [summary | {"peak_load_N": -summary.get("peak_load_N", np.nan)} for summary in minus]
    rows = table(minus)
    assert rows["peak_load_N"][:2].tolist() == [-100.0, -101.0]
    assert rows["past_peak"].tolist() == table(plus)["past_peak"].tolist() == [False, False, True, False, False]
    assert statistics(rows, 1).as_dict() == statistics(table(plus), 1).as_dict()


def test_statistics_of_nothing_are_nothing() -> None:
    for runs in ("", "x", "xx"):
        found = statistics(table(summaries(runs, lambda k: 0.0)), 1)
        assert (len(found.peaks), found.fits) == (0, {})
        assert found.as_dict()["counted"] == 0
