import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.study.definition import Limits
from fissura.study.indicators import INDICATORS
from fissura.study.measures import Measures
from fissura.study.statistics import correlations, fails, localisation, pareto, spread, twins


def measures(load=0.005, **values):
    fixed = {
        "specimen": "beam",
        "seed": 1,
        "variation": "default",
        "end": "target",
        "end_full": "target",
        "message": "",
        "load": load,
        "peak": 0.0,
        "energy": 0.0,
        "crack": 1.0,
        "crack_full": 1.0,
        "overlap": 1.0,
        "indicators": dict.fromkeys(INDICATORS, 0.5),
    }
    return Measures(**(fixed | values))


def test_spread():
    assert (spread([1.0, -4.0, 2.0]).median, spread([1.0, -4.0, 2.0]).worst) == (1.0, 4.0)
    assert spread([3.0, math.nan, 1.0], smallest=True).worst == 1.0
    assert math.isnan(spread([math.nan]).median)


def test_limits():
    limits = Limits(load=0.01, peak=0.01, energy=0.02)
    assert fails(measures(0.01), limits) == []
    assert fails(measures(0.0101, energy=-0.021), limits) == ["load 1.01 %", "energy -2.10 %"]
    assert fails(measures(0.001, end="stopped"), limits) == ["adaptive stopped, full target"]
    assert fails(measures(math.nan, end="refused"), limits) != []
    assert fails(measures(0.001, energy=math.nan), limits) == ["energy nan %"]


@given(st.lists(st.tuples(st.integers(1, 9), st.integers(1, 9)), min_size=1, max_size=12))
def test_nothing_beats_the_front(points):
    gain, error = zip(*points, strict=True)
    front = pareto(gain, error)
    for k, (g, e) in enumerate(points):
        beaten = any((gg >= g and ee <= e) and (gg, ee) != (g, e) for gg, ee in points)
        assert ((g, e) in [points[j] for j in front]) == (not beaten), k
    assert [gain[k] for k in front] == sorted(gain[k] for k in front)


def test_twins_are_what_all_variations_have():
    found = [
        measures(seed=1),
        measures(seed=2),
        measures(seed=1, variation="b"),
        measures(seed=3, variation="b"),
    ]
    assert [(m.seed, m.variation) for m in twins(found)] == [(1, "default"), (1, "b")]
    refused = [*found, measures(math.nan, seed=2, variation="b")]
    assert [(m.seed, m.variation) for m in twins(refused)] == [(1, "default"), (2, "default")]
    assert twins([]) == []


def test_an_indicator_in_proportion_is_recognised():
    errors = [0.001, 0.002, 0.01, 0.005]
    found = [measures(e, indicators=dict.fromkeys(INDICATORS, 1.0) | {"utilisation": 3 * e}) for e in errors]
    by_name = {c.name: c for c in correlations(found)}
    good = by_name["utilisation"]
    assert (good.runs, good.rank, good.linear) == pytest.approx((4, 1.0, 1.0))
    assert (good.covering, good.excess) == pytest.approx((1 / 3, 1.0))
    assert math.isnan(by_name["balance"].rank)  # the same in all runs


def test_an_indicator_that_misses_errors_covers_nothing():
    found = [
        measures(e, indicators=dict.fromkeys(INDICATORS, 1.0) | {"balance": i})
        for e, i in ((0.01, 0.0), (0.02, 0.0), (0.001, 0.3), (0.002, 0.2))
    ]
    missed = next(c for c in correlations(found) if c.name == "balance")
    assert math.isinf(missed.covering)
    assert missed.rank < 0.0


def test_places_of_cracks():
    rng = np.random.default_rng(1)
    x = rng.uniform(0.1, 0.3, 20)
    same = [measures(seed=k, position=p, position_full=p) for k, p in enumerate(x)]
    (test,) = localisation(same)
    assert (test.statistic, test.probability) == (0.0, 1.0)
    assert test.same.all()
    drawn = [replace(m, position=0.2 + 0.01 * (m.position - 0.2), overlap=0.3) for m in same]
    (test,) = localisation(drawn)
    assert test.probability < 0.05
    assert not test.same.any()
    assert localisation(same[:1]) == []
