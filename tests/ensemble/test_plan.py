"""Seeds, strata and tasks of an ensemble."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtr

from fissura.case import Case
from fissura.ensemble.plan import Plan
from fissura.errors import InputError

Build = Callable[..., Case]


@given(master=st.integers(0, 2**62), few=st.integers(1, 20), more=st.integers(1, 100))
def test_a_realisation_is_the_same_however_many_there_are(tiny: Build, master: int, few: int, more: int) -> None:
    case = tiny()
    short, long = (Plan(case, runs, "both", master=master) for runs in (few, few + more))
    assert [short.run(k) for k in range(1, few + 1)] == [long.run(k) for k in range(1, few + 1)]


def test_all_seeds_differ_and_no_reader_loses_a_digit(tiny: Build) -> None:
    plan = Plan(tiny(), 500, "both", master=3)
    seeds = [seed for k in range(1, 501) for seed in plan.seeds(k)]
    assert len(set(seeds)) == 1000
    assert all(seed is not None and 0 <= seed < 10**15 for seed in seeds)
    other = Plan(tiny(), 1, "both", master=4)
    assert not set(other.seeds(1)) & set(seeds)


def test_modes_vary_what_they_say(tiny: Build) -> None:
    case = tiny(seed=5)
    geometry, field, both = (Plan(case, 3, mode, master=1) for mode in ("geometry", "field", "both"))
    for k in (1, 2, 3):
        assert geometry.run(k).case.field is None
        assert geometry.run(k).case.seed == both.run(k).case.seed != 5
        assert field.run(k).case.seed == 5
        assert field.run(k).case.field == both.run(k).case.field
    assert field.run(1).case.field != field.run(2).case.field


def test_companions_have_the_same_nuclei_and_no_field(tiny: Build) -> None:
    case = tiny(seed=5)
    each = list(Plan(case, 3, "both", companions="each").tasks())
    assert [task.key for task in each] == [(kind, k) for k in (1, 2, 3) for kind in ("companion", "run")]
    for companion, run in zip(each[::2], each[1::2], strict=True):
        assert companion.case.seed == run.case.seed
        assert companion.case.field is None
        assert run.case.field is not None
    # In mode "field" all have the nuclei of the case, so one companion is that of each.
    for mode, companions in (("both", "one"), ("field", "one"), ("field", "each"), ("geometry", "one")):
        first, *rest = Plan(case, 3, mode, companions=companions).tasks()
        assert (first.key, first.case.seed, first.case.field) == (("companion", 0), 5, None)
        assert [task.key for task in rest] == [("run", k) for k in (1, 2, 3)]
    assert [task.kind for task in Plan(case, 3, "both", companions="none").tasks()] == ["run"] * 3


@given(runs=st.integers(1, 60), modes=st.integers(1, 6), master=st.integers(0, 1000))
def test_latin_hypercube_has_one_value_in_every_stratum_of_every_mode(
    tiny: Build, runs: int, modes: int, master: int
) -> None:
    plan = Plan(tiny(), runs, "both", "latin-hypercube", master, leading_modes=modes)
    strata = np.floor(ndtr(plan.leading) * runs).astype(int)
    assert strata.shape == (runs, modes)
    np.testing.assert_array_equal(np.sort(strata, axis=0), np.arange(runs)[:, None] * np.ones(modes, dtype=int))
    assert [plan.run(k).case.field.leading for k in (1, runs)] == [tuple(plan.leading[k]) for k in (0, -1)]
    again = Plan(tiny(), runs, "both", "latin-hypercube", master, leading_modes=modes)
    np.testing.assert_array_equal(again.leading, plan.leading)


def test_monte_carlo_gives_no_leading_values(tiny: Build) -> None:
    assert Plan(tiny(), 3, "field").run(2).case.field.leading == ()


def test_only_what_is_kept_writes_more_than_its_curve(tiny: Build) -> None:
    case = tiny(output__vtk=4)
    assert Plan(case, 1).run(1).case.output.vtk == 0
    assert Plan(case, 1, keep=True).run(1).case.output.vtk == 4


WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"field": None}, {"mode": "both"}, "--mode"),
    ({"field": None}, {"mode": "field"}, "--mode"),
    ({}, {"mode": "geometry", "sampling": "latin-hypercube"}, "--sampling"),
    ({}, {"mode": "geometry", "companions": "each"}, "--companions"),
    ({}, {"mode": "all"}, "--mode"),
    ({}, {"sampling": "sobol"}, "--sampling"),
    ({}, {"companions": "two"}, "--companions"),
    ({}, {"runs": 0}, "--runs"),
    ({}, {"runs": 2.5}, "--runs"),
    ({}, {"runs": 100_000_000}, "--runs"),
    (
        {},
        {"runs": 100_000, "leading_modes": 101, "mode": "field", "sampling": "latin-hypercube"},
        "--leading-modes",
    ),
    ({}, {"master": -1}, "--seed"),
    ({}, {"leading_modes": 0}, "--leading-modes"),
]


@pytest.mark.parametrize(("changes", "arguments", "key"), WRONG)
def test_what_does_not_fit_together_is_refused(
    tiny: Build, changes: dict[str, Any], arguments: dict[str, Any], key: str
) -> None:
    with pytest.raises(InputError) as caught:
        Plan(**{"case": tiny(**changes), "runs": 2, **arguments})
    assert caught.value.key == key
    assert caught.value.allowed


def test_given_nuclei_cannot_be_placed_anew(tiny: Build, tmp_path: Any) -> None:
    nuclei = tmp_path / "nuclei.csv"
    nuclei.write_text("0.01,0.01,0.005\n")
    case = tiny(discretization__nuclei=str(nuclei))
    with pytest.raises(InputError, match=r"discretization\.nuclei"):
        Plan(case, 2, "both")
    assert Plan(case, 2, "field").run(1).case.discretization.nuclei == nuclei
