import json

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import Result
from fissura.results.history import FILE, read_history
from fissura.results.section import outlines
from fissura.running.recorder import Recorder

from .synthetic import random_points, simulation, snapshot, step, voronoi_structure

SIZE = np.array([0.02, 0.01, 0.01])


def structure(count, seed=1):
    return voronoi_structure(random_points(count, SIZE, seed), SIZE, np.arange(count) % 2 == 0)


def state(t, seed=2):
    rng = np.random.default_rng(seed)
    m = len(t.contacts)
    return snapshot(
        t, rng.normal(size=(len(t), 6)) * 1e-5, np.where(rng.uniform(size=m) < 0.3, rng.uniform(size=m), 0.0)
    )


def ended(folder, steps, status="finished", start=None):
    run = simulation(vtk=0)
    if start is not None:
        run.tessellation = start
    recorder = Recorder(run, folder)
    recorder._draw = lambda *_: None  # takes longer than the rest
    for accepted in steps:
        recorder.add(accepted)
    return recorder.finish(status)


def test_motion_is_that_of_rigid_bodies(tmp_path):
    t = structure(60)
    shot = state(t)
    ended(tmp_path, [step(1, 1e-5, 10.0, shot)])
    (frame,) = read_history(tmp_path)
    shapes, z = outlines(frame.section), 0.5 * SIZE[2]
    for k, body in enumerate(frame.section.nucleus):  # nuclei are numbered as bodies here
        for x, y in shapes.points[shapes.offsets[k] : shapes.offsets[k + 1]]:
            u, turn = shot.displacement[body, :3], shot.displacement[body, 3:]
            expected = u + np.cross(turn, [x, y, z] - t.x[body])
            a, b, r = frame.motion[k]
            assert [a - r * y, b + r * x] == pytest.approx(expected[:2], abs=1e-10)


def test_stress_and_openings_of_the_section(tmp_path):
    t = structure(60)
    shot = state(t)
    ended(tmp_path, [step(1, 1e-5, 10.0, shot)])
    (frame,) = read_history(tmp_path)
    assert frame.stress == pytest.approx(2e6)
    assert (frame.opening > 0).any()
    assert (frame.opening == 0).any()
    pairs = frame.section.nucleus[frame.section.sides[: frame.section.contacts]]
    by_pair = {tuple(pair): value for pair, value in zip(t.contacts.bodies.tolist(), shot.opening, strict=True)}
    assert frame.opening == pytest.approx([by_pair[tuple(pair)] for pair in pairs.tolist()], rel=1e-6)


def test_discretizations_may_grow_and_shrink(tmp_path):
    few, many = structure(30), structure(90, seed=3)
    bodies = [few, few, many, many, few]
    steps = [step(k + 1, 1e-5 * (k + 1), 10.0 * k, state(t, k), bodies=len(t)) for k, t in enumerate(bodies)]
    ended(tmp_path, steps, start=few)
    frames = read_history(tmp_path)
    assert [frame.number for frame in frames] == [0, 1, 2, 3, 4, 5]
    assert [frame.bodies for frame in frames] == [30, 30, 30, 90, 90, 30]
    assert frames[0].section is frames[2].section
    assert frames[3].section is frames[4].section
    assert len(frames[3].section.nucleus) > len(frames[5].section.nucleus)
    assert len(frames[5].motion) == len(frames[5].section.nucleus)
    assert not frames[0].motion.any()
    assert [frame.load for frame in frames] == [0.0, 0.0, 10.0, 20.0, 30.0, 40.0]


@pytest.mark.parametrize("status", ["finished", "stopped", "interrupted"])
def test_every_run_that_ended_has_its_section(tmp_path, status):
    ended(tmp_path, [step(1, 1e-5, 10.0)], status)
    assert len(read_history(tmp_path)) == 1


def test_runs_without_a_folder_keep_it_in_memory(tmp_path):
    t = structure(60)
    shots = [step(k, 1e-5 * k, 10.0, state(t, k)) for k in (1, 2)]
    in_memory, written = ended(None, shots).frames, ended(tmp_path, shots)
    assert [frame.gauge for frame in in_memory] == [1e-5, 2e-5]
    for mine, other in zip(in_memory, Result.load(tmp_path).frames, strict=True):
        assert (mine.number, mine.value, mine.load, mine.gauge) == (other.number, other.value, other.load, other.gauge)
        for name in ("motion", "stress", "opening"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(other, name))
    assert written.frames[0].section is written.frames[1].section


def problem(folder):
    with pytest.raises(InputError) as caught:
        read_history(folder)
    return str(caught.value)


def test_folders_that_cannot_be_drawn(tmp_path):
    assert "no such folder" in problem(tmp_path / "nowhere")
    assert "summary.json" in problem(tmp_path)
    running = Recorder(simulation(vtk=0), tmp_path / "running")
    running.add(step(1, 1e-5, 10.0))
    assert "has not ended" in problem(tmp_path / "running")
    running._draw = lambda *_: None
    running.finish("finished")
    assert len(read_history(tmp_path / "running")) == 1
    ended(tmp_path / "none", [])
    assert "no steps" in problem(tmp_path / "none")
    ended(tmp_path / "old", [step(1, 1e-5, 10.0)])
    (tmp_path / "old" / FILE).unlink()
    assert "run again" in problem(tmp_path / "old")


def test_broken_files(tmp_path):
    ended(tmp_path, [step(1, 1e-5, 10.0)])
    good = (tmp_path / FILE).read_bytes()
    (tmp_path / FILE).write_bytes(good[: len(good) // 2])
    assert FILE in problem(tmp_path)
    (tmp_path / FILE).write_bytes((tmp_path / "state_last.npz").read_bytes())
    assert "fissura-section" in problem(tmp_path)
    with np.load(tmp_path / "state_last.npz") as other:
        np.savez(tmp_path / FILE, format="fissura-section", format_version=1, x=other["displacement"])
    assert "lacks the array" in problem(tmp_path)
    np.savez(tmp_path / FILE, format="fissura-section", format_version=2)
    assert "is of version 2" in problem(tmp_path)


def test_the_file_is_small(tmp_path):
    t = structure(300)
    ended(tmp_path, [step(k, 1e-6 * k, 10.0, state(t, k)) for k in range(1, 21)])
    assert (tmp_path / FILE).stat().st_size < (tmp_path / "state_last.npz").stat().st_size
    assert json.loads((tmp_path / "summary.json").read_text())["steps"] == 20
