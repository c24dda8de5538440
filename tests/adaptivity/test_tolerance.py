"""Parameters chosen by a tolerance, and the bound of the error."""

from __future__ import annotations

import itertools
import json
import math

import pytest

from fissura.adaptivity import load_error_bound
from fissura.case import case_from_dict
from fissura.case.adaptivity import LEVELS
from fissura.errors import InputError
from fissura.results.curve import columns, row
from fissura.results.summary import build_summary
from results.synthetic import simulation, step


def test_levels_go_from_coarse_to_fine():
    assert [level.tolerance for level in LEVELS] == sorted((level.tolerance for level in LEVELS), reverse=True)
    for coarse, fine in itertools.pairwise(LEVELS):
        assert coarse.gamma >= fine.gamma
        assert coarse.r_f <= fine.r_f
        assert coarse.ramp <= fine.ramp


@pytest.mark.parametrize(
    ("tolerance", "gamma", "r_f", "r_c"),
    [("5 %", 0.85, 0.04, 0.104), (0.02, 0.75, 0.048, 0.112), ("1%", 0.75, 0.048, 0.112), ("0.5 %", 0.6, 0.064, 0.192)],
)
def test_a_tolerance_chooses(small_case, tolerance, gamma, r_f, r_c):
    part = small_case(adaptivity={"tolerance": tolerance}).adaptivity
    assert (part.gamma, part.r_f, part.r_c) == pytest.approx((gamma, r_f, r_c))
    assert part.gamma_coarse < part.gamma


def test_one_per_cent_is_the_default(small_case):
    default, asked = small_case(adaptivity=None), small_case(adaptivity={"tolerance": "1 %"})
    assert default == asked.model_copy(update={"adaptivity": asked.adaptivity.model_copy(update={"tolerance": None})})


@pytest.mark.parametrize(
    ("part", "key"),
    [
        ({"tolerance": "0.1 %"}, "adaptivity.tolerance"),
        ({"tolerance": "1 mm"}, "adaptivity.tolerance"),
        ({"tolerance": 0}, "adaptivity.tolerance"),
        ({"tolerance": "nan"}, "adaptivity.tolerance"),
        ({"tolerance": "1 %", "gamma": 0.5}, "adaptivity.gamma"),
        ({"tolerance": "1 %", "r_f": "20 mm"}, "adaptivity.r_f"),
        ({"tolerance": "1 %", "r_c": "300 mm"}, "adaptivity.r_c"),
        ({"tolerance": "1 %", "r_c": "3 mm"}, "adaptivity.r_c"),
        ({"gamma": 0.5, "gamma_coarse": 0.5}, "adaptivity.gamma_coarse"),
        ({"coarsen": "yes"}, "adaptivity.coarsen"),
        ({"r_w": "-1 mm"}, "adaptivity.r_w"),
    ],
)
def test_what_cannot_be(small_case, part, key):
    with pytest.raises(InputError) as caught:
        small_case(adaptivity=part)
    assert caught.value.key == key


def test_a_resolved_case_can_be_read_again(small_case):
    case = small_case(adaptivity={"tolerance": "0.5 %"})
    assert case_from_dict(json.loads(json.dumps(case.model_dump(mode="json", exclude={"source"})))) == case


def test_the_bound_grows_with_utilisation():
    assert load_error_bound(0.0) == 0.0
    assert load_error_bound(0.75) == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize("level", LEVELS)
def test_the_bound_of_a_level_is_within_its_tolerance(level):
    assert load_error_bound(level.gamma, level.r_f) <= level.tolerance


@pytest.mark.parametrize(("used", "warns"), [(0.5, False), (1.2, True)])
def test_a_run_warns_beyond_its_tolerance(used, warns):
    run = simulation()
    run.case = run.case.model_copy(update={"adaptivity": run.case.adaptivity.model_copy(update={"tolerance": 0.01})})
    curve = columns([row(step(1, 1e-6, 10.0, max_elastic_utilisation=used), 0.0, 0.0)])
    summary = build_summary(run, curve, status="finished", message="", cpu_s=1.0, wall_s=1.0, memory=1e9)
    assert summary["load_error_bound"] == pytest.approx(load_error_bound(used, 6.0))
    assert any("adaptivity.tolerance" in text for text in summary["warnings"]) is warns
    run.full = True
    whole = build_summary(run, curve, status="finished", message="", cpu_s=1.0, wall_s=1.0, memory=1e9)
    assert whole["load_error_bound"] is None
    assert not math.isnan(whole["tolerance"])
