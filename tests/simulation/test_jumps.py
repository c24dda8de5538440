"""Jumps of damage before the peak are told."""

import pytest

from equilibrium.models import beam
from fissura.simulation.jumps import Jumps
from fissura.simulation.loop import Simulation


def jumps(loads, iterations, failed=()):
    found = Jumps()
    for number, (load, count) in enumerate(zip(loads, iterations, strict=True), 1):
        if number in failed:
            found = found.failed()
        found = found.accepted(number, number * 1e-6, load, count)
    return found.notices()


LOADS = [100.0, 300.0, 200.0]


def test_steps_that_follow_their_path_are_none():
    assert jumps(LOADS, [2, 8, 3]) == ()


def test_jumps_past_the_peak_do_not_matter():
    assert jumps(LOADS, [2, 3, 90], failed=[3]) == ()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("iterations", "failed"), [([2, 9, 3], ()), ([2, 3, 3], (2,))])
def test_many_corrections_and_failures_are_jumps(iterations, failed, sign):
    (notice,) = jumps([sign * load for load in LOADS], iterations, failed)
    assert notice.key == "control.max_step"
    assert "before the peak in 1 of 2 steps, first at step 2 (gauge 2e-06 m)" in notice.problem


def test_a_later_peak_brings_a_jump_before_it():
    found = Jumps().accepted(1, 1e-6, 100.0, 2).accepted(2, 2e-6, 90.0, 20)
    assert found.notices() == ()
    assert len(found.accepted(3, 3e-6, 110.0, 2).notices()) == 1


def test_a_brittle_beam_tells_of_its_jumps_and_a_tough_one_has_none():
    brittle = {"notch": None, "material": {"G_t": 4.0}, "control": {"target": 1e-5, "stop_load": 0.8}}
    for changes, count in ((brittle, 1), ({"control": {"stop_load": 0.8}}, 0)):
        simulation = Simulation(beam(**changes), full=True)
        load = [step.load for step in simulation.steps()]
        assert max(load) > load[-1]
        assert sum(notice.key == "control.max_step" for notice in simulation.notices) == count
