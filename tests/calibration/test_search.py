"""The search on a cheap model: truths come back, intervals hold as often as they say, what cannot be found is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom

from calibration.synthetic import F_T, G_T, MORE, TRUE, Laboratory
from fissura.calibration.problem import Unknown
from fissura.calibration.search import Found
from fissura.case import Case, load_case
from fissura.errors import InputError


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(Path(__file__).parents[2] / "examples" / "gregoire_d50_halfnotch.toml")


def off(found: Found, unknowns: tuple[Unknown, ...]) -> np.ndarray:
    """Differences from the truth, in standard errors."""
    true = np.array([unknown.coordinate(TRUE[unknown.key]) for unknown in unknowns])
    return np.asarray((found.coordinates - true) / found.uncertainty.errors)


@pytest.mark.parametrize(("specimens", "seeds"), [(1, 6), (3, 6), (2, 4)])
def test_intervals_hold_the_truth_as_often_as_they_say(case: Case, specimens: int, seeds: int) -> None:
    count, inside, runs = 60, np.zeros(2), []
    for k in range(count):
        found = Laboratory(case, np.random.default_rng(k), specimens=specimens).search(seeds)
        inside += np.abs(off(found, (F_T, G_T))) < found.uncertainty.factor
        runs.append(found.runs)
    # 95 % of the experiments, within what 60 of them can tell, at a level of a thousandth.
    low, high = binom.ppf([5e-4, 1 - 5e-4], count, 0.95)
    assert ((low <= inside) & (inside <= high)).all()
    assert max(runs) <= 40


def test_without_scatter_the_truth_itself_comes_back(case: Case) -> None:
    laboratory = Laboratory(case, np.random.default_rng(1), scatter=(1e-5, 1e-5, 1e-5), noise=0.0)
    found = laboratory.search(2, 60)
    values = [unknown.value(at) for unknown, at in zip((F_T, G_T), found.coordinates, strict=True)]
    assert values == pytest.approx([TRUE["material.f_t"], TRUE["material.G_t"]], rel=2e-3)
    assert laboratory.calls[:3] == [(1, 2), (2, 2), (1, 2)]
    assert found.runs == sum(designs * seeds for designs, seeds in laboratory.calls)


def test_four_unknowns_from_two_sizes(case: Case) -> None:
    unknowns = (F_T, G_T, *MORE)
    laboratory = Laboratory(case, np.random.default_rng(2), unknowns, specimens=3, sizes=(1.0, 4.0))
    # Energy and friction move the tail likewise here, in every size: that is told.
    with pytest.raises(InputError, match="cannot be told apart"):
        laboratory.search(6, 160)
    three = Laboratory(case, np.random.default_rng(2), unknowns[:3], specimens=3, sizes=(1.0, 4.0))
    found = three.search(6, 160)
    assert (np.abs(off(found, unknowns[:3])) < 1.5 * found.uncertainty.factor).all()
    assert found.runs <= 160


def test_more_specimens_and_more_seeds_make_it_surer(case: Case) -> None:
    def error(specimens: int, seeds: int) -> Any:
        found = [
            Laboratory(case, np.random.default_rng(k), specimens=specimens).search(seeds, 400).uncertainty
            for k in range(12)
        ]
        parts = [(one.simulated, one.measured) for one in found]
        return np.mean(parts, axis=0)

    few, many = error(1, 4), error(9, 16)
    assert np.all(many[0] < 0.5 * few[0])  # a quarter, but for the chance of some seeds
    assert np.all(many[1] < 0.3 * few[1])  # a ninth


def test_an_unknown_without_effect_is_named(case: Case) -> None:
    unknowns = (F_T, Unknown("material.n_c", 2.0, 1.0, 4.0))
    with pytest.raises(InputError, match=r"unknown material\.n_c: does not affect the curves"):
        Laboratory(case, np.random.default_rng(1), unknowns, noise=0.0).search()


def test_the_search_ends_at_its_bounds_and_at_its_most_runs(case: Case) -> None:
    low = Unknown("material.f_t", 1.2e6, 0.8e6, 1.6e6)
    found = Laboratory(case, np.random.default_rng(1), (low, G_T)).search()
    assert found.coordinates[0] == pytest.approx(np.log(1.6e6), abs=1e-6)
    far = (Unknown("material.f_t", 0.5e6, 0.1e6, 20e6), G_T)
    found = Laboratory(case, np.random.default_rng(1), far).search(6, 18)
    assert found.runs == 18
    assert not found.converged
    assert found.move > 1.0
