"""Numbers and arrays of NumPy stand wherever numbers and lists may."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fissura import Case, InputError
from fissura.case.types import whole
from fissura.ensemble.plan import Plan
from fissura.running.run import with_seed


def test_a_case_of_numpy_is_the_same_case(small_case: Callable[..., Case]) -> None:
    plain = {
        "seed": 7,
        "specimen__size": [0.12, 0.06, 0.04],
        "load__direction": [0, -1, 0],
        "supports__0__point": [0.01, 0, 0.02],
        "supports__0__at": None,
        "material__E": 60000000000,
        "adaptivity__notch_tips": True,
        "control__max_iterations": 20,
        "control__target": 1e-4,
        "field": {"length": [0.05, 0.06, 0.07], "leading": [0.5, -1.0], "seed": 3},
    }
    numpy: dict[str, Any] = {
        "seed": np.int64(7),
        "specimen__size": np.array([0.12, 0.06, 0.04]),
        "load__direction": np.array([0, -1, 0]),
        "supports__0__point": np.array([0.01, 0, 0.02]),
        "supports__0__at": None,
        "material__E": np.int64(60000000000),
        "adaptivity__notch_tips": np.bool_(True),
        "control__max_iterations": np.array(20),
        "control__target": np.array(1e-4),
        "field": {"length": np.array([0.05, 0.06, 0.07]), "leading": np.array([0.5, -1.0]), "seed": np.int32(3)},
    }
    case = small_case(**numpy)
    assert case == small_case(**plain)
    assert json.loads(case.model_dump_json()) == json.loads(small_case(**plain).model_dump_json())
    assert type(case.seed) is int


@pytest.mark.parametrize("value", [True, np.bool_(True), 1.0, np.float64(1.0), "1", None, np.ones(1)])
def test_what_is_no_whole_number(value: Any) -> None:
    assert whole(value) is None


def test_seeds_from_python_may_be_of_numpy(small_case: Callable[..., Case]) -> None:
    case = small_case()
    assert type(with_seed(case, np.int64(5)).seed) is int
    assert with_seed(case, np.int64(5)) == with_seed(case, 5)
    for wrong in (np.int64(-1), np.float64(5.0), np.bool_(True), 2**63):
        with pytest.raises(InputError, match="seed"):
            with_seed(case, wrong)


def test_an_ensemble_takes_them_too(small_case: Callable[..., Case]) -> None:
    case = small_case()
    plan = Plan(case, np.int64(4), master=np.uint16(9))
    assert plan == Plan(case, 4, master=9)
    assert (type(plan.runs), type(plan.master)) == (int, int)
    assert [task.case.seed for task in plan.tasks()] == [task.case.seed for task in Plan(case, 4, master=9).tasks()]
