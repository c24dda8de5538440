"""Cracks that close, in structures: a cut column, a cycle through zero, whole runs."""

from itertools import pairwise

import numpy as np
import pytest

from equilibrium.models import CONCRETE, beam
from fissura.contact import ClosingCusatisCedolin, CusatisCedolin
from fissura.equilibrium import StepSolver, System, dissipation, settle
from fissura.equilibrium.constraint import prescribed
from fissura.material import Material
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case
from fissura.tessellation.discretize import tessellate

SIDE, LENGTH = 0.04, 0.1
TOUGH = Material.standard(CONCRETE.E, CONCRETE.alpha, CONCRETE.f_t, 10.0 * CONCRETE.G_t)  # no snap-back
LAWS = (CusatisCedolin, ClosingCusatisCedolin)


def column(**changes):
    """A column clamped at the left and pulled or pressed at the right; its elongation is controlled."""
    return beam(
        specimen={"size": [LENGTH, SIDE, SIDE]},
        notch=None,
        supports=[{"type": "clamp", "face": "left"}],
        load={"face": "right", "direction": [1, 0, 0], "at": None},
        gauge=None,
        control={"type": "displacement", "target": 1e-4},
        **changes,
    )


@pytest.fixture(scope="module")
def columns():
    """Equations of a column of random bodies, under both laws."""
    case = column()
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    tessellation = discretize(nuclei, domain, np.zeros(len(nuclei)))
    conditions = conditions_from_case(case, domain)
    return [System(tessellation, TOUGH, law, conditions) for law in LAWS]


def cut(system):
    """History of a system that is cut in two in the middle."""
    ends = system.tessellation.x[system.tessellation.contacts.bodies[system.damageable], 0]
    history = system.virgin()
    history[(ends[:, 0] < 0.5 * LENGTH) != (ends[:, 1] < 0.5 * LENGTH), 0] = 1.0 - 1e-9
    return history


def test_a_flat_crack_is_as_stiff_in_compression_as_none():
    """Two bodies: stiffness of the one contact is elastic when pressed, whatever its damage."""
    case = column()
    domain = domain_from_case(case)
    x = np.array([[0.25 * LENGTH, 0.5 * SIDE, 0.5 * SIDE], [0.75 * LENGTH, 0.5 * SIDE, 0.5 * SIDE]])
    bodies = tessellate(x, domain.cell_of(x), domain.complex, domain.surfaces, np.full(2, 0.5 * LENGTH))
    published, closing = (System(bodies, TOUGH, law, conditions_from_case(case, domain)) for law in LAWS)
    elastic = settle(closing, closing.virgin(), -1e-6)
    state = settle(closing, cut(closing), -1e-6)
    assert elastic.load == pytest.approx(-1e-6 * CONCRETE.E * SIDE**2 / (0.5 * LENGTH), rel=1e-4)  # supports yield
    assert state.load == pytest.approx(elastic.load, rel=1e-12)
    assert settle(closing, cut(closing), 1e-6).load == pytest.approx(-1e-9 * elastic.load, rel=1e-4)
    assert settle(published, cut(published), -1e-6).load == pytest.approx(1e-9 * elastic.load, rel=1e-4)


def test_a_cut_column_bears_pressure_and_no_tension(columns):
    """Facets of a random crack are inclined and slide a little, since there is no friction."""
    for law, system in zip(LAWS, columns, strict=True):
        whole, pressed, pulled = (
            settle(system, history, value).load
            for history, value in ((system.virgin(), -1e-6), (cut(system), -1e-6), (cut(system), 1e-6))
        )
        assert abs(pulled) < 1e-6 * abs(whole)
        assert abs(pressed) < 1e-6 * abs(whole) if law is CusatisCedolin else 0.85 < pressed / whole < 1.0


def test_settling_finds_what_is_pressed(columns):
    """The state is in equilibrium under the law itself, from any guess of what is pressed."""
    _, system = columns
    history = cut(system)
    for value in (-1e-6, 1e-6):
        state = settle(system, history, value)
        again = system.response(state.response.u, history)
        np.testing.assert_allclose(again.traction, state.response.traction, atol=1e-9 * np.abs(again.traction).max())
        left = [system.law.intact(found.history) for found in (again, state.response)]
        np.testing.assert_array_equal(*left)
        np.testing.assert_allclose(state.load * system.load, again.forces, atol=1e-6 * abs(state.load))
        assert settle(system, state.response.history, value).iterations == 1


def test_a_cycle_through_zero_keeps_the_balance_of_energy(columns):
    """Pulled until it softens, pressed, pulled on: work is stored or dissipated, and no contact gains any energy."""
    _, system = columns
    solver = StepSolver(1e-9, 100)
    ends = (0.0, 12e-6, -2.3e-6, 12e-6)
    values = np.concatenate([np.linspace(a, b, 21)[1:] for a, b in pairwise(ends)])
    states, loads = [settle(system, system.virgin(), 1e-9)], []
    for value in values:
        last = states[-1]
        guess = (last.response.u, last.load)
        found = solver.solve(system, last.response.history, prescribed(system, value), guess, 100.0, patience=5)
        assert found is not None
        states.append(found)
        loads.append(found.load)
    assert system.law.damage(states[-1].response.history).max() > 0.8
    assert min(loads) < -500.0
    assert loads[-1] == pytest.approx(loads[19], rel=1e-7)  # back on the envelope
    work = dissipated = 0.0
    for a, b in pairwise(states):
        spent = dissipation(system, a.response, b.response)[0]
        work += 0.5 * (a.load + b.load) * (b.value - a.value) - dissipation(system, a.response, b.response)[1].sum()
        dissipated += spent.sum()
        assert spent.min() >= -1e-9 * states[20].response.stored
    assert work == pytest.approx(states[-1].response.stored + dissipated, rel=1e-5)
    assert any(dissipation(system, a.response, b.response)[1].any() for a, b in pairwise(states))


def test_kinks_are_none_without_closing(columns):
    system, _ = columns
    a, b = (settle(system, cut(system), value).response for value in (1e-6, -1e-6))
    assert not dissipation(system, a, b)[1].any()


@pytest.mark.parametrize("full", [False, True])
def test_whole_runs_keep_the_balance_of_energy(full):
    """Contacts close at the load and beside the crack."""
    case = beam(material={"law": "cusatis-cedolin-closing"}, adaptivity={"r_f": 0.015, "coarsen": True})
    steps = list(Simulation(case, full=full).steps())
    rest = [abs(step.work + step.exchanged - step.stored - step.dissipated) for step in steps]
    assert max(rest) < 1e-5 * steps[-1].work
    assert all(step.spent.min() >= -1e-9 * step.work for step in steps)
    shot = steps[-1].snapshot
    assert ((shot.strain[:, 0] < 0.0) & (shot.damage > 0.1)).any()
    if not full:
        assert sum(step.refinements for step in steps) > 0


def test_before_anything_closes_runs_of_both_laws_are_the_same():
    runs = [
        list(Simulation(beam(material={"law": law}, control={"target": 3e-5}), full=True).steps())
        for law in ("cusatis-cedolin", "cusatis-cedolin-closing")
    ]
    for published, closing in zip(*runs, strict=True):
        assert not ((published.snapshot.strain[:, 0] < 0.0) & (published.snapshot.damage > 0.0)).any()
        assert published.load == closing.load
        np.testing.assert_array_equal(published.snapshot.traction, closing.snapshot.traction)
