import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.study.measures import crack_of, crack_position, crack_share, measure, overlap

from .models import energies, record

LOADS = [100.0, 200.0, 150.0, 80.0]
PLACES = [[0.05, 0.02, 0.01], [0.05, 0.03, 0.01]]


def test_a_run_against_itself_has_no_error(beam):
    single = energies([1.0], [[0.05, 0.02, 0.01]])
    found = measure(record(beam, LOADS, variation="default", spent=single), record(beam, LOADS, spent=single))
    assert found.load == found.peak == found.energy == found.stiffness == 0.0
    assert found.crack == found.crack_full == found.overlap == 1.0
    assert found.position == found.position_full == 0.05
    assert found.cpu_ratio == 1.0
    assert found.finished
    assert found.compared


def test_signs_of_loads_do_not_matter(beam):
    """Peaks are those of magnitude."""
    others = [101.0, 195.0, 152.0, 80.0]
    plus, minus = (
        measure(record(beam, sign * np.array(others), variation="default"), record(beam, sign * np.array(LOADS)))
        for sign in (1.0, -1.0)
    )
    assert plus.peak == pytest.approx(-0.025)
    for name in ("load", "at", "peak", "energy"):
        assert getattr(minus, name) == pytest.approx(getattr(plus, name), rel=1e-12), name


def test_known_differences(beam):
    adaptive = record(
        beam,
        [101.0, 202.0, 150.0, 80.0],
        dissipated=[0.0, 1e-3, 2e-3, 4.2e-3],
        variation="default",
        stiffness=1.02e8,
        cpu=2.0,
        indicators={"utilisation": 0.8},
    )
    full = record(beam, LOADS, dissipated=[0.0, 1e-3, 2e-3, 4e-3], cpu=7.0)
    found = measure(adaptive, full)
    assert found.load == pytest.approx(0.01)
    assert found.peak == pytest.approx(0.01)
    assert found.energy == pytest.approx(0.05)
    assert found.stiffness == pytest.approx(0.02)
    assert found.at == pytest.approx(-1.0)  # at the peak
    assert found.cpu_ratio == found.effort_ratio == pytest.approx(3.5)
    assert (found.repeated, found.refining) == pytest.approx((0.1, 0.2))
    assert found.indicators["utilisation"] == 0.8
    assert found.row()["indicator_utilisation"] == 0.8
    assert found.indicators["calibration"] == pytest.approx(0.03)


def test_the_largest_difference_after_the_peak_is_told(beam):
    found = measure(record(beam, [100.0, 200.0, 150.0, 90.0], variation="default"), record(beam, LOADS))
    assert found.load == pytest.approx(10 / 200)
    assert found.at == pytest.approx(80 / 200)


def test_energies_of_paths_that_turn_back_are_compared_at_the_same_load(beam):
    target = beam["control"]["target"]
    gauge = np.array([0.3, 0.5, 0.4, 0.2]) * target
    full = record(beam, [100.0, 200.0, 100.0, 40.0], gauge=gauge, dissipated=[0.0, 1.0, 3.0, 5.0])
    # One step less: it ends at a load of 100 N, where full resolution has dissipated 3 J.
    short = record(beam, [100.0, 200.0, 100.0], gauge=gauge[:3], dissipated=[0, 1.0, 3.0], variation="default")
    found = measure(short, full)
    assert found.over == "dissipated energy"
    assert found.energy == pytest.approx(0.0)
    # At 70 N full resolution is half way between its last two steps.
    other = record(beam, [100.0, 200.0, 70.0], gauge=gauge[:3], dissipated=[0, 1.0, 3.0], variation="default")
    assert measure(other, full).energy == pytest.approx(3.0 / 4.0 - 1.0)


def test_what_cannot_be_compared_is_unknown(beam):
    found = measure(record(beam, [], variation="default", status="refused"), record(beam, LOADS))
    assert not found.compared
    assert not found.finished
    assert (found.end, found.message) == ("refused", "why")
    assert math.isnan(found.load)
    assert math.isnan(found.row()["indicator_balance"])
    stopped = measure(record(beam, LOADS[:3], variation="default", status="stopped"), record(beam, LOADS))
    assert stopped.compared
    assert not stopped.finished


def test_crack_is_the_fewest_contacts_with_half_of_the_energy():
    found = energies([1.0, 4.0, 2.0, 3.0], np.zeros((4, 3)))
    assert list(crack_of(found)) == [1, 3]
    assert list(crack_of(energies([1.0, 1.0], np.zeros((2, 3))))) == [0]
    assert list(crack_of(energies([1.0], [[0, 0, 0]]))) == [0]


def test_share_of_energy_on_the_crack():
    full = energies([100.0, 1.0], PLACES)
    assert crack_share(full, full, 0.005) == pytest.approx(100 / 101)
    assert crack_share(full, full, 0.01 + 1e-9) == 1.0
    elsewhere = energies([3.0, 1.0], [[0.2, 0.02, 0.01], [0.05, 0.02, 0.01]])
    assert crack_share(elsewhere, full, 0.005) == pytest.approx(0.25)
    assert math.isnan(crack_share(energies([], np.empty((0, 3))), full, 0.01))


def test_overlap_counts_the_same_contacts():
    full = energies([3.0, 1.0], PLACES)
    assert overlap(full, full) == 1.0
    assert overlap(energies([1.0, 5.0], PLACES), full) == pytest.approx(0.5)
    assert overlap(energies([3.0, 1.0], PLACES, first=1), full) == pytest.approx(0.25)
    assert overlap(energies([3.0, 1.0], PLACES, first=7), full) == 0.0
    assert math.isnan(overlap(energies([], np.empty((0, 3))), full))


@given(st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=20))
def test_half_of_the_energy_lies_on_either_side(contacts):
    weight, x = (np.array(values) for values in zip(*contacts, strict=True))
    at = crack_position(energies(weight, np.stack([x, 0 * x, 0 * x], axis=1)))
    total = weight.sum() * (1 + 1e-12)
    assert weight[x < at].sum() <= 0.5 * total
    assert weight[x > at].sum() <= 0.5 * total


def test_position_is_unknown_without_energy():
    assert math.isnan(crack_position(energies([], np.empty((0, 3)))))
