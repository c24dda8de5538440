"""Bodies and cracks in a page against the states that they were made of."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from fissura.reports.bodies import MOST_STEPS, chosen, shown_steps, states_of
from fissura.reports.packed import packed_size
from fissura.results import Result
from fissura.running.recorder import Recorder
from results.synthetic import random_points, simulation, snapshot, stack, step, voronoi_structure

from .unpacking import dequantised

SIZE = np.array([0.02, 0.01, 0.01])


@pytest.fixture(scope="module")
def structure():
    return voronoi_structure(random_points(60, SIZE), SIZE)


def shot_of(structure, seed=3):
    rng = np.random.default_rng(seed)
    moved = 1e-6 * rng.normal(size=(len(structure), 6))
    opening = np.where(rng.random(len(structure.contacts)) < 0.3, 5e-6 * rng.random(len(structure.contacts)), 0.0)
    return snapshot(structure, moved, opening)


def result_of(shots, **changes):
    recorder = Recorder(simulation(vtk=len(shots)), None)
    for number, shot in enumerate(shots, 1):
        recorder.add(step(number, 1e-4 * number / len(shots), 100.0, shot, **changes))
    return recorder.finish("finished")


def corners(polygons):
    return np.stack([dequantised(axis) for axis in polygons["points"]], axis=1)


def moves(polygons):
    return np.stack([dequantised(axis) for axis in polygons["moved"]], axis=1)


def area_of(points, sizes):
    total = 0.0
    for a, b in pairwise([0, *np.cumsum(sizes).tolist()]):
        polygon = points[a:b]
        total += np.linalg.norm(np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0]).sum(axis=0)) / 2
    return total


def test_the_skin_is_the_surface_of_the_specimen(structure):
    (state,) = states_of(result_of([shot_of(structure)]), [1])
    skin = state["skin"]
    whole = 1e6 * 2 * (SIZE[0] * SIZE[1] + SIZE[1] * SIZE[2] + SIZE[2] * SIZE[0])
    assert area_of(corners(skin), skin["sizes"]) == pytest.approx(whole, rel=1e-3)
    assert len(skin["sizes"]) == len(structure.surface.polygons)


def test_corners_move_with_their_bodies(structure):
    shot = shot_of(structure)
    (state,) = states_of(result_of([shot]), [1])
    points, moved = corners(state["skin"]), moves(state["skin"])
    resolution = 1e3 * SIZE.max() / 65535
    # Each corner on the surface belongs to one of the bodies that have a corner there.
    polygons = structure.surface.polygons
    body = structure.surface.body[np.repeat(polygons.facet, np.diff(polygons.offsets))]
    q, r = shot.displacement[body], polygons.points - structure.x[body]
    expected = 1e3 * (q[:, :3] + np.cross(q[:, 3:], r))
    known = 1e3 * polygons.points
    for point, by in zip(points, moved, strict=True):
        near = np.flatnonzero(np.abs(known - point).max(axis=1) < 2 * resolution)
        assert len(near)
        assert np.abs(expected[near] - by).max(axis=1).min() < 2e-4 * np.abs(expected).max()


def test_cracks_are_the_contacts_with_damage(structure):
    shot = shot_of(structure)
    (state,) = states_of(result_of([shot]), [1])
    cracks, damaged = state["cracks"], shot.damage > 0
    assert len(cracks["sizes"]) == damaged.sum()
    assert area_of(corners(cracks), cracks["sizes"]) == pytest.approx(
        1e6 * structure.contacts.area[damaged].sum(), rel=1e-3
    )
    opening = np.sort(1e6 * shot.opening[damaged])
    np.testing.assert_allclose(np.sort(dequantised(cracks["opening"])), opening, atol=opening.max() / 65535)
    np.testing.assert_allclose(dequantised(cracks["damage"]), 0.9, atol=1e-4)
    assert cracks["left_out"] == 0


def test_an_unharmed_body_at_rest():
    (state,) = states_of(result_of([snapshot(stack())]), [1])
    assert len(state["cracks"]["sizes"]) == 0
    assert state["skin"]["moved"] is None


def test_the_stress_of_bodies(structure):
    shot = shot_of(structure)
    shot = replace(shot, stress=np.linspace(-1e6, 3e6, len(structure))[:, None, None] * np.eye(3))
    (state,) = states_of(result_of([shot]), [1])
    found = dequantised(state["skin"]["stress"])
    assert found.min() >= -1.0
    assert found.max() <= 3.0
    facets = np.bincount(structure.surface.body, minlength=len(structure)) > 0
    expected = np.linspace(-1.0, 3.0, len(structure))[facets]
    np.testing.assert_allclose(np.unique(found.round(3)), np.unique(expected.round(3)), atol=2e-3)


# What does not fit


def curve_of(energy, load=None):
    count = len(energy)
    load = np.ones(count) if load is None else np.asarray(load, float)
    curve = {"step": np.arange(1, count + 1), "dissipated_J": np.asarray(energy, float), "load_N": load}
    return SimpleNamespace(curve=curve, snapshots=dict.fromkeys(range(1, count + 1)), folder=None)


def test_all_steps_where_they_are_few():
    assert chosen(curve_of([0, 1, 2]), [1, 2, 3], 5) == [1, 2, 3]


@pytest.mark.parametrize("most", [1, 2, 3, 10])
def test_as_many_steps_as_wanted_with_the_last_and_the_peak(most):
    load = np.sin(np.linspace(0, 3, 50))
    found = chosen(curve_of(np.linspace(0, 1, 50), load), range(1, 51), most)
    assert len(found) == most
    assert found == sorted(found)
    assert found[-1] == 50
    assert most == 1 or int(np.argmax(load)) + 1 in found


def test_steps_are_chosen_evenly_by_energy():
    energy = np.linspace(0, 1, 101) ** 4
    found = chosen(curve_of(energy), range(1, 102), 9)
    gaps = np.diff(energy[np.array(found) - 1])
    assert gaps.max() < 0.3
    assert np.median(np.array(found)) > 60  # where energy is dissipated


def test_steps_of_an_elastic_run_are_chosen_evenly_by_number():
    found = chosen(curve_of(np.zeros(101)), range(1, 102), 5)
    assert np.diff(found).max() <= 51
    assert len(found) == 5


def test_there_is_a_limit_to_the_number_of_steps():
    count = MOST_STEPS + 40
    assert len(shown_steps(curve_of(np.arange(count)))) == MOST_STEPS


def test_steps_are_left_out_where_they_would_take_too_much(structure):
    result = result_of([shot_of(structure, seed) for seed in range(6)])
    steps = shown_steps(result)
    states = states_of(result, steps)
    assert [state["number"] for state in states] == steps
    most = packed_size(states) // 2
    fewer = states_of(result, steps, most)
    assert 1 <= len(fewer) < len(steps)
    assert packed_size(fewer) <= most
    assert fewer[-1]["number"] == steps[-1]


def test_the_least_open_cracks_are_left_out_next(structure):
    shot = shot_of(structure)
    result = result_of([shot])
    (whole,) = states_of(result, [1])
    most = packed_size([whole]) - 500
    (part,) = states_of(result, [1], most)
    count = len(whole["cracks"]["sizes"])
    kept = len(part["cracks"]["sizes"])
    assert part["cracks"]["left_out"] == count - kept > 0
    assert (
        dequantised(part["cracks"]["opening"]).min() >= np.sort(dequantised(whole["cracks"]["opening"]))[count - kept]
    )
    assert sum(part["cracks"]["sizes"]) == len(part["cracks"]["points"][0]["codes"])
    assert sum(part["cracks"]["sizes"]) == len(part["cracks"]["moved"][0]["codes"])
    assert packed_size([part]) <= most
    assert states_of(result, [1], 1000) == []


def test_states_are_the_same_from_memory_and_from_files(structure, tmp_path):
    recorder = Recorder(simulation(vtk=2), tmp_path)
    for number in (1, 2):
        recorder.add(step(number, 5e-5 * number, 100.0, shot_of(structure, number)))
    result = recorder.finish("finished")
    loaded = replace(Result.load(tmp_path), snapshots={})
    assert shown_steps(loaded) == shown_steps(result) == [1, 2]
    for a, b in zip(states_of(result, [1, 2]), states_of(loaded, [1, 2]), strict=True):
        assert packed_size(a) == packed_size(b)
        np.testing.assert_array_equal(a["skin"]["points"][0]["codes"], b["skin"]["points"][0]["codes"])
        np.testing.assert_array_equal(a["cracks"]["opening"]["codes"], b["cracks"]["opening"]["codes"])
