"""The search on a cheap model: truths come back, intervals hold as often as they say, what cannot be found is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom

from calibration.synthetic import F_T, G_T, MORE, PLATEAU, TRUE, Laboratory, with_plateau
from fissura.calibration.problem import Unknown
from fissura.calibration.runner import RUNS, RUNS_MORE
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


@pytest.mark.parametrize(
    ("unknowns", "sizes"),
    [((F_T, G_T, MORE[0], PLATEAU[0]), (1.0,)), ((F_T, G_T, MORE[0], *PLATEAU), (1.0, 3.0))],
    ids=["four", "five"],
)
def test_four_and_five_unknowns_are_held_as_often_as_said(
    case: Case, unknowns: tuple[Unknown, ...], sizes: tuple[float, ...]
) -> None:
    count, inside = 40, np.zeros(len(unknowns))
    for k in range(count):
        laboratory = Laboratory(case, np.random.default_rng(k), unknowns, sizes=sizes, formula=with_plateau)
        found = laboratory.search(6, 40 * len(sizes))
        inside += np.abs(off(found, unknowns)) < found.uncertainty.factor
        assert found.runs <= 40 * len(sizes)
    # 95 % of the experiments, within what 40 of them can tell, at a level of a thousandth.
    low, high = binom.ppf([5e-4, 1 - 5e-4], count, 0.95)
    assert ((low <= inside) & (inside <= high)).all()


def test_five_unknowns_settle_within_the_usual_runs(case: Case) -> None:
    unknowns = (F_T, G_T, MORE[0], *PLATEAU)
    laboratory = Laboratory(
        case, np.random.default_rng(1), unknowns, specimens=3, sizes=(1.0, 3.0), formula=with_plateau
    )
    few = laboratory.search(6, 80)
    laboratory.rng = np.random.default_rng(1)
    many = laboratory.search(6, 2 * (RUNS + 2 * RUNS_MORE))
    assert not few.converged  # 40 of each test are too few for that, though the intervals hold
    assert many.converged


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
