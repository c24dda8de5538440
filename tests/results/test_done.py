import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.results.done import Done

from .synthetic import case


def shares(done, gauges, loads):
    return [done.after(gauge / 1e-4, load) for gauge, load in zip(gauges, loads, strict=True)]


def test_under_a_gauge_its_share_of_the_target_counts_alone():
    assert shares(Done(case()), [1e-5, 5e-5, 1e-4], [9.0, 1.0, 0.0]) == pytest.approx([0.1, 0.5, 1.0])


def test_the_share_waits_while_the_gauge_turns_back():
    assert shares(Done(case()), [4e-5, 3e-5, 5e-5], [3.0, 2.0, 1.0]) == pytest.approx([0.4, 0.4, 0.5])


@pytest.mark.parametrize("control", [{"type": "dissipation", "stop_load": 0.2}, {"stop_load": 0.2}])
def test_the_fall_of_the_load_counts_where_it_ends_the_run(control):
    done = Done(case(control))
    got = shares(done, [1e-5, 2e-5, 3e-5, 2e-5, 2e-5], [5.0, 10.0, 6.0, 8.0, 1.9])
    assert got == pytest.approx([0.1, 0.2, 0.5, 0.5, 1.0])
    assert done.peak == 10.0


def test_a_run_that_any_loss_of_load_ends():
    assert shares(Done(case({"stop_load": 1.0})), [1e-5, 2e-5], [5.0, 4.0]) == pytest.approx([0.1, 1.0])


@given(st.lists(st.tuples(st.floats(-1e-4, 2e-4), st.floats(-1e3, 1e3)), min_size=1, max_size=20))
def test_it_never_falls_and_stays_between_0_and_1(path):
    got = shares(Done(case({"type": "dissipation"})), *zip(*path, strict=True))
    assert got == sorted(got)
    assert got[0] >= 0
    assert got[-1] <= 1
