"""What leads along a path, and a bar that snaps back, against the closed form."""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from equilibrium.models import BEAM, changed, simple_leg
from fissura.case import case_from_dict
from fissura.contact import CusatisCedolin
from fissura.equilibrium import PathFollower, System
from fissura.errors import RunStopped
from fissura.material import Material
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation.discretize import tessellate

# --- choosing ------------------------------------------------------------------------------------------------------

ENERGY = 1.0  # hence at most 0.02 J a step


def follower(**changes):
    (stage,) = case_from_dict(changed(BEAM, {"control": {"target": 1e-4, "max_step": 2e-6, **changes}}), Path()).stages
    return PathFollower(replace(simple_leg(stage), quantity="gauge"), stage, ENERGY)


def state(value, load=1.0, iterations=1):
    return SimpleNamespace(value=value, load=load, iterations=iterations)


def succeeded(path, iterations, growth, dissipated, value):
    """A step of the goal that comes next."""
    goal = path.goal(value - growth)
    path.succeeded(goal, state(value - growth), state(value, iterations=iterations), dissipated)


def damaged(**changes):
    """After a step under the gauge that dissipated 5 mJ."""
    path = follower(**changes)
    size = path.goal(0.0).size
    succeeded(path, 1, size, 5e-3, size)
    return path


def test_the_gauge_leads_as_long_as_it_can():
    path, value = follower(), 0.0
    while not path.ended(value):
        goal = path.goal(value)
        assert (goal.control, goal.in_energy, goal.patience) == ("gauge", False, 1)
        assert value < goal.size <= 1e-4
        succeeded(path, 1, goal.size - value, 1e-3, goal.size)
        value = goal.size
    assert value == 1e-4


def test_energy_takes_over_where_the_gauge_fails_and_gives_back_when_it_grows():
    path = damaged()
    assert path.failed(1.0)
    goal = path.goal(5e-7)
    assert goal.control == "dissipation"
    assert goal.size == pytest.approx(5e-3)
    succeeded(path, 3, -1e-7, goal.size, 4e-7)
    for growth in (1e-6, 1e-6, -1e-8, 1e-6, 1e-6):
        succeeded(path, 3, growth, goal.size, 1e-6)
        assert path.goal(1e-6).in_energy
    succeeded(path, 3, 1e-6, goal.size, 1e-6)
    assert not path.goal(1e-6).in_energy


def test_it_takes_longer_to_come_back_the_sooner_the_gauge_fails_again():
    path, counts = damaged(), []
    for _ in range(3):
        assert path.failed(1.0)
        count = 0
        while path.goal(1e-6).in_energy:
            succeeded(path, 3, 1e-6, 5e-3, 1e-6)
            count += 1
        counts.append(count)
    assert counts == [3, 6, 12]
    for _ in range(20):
        succeeded(path, 3, 1e-6, 5e-3, 2e-6)
    assert path.failed(1.0)
    for _ in range(3):
        succeeded(path, 3, 1e-6, 5e-3, 1e-6)
    assert not path.goal(1e-6).in_energy


def test_undamaged_steps_are_halved_before_energy_takes_over():
    path, lengths = follower(), []
    while not path.goal(0.0).in_energy:
        lengths.append(path.length)
        assert path.failed(1.0)
    assert lengths == pytest.approx([5e-7, 2.5e-7, 1.25e-7, 6.25e-8])
    assert 0 < path.goal(0.0).size < 0.02 / 32


def test_where_energy_fails_too_a_jump_is_followed_and_then_the_run_given_up():
    path = damaged(min_step=1e-7)
    assert path.failed(1.0)
    sizes = []
    while path.goal(5e-7).in_energy:
        sizes.append(path.goal(5e-7).size)
        assert path.failed(1.0)
    assert sizes == pytest.approx([5e-3 / 2**k for k in range(len(sizes))])
    assert sizes[-1] < 1e-4
    assert path.goal(5e-7).patience > 1
    assert not path.skipped(path.goal(5e-7), state(0.0, 1.0), state(0.0, 0.0), 1.0)
    count = 0
    while path.failed(1.0):
        assert path.goal(5e-7).control == "gauge"
        count += 1
    assert 0 < count < 5


def test_switching_can_be_forbidden():
    path = damaged(switch=False)
    assert not path.skipped(path.goal(5e-7), state(0.0, 1.0), state(0.0, 0.0), 1.0)
    patient = 0
    while path.failed(1.0):
        assert path.goal(5e-7).control == "gauge"
        patient += path.goal(5e-7).patience > 1
    assert patient == 3


def test_a_jump_under_the_gauge_is_noticed():
    path = damaged()
    assert path.skipped(path.goal(1e-6), state(0.0, 1.0), state(0.0, 0.7), 1.0)
    assert not path.skipped(path.goal(1e-6), state(0.0, 1.0), state(0.0, 0.9), 1.0)
    assert not path.skipped(path.goal(1e-6), state(0.0, 1.0), state(0.0, 1.3), 1.0)
    assert path.failed(1.0)
    assert not path.skipped(path.goal(1e-6), state(0.0, 1.0), state(0.0, 0.7), 1.0)


def test_with_dissipation_control_energy_leads_from_damage_on():
    path = follower(type="dissipation")
    goal = path.goal(0.0)
    assert goal.control == "gauge"
    succeeded(path, 1, goal.size, 1e-3, goal.size)
    assert not path.goal(goal.size).in_energy
    succeeded(path, 1, 1e-6, 6e-3, 1e-6)
    for _ in range(20):
        assert path.goal(1e-6).in_energy
        succeeded(path, 1, 1e-5, 6e-3, 1e-6)
    assert path.goal(1e-6).size == pytest.approx(0.02)


def test_ends():
    path = follower(type="dissipation", stop_load=0.1)
    assert not path.broken(0.0, 0.0)
    assert not path.broken(-0.09, 1.0)  # it has never been larger on this leg
    succeeded(path, 1, 1e-5, 0.0, 1e-5)
    assert path.ended(1e-4)
    assert not path.ended(1e-5)
    assert path.broken(-0.09, 1.0)
    assert not path.broken(0.11, 1.0)
    path = damaged()
    assert not path.broken(0.0, 1.0)
    assert path.failed(1.0)
    assert path.broken(0.009, 1.0)


def test_a_load_that_passes_through_zero_beside_others_ends_nothing():
    (stage,) = case_from_dict(BEAM, Path()).stages
    for kept, ends in ((np.zeros(2), True), (np.array([5.0, 0.0]), False)):
        path = PathFollower(replace(simple_leg(stage), kept=kept), stage, ENERGY)
        succeeded(path, 1, 1e-5, 5e-2, 1e-5)
        assert path.failed(1.0)
        assert path.goal(1e-5).in_energy
        assert path.broken(0.009, 1.0) == ends


# --- legs of a programme ---------------------------------------------------------------------------------------------


def leg(begin, end, load=0.0, **changes):
    (stage,) = case_from_dict(changed(BEAM, {"control": {"target": 1e-4, "max_step": 2e-6, **changes}}), Path()).stages
    return PathFollower(replace(simple_leg(stage), begin=begin, end=end, load=load), stage, ENERGY)


@pytest.mark.parametrize(("begin", "end"), [(4e-5, 1e-5), (1e-5, 4e-5), (2e-5, -2e-5), (0.0, -3e-5)])
def test_a_leg_ends_where_it_is_to_end(begin, end):
    path, value, values = leg(begin, end), begin, []
    while not path.ended(value):
        value = path.goal(value).size
        succeeded(path, 1, value - begin, 0.0, value)
        values.append(value)
    assert values[-1] == end
    assert (np.diff([begin, *values]) * (end - begin) > 0).all()
    assert np.abs(np.diff([begin, *values])).max() <= 2e-6 * (1 + 1e-9)


def test_energy_cannot_lead_while_a_leg_unloads():
    path = leg(4e-5, 1e-5, load=100.0)
    lengths = []
    while path.failed(100.0):
        assert path.goal(4e-5).control == "gauge"
        lengths.append(path.length)
    assert len(lengths) > 5
    assert not path.skipped(path.goal(4e-5), state(4e-5, 100.0), state(3.9e-5, 60.0), 100.0)
    assert not path.broken(0.0, 100.0)


def test_steps_under_force_are_no_jumps_and_energy_does_not_take_over():
    (stage,) = case_from_dict(changed(BEAM, {"control": {"target": 1e-4, "max_step": 2e-6}}), Path()).stages
    path = PathFollower(replace(simple_leg(stage), quantity="force"), stage, ENERGY)
    while path.failed(1.0):
        assert path.goal(0.0).control == "force"


# --- a row of rigid bodies, one contact weaker -----------------------------------------------------------------------

COUNT, LENGTH, SIDE, WEAK, SHARE = 20, 0.02, 0.03, 9, 0.9
BRITTLE = Material.standard(60e9, 0.29, 2.2e6, 3.0)
AREA, CONTACTS = SIDE**2, COUNT - 1
PEAK = SHARE * BRITTLE.f_t * AREA


def started(**control):
    """The row, clamped on the left and pulled on the right."""
    data = changed(
        BEAM,
        {
            "specimen": {"size": [COUNT * LENGTH, SIDE, SIDE]},
            "notch": None,
            "supports": [{"type": "clamp", "face": "left"}],
            "gauge": None,
            "material": {"G_t": 3.0},
            "discretization": {"l_f": 0.011, "l_c": 0.011},
            "control": {"type": "dissipation", "target": 6e-5, "tolerance": 1e-6, **control},
        },
    )
    data["load"] = {"face": "right", "direction": [1, 0, 0]}
    case = case_from_dict(data, Path())
    domain = domain_from_case(case)
    x = np.full((COUNT, 3), 0.5 * SIDE)
    x[:, 0] = (np.arange(COUNT) + 0.5) * LENGTH
    system = System(
        tessellate(x, domain.cell_of(x), domain.complex, domain.surfaces, np.full(COUNT, LENGTH)),
        BRITTLE,
        CusatisCedolin,
        conditions_from_case(case, domain),
    )
    scale = np.ones(CONTACTS)
    scale[WEAK] = SHARE
    system.law = CusatisCedolin.create(BRITTLE, system.law.length, scale)
    simulation = Simulation(case, full=True)
    simulation._discretization.system = system
    return simulation


def weak_load(strain):
    """Load at strains of the weak contact, as they grow from zero."""
    law = CusatisCedolin.create(BRITTLE, np.full(len(strain), LENGTH), np.full(len(strain), SHARE))
    traction, _ = law.response(np.stack([strain, 0.0 * strain, 0.0 * strain], axis=1), law.initial_history())
    return AREA * traction[:, 0]


def elongation(load, strain):
    """Of the whole row: of the elastic contacts, and of the weak one."""
    return load / (BRITTLE.E * AREA) * LENGTH * (CONTACTS - 1) + strain * LENGTH


@pytest.mark.parametrize(
    ("control", "leaders"),
    [
        ({}, {"displacement", "dissipation"}),
        ({"type": "displacement"}, {"displacement", "dissipation"}),
    ],
)
def test_bar_that_snaps_back_follows_the_closed_form(control, leaders):
    simulation = started(**control, stop_load=0.03)
    steps = list(simulation.steps())
    load = np.array([s.load for s in steps])
    reached = np.array([s.load_displacement for s in steps])
    # The strain of the weak contact tells everything.
    strain = np.array([s.snapshot.strain[WEAK, 0] for s in steps])
    exact = weak_load(strain)
    np.testing.assert_allclose(load, exact, rtol=1e-4, atol=1e-6 * PEAK)
    np.testing.assert_allclose(reached, elongation(exact, strain), rtol=1e-4)
    assert np.diff(strain).min() > 0
    assert load.max() == pytest.approx(PEAK, rel=0.1)
    assert load.max() <= PEAK * (1 + 1e-6)
    assert load[-1] < 0.05 * PEAK
    # It snaps back: the row is shorter half way down than at the peak.
    assert reached[(load < 0.5 * PEAK) & (strain > strain[load.argmax()])][0] < 0.75 * reached[load.argmax()]
    assert {s.control for s in steps} == leaders
    assert max(s.residual for s in steps) <= simulation.case.control.tolerance
    grid = np.linspace(0.0, strain[-1], 100_001)
    spent = LENGTH * (np.trapezoid(weak_load(grid), grid) - 0.5 * exact[-1] * strain[-1])
    assert 0.9 < spent / (SHARE**2 * BRITTLE.G_t * AREA) < 1.0
    assert steps[-1].dissipated == pytest.approx(spent, rel=2e-3)
    np.testing.assert_allclose([s.work for s in steps], [s.stored + s.dissipated for s in steps], rtol=2e-3)


def test_without_switching_the_run_jumps_or_stops():
    """The next equilibrium is far away: the load falls at once, or the run says that it found none."""
    kept = []
    with suppress(RunStopped):
        for step in started(type="displacement", switch=False).steps():
            kept.append(step)
    load = np.array([s.load for s in kept])
    top = int(load.argmax())
    assert 0.9 * PEAK < load[top] <= PEAK * (1 + 1e-6)
    assert (load[top + 1 :] < 0.2 * PEAK).all()
    assert (np.diff([s.gauge for s in kept]) > 0).all()
    assert {s.control for s in kept} == {"displacement"}
    assert max(s.residual for s in kept) <= 1e-6
