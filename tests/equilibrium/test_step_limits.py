"""What keeps steps short before the peak, whatever the target."""

from types import SimpleNamespace

import numpy as np
import pytest

from equilibrium.models import beam, simple_leg
from fissura.equilibrium import Goal, PathFollower, System, settle
from fissura.simulation.discretization import Discretization

LONG = {"target": 1e-2}  # steps of 200 um at most, 50 um at first, 0.1 um at least


def follower(limit=np.inf, **changes):
    (stage,) = beam(control={**LONG, **changes}).stages
    return PathFollower(simple_leg(stage), stage, 1.0, limit)


def state(value, load):
    return SimpleNamespace(value=value, load=load, iterations=1)


def test_the_first_step_ends_before_the_first_contact_is_at_its_strength():
    assert follower().goal(0.0).size == pytest.approx(5e-5)
    assert follower(limit=1.0).goal(0.0).size == pytest.approx(5e-5)
    path = follower(limit=3e-6)
    assert path.goal(0.0).size == pytest.approx(1.5625e-6)  # 200 um halved seven times
    assert follower(limit=0.0).goal(0.0).size == pytest.approx(200e-6 / 2**32)  # and not for ever shorter
    # As many halvings are left as there would have been without a limit.
    assert path.smallest == pytest.approx(1e-7 * 3e-6 / 5e-5)


def test_the_limit_of_a_structure_is_where_its_first_contact_is_damaged():
    structure = Discretization(beam(), full=True)
    system = structure.system
    assert isinstance(system, System)
    unit = settle(system, system.virgin(), 1.0)
    limit = 1.0 / system.largest_utilisation(unit.response)
    for share, damaged in ((0.999, False), (1.001, True)):
        response = system.response(share * limit * unit.response.u, system.virgin())
        assert response.history[:, 0].any() == damaged


LEAP = (state(1e-5, 100.0), state(1.5e-5, 110.0))  # secant stiffness falls to 0.73 of what it was


def test_a_leap_is_done_again_with_half_its_length():
    path = follower(limit=1e-5)
    goal, length = path.goal(1e-5), path.length
    assert path.skipped(goal, *LEAP, 100.0)
    assert path.failed(1.0)
    assert path.length == 0.5 * length
    assert path.goal(1e-5).control == "gauge"


@pytest.mark.parametrize(
    ("change", "now", "found", "peak"),
    [
        ("stiff", state(1e-5, 100.0), state(1.5e-5, 125.0), 100.0),
        ("short", state(1e-5, 100.0), state(1.09e-5, 81.0), 100.0),
        ("past the peak", state(1e-5, 98.0), state(1.5e-5, 80.0), 100.0),
        ("the first step", state(0.0, 0.0), state(1.5e-5, 80.0), 0.0),
        ("the gauge has turned back beyond zero", state(-1e-5, 100.0), state(1.5e-5, 80.0), 100.0),
    ],
)
def test_no_leap(change, now, found, peak):
    path = follower()
    assert not path.skipped(path.goal(max(now.value, 0.0)), now, found, peak), change


def test_steps_in_energy_and_the_smallest_ones_are_no_leaps():
    assert not follower().skipped(Goal("dissipation", 1e-3), *LEAP, 100.0)
    path = follower(first_step=1.5e-7)
    assert not path.skipped(path.goal(1e-5), *LEAP, 100.0)


def test_a_leap_is_no_failure():
    """Energy does not take over because of it, and a later failure does not count it."""
    path = follower(limit=1e-5)
    path.succeeded(path.goal(0.0), state(0.0, 0.0), state(1e-5, 1.0), 0.5)
    for _ in range(4):
        assert path.skipped(path.goal(1e-5), *LEAP, 100.0)
        assert path.failed(1.0)
        assert not path.goal(1e-5).in_energy
    assert path.failed(1.0)
    assert path.goal(1e-5).in_energy
