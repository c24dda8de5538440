"""Loading programmes: several loads, stages, cycles, gravity, forces that lead; against identities."""

import re
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from conftest import small_beam
from fissura.api.check import check
from fissura.case import case_from_dict
from fissura.equilibrium import settle
from fissura.errors import InputError, RunStopped
from fissura.simulation.discretization import Discretization
from fissura.simulation.loop import Simulation

A, B = {"face": "top", "at": 0.04}, {"face": "top", "at": 0.07}
TWO = {"control": None, "load": None, "loads": {"a": A, "b": B}}


def stages(*tables, **changes):
    return small_beam(control=None, stage=list(tables), **changes)


@cache
def cycles():
    """Two cycles, the first before damage and the second after it; down to a share of the load, and to zero."""
    case = stages(
        {"to": ["5 um", "5 % of load", "20 um", "0 um", "20 um", "40 um"], "max_step": "1 um", "tolerance": 1e-7}
    )
    simulation = Simulation(case)
    return simulation, list(simulation.steps())


@cache
def two_loads():
    """One load is put on and kept, another follows, then both grow together."""
    tables = (
        {"load": "a", "control": "force", "to": "300 N"},
        {"load": "b", "control": "displacement", "to": "12 um"},
        {"load": {"a": 0.25, "b": 0.75}, "to": "40 um"},
    )
    simulation = Simulation(small_beam(**TWO, stage=list(tables)))
    return simulation, list(simulation.steps())


@cache
def heavy():
    """A beam as heavy as a few percent of its strength, under its own weight and a load."""
    simulation = Simulation(small_beam(gravity={"density": 24000.0}))
    return simulation, list(simulation.steps())


RUNS = {"cycles": cycles, "two loads": two_loads, "gravity": heavy}


@pytest.mark.parametrize("name", RUNS)
def test_work_of_all_loads_is_stored_or_dissipated(name):
    _, steps = RUNS[name]()
    most = max(step.work for step in steps)
    for step in steps:
        assert step.stored + step.dissipated == pytest.approx(step.work + step.exchanged, abs=1e-5 * most)


@pytest.mark.parametrize("name", RUNS)
def test_reactions_and_loads_balance(name):
    """Both come out of the same forces of contacts: to round-off where these are solved for well enough."""
    _, steps = RUNS[name]()
    most = max(sum(map(abs, step.forces.values())) for step in steps)
    assert max(np.linalg.norm(step.rest[:3]) for step in steps) < 1e-9 * most


@pytest.mark.parametrize("name", RUNS)
def test_every_run_refines(name):
    simulation, steps = RUNS[name]()
    assert steps[-1].bodies > simulation.bodies_start
    assert all(step.residual <= 1e-4 for step in steps)
    assert steps[-1].done == 1.0


def test_superposition_of_elastic_loads():
    system = Discretization(small_beam(**TWO, stage={"load": "a", "to": "1 um"}), full=True).system
    nothing, history = np.zeros(2), system.virgin()

    def under(*forces):
        drive = type(system.drive)(np.array([1.0, 0.0]), "force", None)
        return settle(system.driven(drive, np.array([0.0, forces[1]])), history, forces[0]).response

    a, b, both = under(100.0, 0.0), under(0.0, 250.0), under(300.0, -500.0)
    scale = np.abs(both.u).max()
    assert_allclose(both.u, 3.0 * a.u - 2.0 * b.u, atol=1e-10 * scale)
    assert_allclose(both.traction, 3.0 * a.traction - 2.0 * b.traction, atol=1e-10 * np.abs(both.traction).max())
    assert_allclose(system.driven(system.drive, nothing).load, system.load, rtol=0.0)


def test_work_is_mutual():
    """Betti: one load works as much on the displacements of the other as that on its own."""
    system = Discretization(small_beam(**TWO, stage={"load": "a", "to": "1 um"}), full=True).system
    rows, history = system.acting.load_rows, system.virgin()
    found = []
    for k in range(2):
        drive = type(system.drive)(np.eye(2)[k], "force", None)
        found.append(rows @ settle(system.driven(drive, np.zeros(2)), history, 1.0).response.u)
    assert found[0][1] == pytest.approx(found[1][0], rel=1e-9)


def test_a_cycle_comes_back_to_the_envelope():
    """All unloading goes to the origin: what is reached again is the same state."""
    _, steps = cycles()
    turns = [k for k in range(1, len(steps) - 1) if steps[k].gauge >= max(steps[k - 1].gauge, steps[k + 1].gauge)]
    there, back = (step for step in steps if step.gauge == 20e-6)
    assert there.number - 1 in turns
    assert back.load == pytest.approx(there.load, rel=1e-6)
    assert back.dissipated == pytest.approx(there.dissipated, rel=1e-6)
    assert_allclose(back.snapshot.damage, there.snapshot.damage, rtol=1e-5, atol=1e-12)
    between = [s for s in steps if there.number <= s.number <= back.number]
    assert np.ptp([s.dissipated for s in between]) < 1e-6 * there.dissipated
    origin = next(s for s in between if s.gauge == 0.0)
    assert abs(origin.load) < 1e-6 * there.load
    assert np.abs(origin.snapshot.displacement).max() < 1e-9 * np.abs(there.snapshot.displacement).max()


def test_unloading_to_a_share_of_the_load():
    _, steps = cycles()
    turned = next(s for s in steps if s.gauge == 5e-6)
    low = next(s for s in steps if s.number > turned.number and s.control == "gauge")
    low = steps[low.number - 2]
    assert low.load == pytest.approx(0.05 * turned.load, rel=1e-9)
    assert low.control == "force"


def test_cycles_before_damage_change_nothing():
    """The envelope is that of a run without cycles, as far as their steps meet."""
    _, steps = cycles()
    straight = {s.gauge: s for s in Simulation(stages({"to": ["20 um", "40 um"], "max_step": "1 um"})).steps()}
    there = next(s for s in steps if s.gauge == 20e-6)
    assert there.load == pytest.approx(straight[20e-6].load, rel=1e-3)
    assert steps[-1].load == pytest.approx(straight[40e-6].load, rel=1e-2)


def test_kept_loads_stay():
    _, steps = two_loads()
    first, second, third = ([s for s in steps if s.stage == k] for k in (1, 2, 3))
    assert {s.control for s in first} == {"force"}
    assert first[-1].forces == {"a": pytest.approx(300.0), "b": 0.0}
    assert all(s.forces["a"] == 300.0 for s in second)
    assert second[-1].displacements["b"] == 12e-6
    more = np.array([[s.forces["a"] - 300.0, s.forces["b"] - second[-1].forces["b"]] for s in third])
    assert_allclose(more[:, 1], 3.0 * more[:, 0], atol=1e-9 * np.abs(more).max())
    assert third[-1].gauge == 40e-6
    assert third[-1].load == pytest.approx((0.25 * third[-1].forces["a"] + 0.75 * third[-1].forces["b"]) / 0.625)


def test_the_share_that_is_done_never_falls():
    for run in RUNS.values():
        _, steps = run()
        assert (np.diff([s.done for s in steps]) > -1e-9).all()


def test_one_stage_is_the_table_control():
    """Bit for bit."""
    one = list(Simulation(small_beam(control={"target": 4e-5})).steps())
    other = list(Simulation(stages({"control": "gauge", "to": "40 um"})).steps())
    assert len(one) == len(other)
    for a, b in zip(one, other, strict=True):
        assert (a.load, a.gauge, a.work, a.dissipated) == (b.load, b.gauge, b.work, b.dissipated)


def test_a_load_that_a_force_leads_is_that_of_the_gauge():
    by_gauge = Simulation(small_beam(), full=True)
    curve = np.array([[0.0, 0.0], *([s.load, s.gauge] for s in by_gauge.steps())])
    peak = int(curve[:, 0].argmax())
    *_, last = Simulation(stages({"control": "force", "to": 0.8 * curve[peak, 0]}), full=True).steps()
    assert last.load == pytest.approx(0.8 * curve[peak, 0], rel=1e-9)
    assert last.gauge == pytest.approx(np.interp(last.load, *curve[: peak + 1].T), rel=0.02)


def test_beyond_what_it_bears_a_force_finds_nothing():
    kept = []
    run = Simulation(stages({"control": "force", "to": "10 kN", "min_step": "20 N", "max_iterations": 10})).steps()
    with pytest.raises(RunStopped, match=r"bears no more than about .* N") as caught:
        kept.extend(iter(lambda: next(run), None))
    assert "stage[0].min_step" in str(caught.value)
    assert re.search(r"control value [0-9.]+ N: ", str(caught.value))
    assert len(kept) > 3
    peak = max(s.load for s in Simulation(small_beam()).steps())
    assert 0.9 * peak < kept[-1].load < 1.02 * peak


def test_the_weight_is_the_same_at_every_resolution():
    """Its resultant is that of the specimen's volume, in its centroid."""
    case = small_beam(gravity={"density": 2400.0, "direction": [0.6, -0.8, 0.0]}, notch=[])
    for full in (True, False):
        structure = Discretization(case, full=full)
        system, weight = structure.system, structure.conditions.weight
        assert weight.size == pytest.approx(2400.0 * 9.81 * structure.domain.volume, rel=1e-12)
        row = (system.acting.load_rows[[1]].toarray()).reshape(-1, 6)
        assert_allclose(row[:, :3].sum(axis=0), [0.6, -0.8, 0.0], atol=1e-12)
        moment = (row[:, 3:] + np.cross(system.tessellation.x, row[:, :3])).sum(axis=0)
        assert_allclose(moment, np.cross(structure.domain.bounds.mean(axis=0), [0.6, -0.8, 0.0]), atol=1e-10)


def test_the_weight_is_put_on_first_and_rests_on_the_supports():
    simulation, steps = heavy()
    weight = 24000.0 * 9.81 * simulation.domain.volume
    before = [s for s in steps if s.stage == 0]
    assert [s.forces["load"] for s in before] == [0.0] * len(before)
    assert before[-1].forces["gravity"] == weight
    assert before[-1].reactions[:, 1].sum() == pytest.approx(weight, rel=1e-9)
    assert all(s.forces["gravity"] == weight for s in steps[len(before) :])


def elastic_steps(**changes):
    """A run so short that nothing is damaged."""
    return list(Simulation(small_beam(control={"target": 1e-6}, **changes), full=True).steps())


def test_dead_weight_is_taken_off_the_load():
    """What a beam bends under its weight adds to what it bends under the load."""
    alone = elastic_steps()[-1]
    both = elastic_steps(gravity={"density": 24000.0})
    own = [s for s in both if s.stage == 0][-1]
    assert own.gauge > 1e-8
    assert both[-1].load == pytest.approx(alone.load * (1e-6 - own.gauge) / 1e-6, rel=1e-6)


def test_a_hanging_bar():
    """Under its weight W the end moves by half, and the mean by a third, of what W moves them at the end."""
    data = {
        "specimen": {"size": [0.04, 0.16, 0.04]},
        "supports": [{"type": "clamp", "face": "top"}],
        "load": {"face": "bottom", "direction": [0, -1, 0]},
        "gravity": {"density": 2400.0},
        "material": {"E": 30e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
        "discretization": {"l_f": 0.01, "l_c": 0.01},
        "stage": {"control": "force", "to": "1 N"},
    }
    steps = list(Simulation(case_from_dict(data), full=True).steps())
    hung, pulled = ([s for s in steps if s.stage == k][-1].displacements for k in (0, 1))
    weight, compliance = 2400.0 * 9.81 * 0.04 * 0.04 * 0.16, pulled["load"] - hung["load"]
    assert hung["load"] == pytest.approx(weight / 2.0 * compliance, rel=0.02)
    assert hung["gravity"] == pytest.approx(weight / 3.0 * compliance, rel=0.02)


def test_a_gauge_between_supports_is_refused_by_its_name():
    ends = {"a": {"face": "bottom", "at": 0.01}, "b": {"face": "bottom", "at": 0.11}, "direction": [0, 1, 0]}
    with pytest.raises(InputError) as caught:
        Simulation(small_beam(gauges={"other": ends}))
    assert caught.value.key == "gauges.other"


def test_all_gauges_and_loads_are_recorded_whatever_leads():
    case = small_beam(gauges={"deflection": {"a": {"face": "bottom", "at": 0.01}, "b": A, "direction": [0, -1, 0]}})
    for step, _ in zip(Simulation(case).steps(), range(3), strict=False):
        assert set(step.gauges) == {"gauge", "deflection"}
        assert step.gauges["gauge"] == step.gauge
        assert step.gauges["deflection"] > 0.0
        assert step.displacements["load"] == pytest.approx(step.load_displacement)


def test_a_target_that_is_there_already_is_passed_over():
    steps = list(Simulation(stages({"to": "5 um"}, {"to": "5 um"}, {"control": "gauge", "to": "10 um"})).steps())
    assert {s.stage for s in steps} == {1, 3}
    assert all(a.number + 1 == b.number for a, b in pairwise(steps))


def test_a_load_that_is_turned_round_takes_small_steps():
    steps = list(Simulation(stages({"to": ["12 um", "50 % of load", "-50 % of load"]})).steps())
    led = [s.load for s in steps if s.control == "force"]
    top = next(s.load for s in steps if s.gauge == 12e-6)
    down = np.diff([top, *led])
    assert_allclose(led[9], 0.5 * top, rtol=1e-9)
    assert_allclose(down[:10], -0.05 * top, rtol=1e-6)
    assert_allclose(led[-1], -0.25 * top, rtol=1e-9)
    assert np.abs(down[10:]).max() <= 0.015 * top * (1 + 1e-6)


def test_a_load_factor_counts_on_within_its_stage():
    """On top of a load that is kept, to a share of the factor and back."""
    tables = (
        {"load": "a", "control": "force", "to": "200 N"},
        {"load": {"a": 0.5, "b": 0.5}, "to": ["12 um", "10 % of load", "16 um"]},
    )
    steps = list(Simulation(small_beam(**TWO, stage=list(tables))).steps())
    turn = next(k for k, s in enumerate(steps) if s.gauge == 12e-6)
    low = min(steps[turn:], key=lambda s: s.gauge)
    assert steps[turn].forces["b"] > 200.0
    for name, before in (("a", 200.0), ("b", 0.0)):
        assert low.forces[name] - before == pytest.approx(0.1 * (steps[turn].forces[name] - before), rel=1e-9)
    assert steps[-1].gauge == 16e-6


@pytest.mark.parametrize(
    ("stages", "steps"),
    [
        ([{"to": [2e-5, 1e-5, 4e-5]}], ["101 or more"]),  # ways of 20, 10 and 30, steps of 0.6
        ([{"to": 2e-5}, {"to": 2.4e-5, "max_step": 2e-7}], ["50 or more", "20 or more"]),
        ([{"to": [2e-5, "50 % of load", 4e-5]}], ["61 or more"]),  # 50 steps, 10, and one at least
        ([{"control": "force", "to": 20.0}, {"to": 2e-5}], ["20 or more", "each at most 0.4 µm"]),
    ],
)
def test_check_counts_steps_from_where_a_stage_begins(stages, steps):
    found = check(small_beam(control=None, stage=stages)).stages
    for (_, told), expected in zip(found, steps, strict=True):
        assert told.startswith(expected)
