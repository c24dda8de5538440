"""Runs that end early and go on have the same bits as runs that were left alone."""

import json
import os
import re
import shutil
from functools import partial

import numpy as np
import pytest

import fissura
from conftest import small_beam
from fissura.case.continued import as_data, continued
from fissura.errors import InputError, RunStopped
from remembered import REMEMBERED
from sameness import assert_same, rows, summary

#: What must be remembered, some of it in smaller specimens or shorter runs, for these write files.
CASES = {
    **REMEMBERED,
    "full resolution": {"discretization__l_f": 0.012, "discretization__l_c": 0.03},
    "field": {**REMEMBERED["field"], "control__target": 5e-5},
    "two levels": {**REMEMBERED["two levels"], "output__vtk": 0},
    "coarsening in blocks": {**REMEMBERED["coarsening"], "discretization__placement": "blocks"},
}


def build(name, **changes):
    return small_beam(**{"output__vtk": 2, "output__checkpoint": 1e-3, **CASES[name], **changes})


@pytest.fixture
def no_pictures(monkeypatch):
    monkeypatch.setattr("fissura.running.recorder.Recorder._draw", lambda *_: None)


@pytest.fixture
def all_checkpoints(monkeypatch):
    """Every step is followed by a checkpoint, whatever it costs."""
    monkeypatch.setattr("fissura.running.saving._SHARE", np.inf)
    monkeypatch.setattr("fissura.running.saving.CheckpointWriter.due", True)


@pytest.fixture
def few_checkpoints(monkeypatch):
    """Every third step is followed by a checkpoint."""
    monkeypatch.setattr(
        "fissura.running.saving.CheckpointWriter.due", property(lambda self: self._state.state.number % 3 == 0)
    )


def killed(case, folder, at, **options):
    """Run to the end; what a kill after some steps would have left is in folders of their numbers."""
    run = folder / "run"

    def keep(step):
        if step.number in at:
            shutil.copytree(run, folder / str(step.number))

    fissura.run(case, output=run, on_step=keep, **options)
    return run


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("at", [(19,), pytest.param((3, 10, 14, 22), marks=pytest.mark.slow)])
def test_a_killed_run_goes_on_with_the_same_bits(name, at, tmp_path, no_pictures, few_checkpoints):
    case, full = build(name), name == "full resolution"
    run = killed(case, tmp_path, at, full=full)
    for number in at:
        seen = []
        folder = tmp_path / str(number)
        assert summary(folder)["status"] == "running"
        result = fissura.run(case, output=folder, resume=True, full=full, on_step=seen.append)
        assert seen[0].number == number // 3 * 3 + 1
        assert_same(folder, run)
        assert sorted(result.snapshots)[-1] == result.steps
        assert not list(folder.glob(".section*"))


def test_what_is_saved_does_not_disturb(tmp_path, no_pictures):
    fissura.run(build("refinement", output__checkpoint=0), output=tmp_path / "none")
    fissura.run(build("refinement"), output=tmp_path / "many")
    assert_same(tmp_path / "none", tmp_path / "many")
    assert not (tmp_path / "none" / "checkpoint.npz").exists()


def test_checkpoints_are_small(tmp_path, no_pictures):
    result = fissura.run(build("full resolution", output__vtk=0), output=tmp_path, full=True)
    rest = 8 * sum(len(values) for values in result.curve.values()) + 20_000
    assert (tmp_path / "checkpoint.npz").stat().st_size < 1000 * result.summary["bodies_end"] + rest


def interrupting(at, error=KeyboardInterrupt):
    def interrupt(step):
        if step.number == at:
            raise error

    return interrupt


def test_an_interrupted_run_goes_on(tmp_path, no_pictures):
    """More than once. It has no checkpoints but those of its ends."""
    case = build("refinement", output__checkpoint="1 h", control__stop_load=0.8)
    fissura.run(case, output=tmp_path / "run")
    folder = tmp_path / "again"
    for at in (4, 20, 21):
        with pytest.raises(KeyboardInterrupt):
            fissura.run(case, output=folder, resume=at > 4, on_step=interrupting(at))
        assert summary(folder)["status"] == "interrupted"
        assert len(fissura.Result.load(folder).curve["step"]) == at
    fissura.run(case, output=folder, resume=True)
    assert_same(folder, tmp_path / "run")


def test_a_stopped_run_tries_the_step_again(tmp_path, no_pictures, monkeypatch):
    case = build("refinement")
    fissura.run(case, output=tmp_path / "run")
    with monkeypatch.context() as inside:
        inside.setattr("fissura.simulation.discretization.Discretization.refine", partial(_fails, MemoryError()))
        with pytest.raises(RunStopped):
            fissura.run(case, output=tmp_path / "again")
    assert summary(tmp_path / "again")["status"] == "stopped"
    fissura.run(case, output=tmp_path / "again", resume=True)
    assert_same(tmp_path / "again", tmp_path / "run")


def _fails(error, *_):
    raise error


# --- a larger target -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["refinement", pytest.param("coarsening", marks=pytest.mark.slow), "energy"])
def test_a_run_to_a_larger_target_is_one_with_the_same_steps(name, tmp_path, no_pictures):
    steps = {key: value for key, value in CASES[name].items() if key != "control__stop_load"}
    near = small_beam(**steps, control__target=4e-5, output__vtk=0)
    control = near.control
    fissura.run(near, output=tmp_path / "again")
    first = len(rows(tmp_path / "again")["step"])
    fissura.run(small_beam(**steps, control__target=8e-5, output__vtk=0), output=tmp_path / "again", resume=True)
    whole = small_beam(
        **steps,
        control__target=8e-5,
        control__max_step=control.max_step,
        control__first_step=control.first_step,
        control__min_step=control.min_step,
        control__energy_step=control.energy_step,
        output__vtk=0,
    )
    fissura.run(whole, output=tmp_path / "run")
    assert 10 < first < len(rows(tmp_path / "run")["step"])
    assert_same(tmp_path / "again", tmp_path / "run")
    assert json.loads((tmp_path / "again" / "case.json").read_text())["control"]["target"] == 8e-5


def test_states_that_were_written_stay_when_the_target_moves(tmp_path, no_pictures):
    for target in (2e-5, 4e-5):
        case = build("refinement", control__target=target, output__vtk=4)
        fissura.run(case, output=tmp_path, resume=target > 2e-5)
    listed = re.findall(r'file="(.*?)"', (tmp_path / "bodies.pvd").read_text())
    assert sorted(listed) == sorted(path.name for path in tmp_path.glob("bodies_*.vtu"))
    assert len(listed) in (7, 8)  # four on the way to each target, of which some may be the same, and the peak
    assert not list(tmp_path.glob(".section*"))


def test_a_run_that_has_ended_is_left_alone(tmp_path, no_pictures):
    case = build("refinement")
    fissura.run(case, output=tmp_path)
    before = {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in tmp_path.iterdir()}
    begun = []
    for target in (1e-4, 5e-5):
        case = build("refinement", control__target=target)
        result = fissura.run(case, output=tmp_path, resume=True, on_start=begun.append)
    assert result.steps == len(rows(tmp_path)["step"])
    assert before == {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in tmp_path.iterdir()}
    assert not begun


STAGES = {key: value for key, value in CASES["stages"].items() if key != "gravity"} | {"output__vtk": 0}
FIRST = [{"load": "side", "control": "force", "to": 50.0, "max_step": 5.0}, {"load": "load", "to": [2e-5, 1e-5, 3e-5]}]
ONE_MORE = {"load": "load", "to": ["10 % of load", 5e-5], "max_step": 1e-6}


def test_a_programme_goes_on_with_further_stages(tmp_path, no_pictures):
    fissura.run(small_beam(**{**STAGES, "stage": FIRST}), output=tmp_path / "again")
    longer = small_beam(**{**STAGES, "stage": [*FIRST, ONE_MORE]})
    fissura.run(longer, output=tmp_path / "again", resume=True)
    fissura.run(longer, output=tmp_path / "run")
    assert_same(tmp_path / "again", tmp_path / "run")


@pytest.mark.parametrize(
    ("stages", "key", "problem"),
    [
        ([FIRST[0], {"load": "load", "to": [2e-5, 3e-5]}], "stage[1].to", "3e-05 is not as far as 1e-05"),
        ([FIRST[0], {"load": "load", "to": [2.5e-5, 1e-5, 3e-5]}], "stage[1].to", "targets that have been reached"),
        ([FIRST[0], {"load": "load", "to": [2e-5, 1.5e-5, 3e-5]}], "stage[1].to", "1.5e-05 is not as far as 1e-05"),
        (
            [FIRST[0], {"load": "load", "to": [2e-5, "5 % of load", 3e-5]}],
            "stage[1].to",
            "target 2, to which the run was",
        ),
        ([FIRST[0], {**FIRST[1], "tolerance": 1e-3}], "--resume", "stage[1].tolerance was 0.0001 and is now 0.001"),
        ([{**FIRST[0], "to": 40.0}, FIRST[1]], "--resume", "stage[0].to"),
        ([*FIRST, {"load": "side", "control": "displacement", "to": 1e-5}], "--resume", "stage[2] drives or controls"),
    ],
)
def test_what_a_programme_has_done_cannot_change(stages, key, problem):
    case, earlier = (small_beam(**{**STAGES, "stage": found}) for found in (stages, FIRST))
    with pytest.raises(InputError) as caught:
        continued(case, as_data(earlier), 2, 2e-5, finished=False)
    assert caught.value.key == key
    assert problem in caught.value.problem


def test_what_a_programme_has_not_begun_may_change():
    case = small_beam(**{**STAGES, "stage": [FIRST[0], {"load": "load", "to": [3e-5, 0.0, 1e-5]}, ONE_MORE]})
    earlier = as_data(small_beam(**{**STAGES, "stage": FIRST}))
    assert continued(case, earlier, 1, 0.0, finished=False) == case
    with pytest.raises(InputError, match="targets that have been reached"):
        continued(case, earlier, 2, 2e-5, finished=False)


@pytest.mark.parametrize(
    ("to", "farther", "nearer"),
    [
        ([{"to": 2e-5}, {"to": 1e-5}], [{"to": 2e-5}, {"to": 5e-6}], [{"to": 2e-5}, {"to": 1.5e-5}]),
        ([{"to": [2e-5, "50 % of load", 5e-6]}], [{"to": [2e-5, "50 % of load", 3e-6]}], None),
    ],
)
def test_farther_is_seen_from_where_a_way_began(to, farther, nearer, tmp_path, no_pictures):
    steps = {"max_step": 1e-6, "first_step": 2.5e-7, "min_step": 1e-9}

    def staged(stages):
        stages = [{"load": "load", **steps, **stage} for stage in stages]
        return small_beam(control=None, stage=stages, output__vtk=0)

    fissura.run(staged(to), output=tmp_path / "again")
    if nearer:
        with pytest.raises(InputError, match="is not as far as 1e-05"):
            fissura.run(staged(nearer), output=tmp_path / "again", resume=True)
    again = fissura.run(staged(farther), output=tmp_path / "again", resume=True)
    run = fissura.run(staged(farther))
    # Not bit for bit: ways that do not begin at zero have other last bits, and the step to the first end may be short.
    for column in ("gauge_m", "load_N", "dissipated_J"):
        assert again.curve[column][-1] == pytest.approx(run.curve[column][-1], rel=1e-6)


def test_stages_that_are_gone_are_named():
    earlier = as_data(small_beam(**{**STAGES, "stage": [*FIRST, ONE_MORE]}))
    with pytest.raises(InputError, match=r"run so far: stage\[2\] is gone \("):
        continued(small_beam(**{**STAGES, "stage": FIRST}), earlier, 3 + 1, 3e-5, finished=False)


def test_a_run_that_was_killed_at_its_end_is_completed(tmp_path, no_pictures, all_checkpoints):
    case = build("refinement", control__stop_load=0.9)
    last = fissura.run(case, output=tmp_path / "first").steps
    run = killed(case, tmp_path, (last,))
    fissura.run(case, output=tmp_path / str(last), resume=True)
    assert_same(tmp_path / str(last), run)


# --- what is refused -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ended")
    with pytest.raises(KeyboardInterrupt):
        fissura.run(build("refinement", output__vtk=0), output=folder, on_step=interrupting(3))
    return folder


def refused(folder, case=None, **options):
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    with pytest.raises(InputError) as caught:
        fissura.run(case or build("refinement", output__vtk=0), output=folder, resume=True, **options)
    assert before == {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    return caught.value


def test_another_case_is_refused_with_the_keys_that_differ(ended):
    case = build("refinement", output__vtk=0, control__tolerance=1e-3, notch__depth=0.02, seed=3)
    error = refused(ended, case)
    assert error.key == "--resume"
    for text in (
        "control.tolerance was 0.0001 and is now 0.001",
        "notch[0].depth was 0.03 and is now 0.02",
        "seed was",
    ):
        assert text in error.problem


def test_steps_that_are_given_are_compared(ended):
    error = refused(ended, build("refinement", output__vtk=0, control__target=2e-4, control__max_step=3e-6))
    assert "control.max_step was 2e-06 and is now 3e-06" in error.problem


def test_a_smaller_target_is_refused(ended):
    error = refused(ended, build("refinement", output__vtk=0, control__target=5e-5))
    problem = "5e-05 is not as far as 0.0001, to which the run was on the way"
    assert (error.key, error.problem) == ("control.target", problem)


def test_full_resolution_is_refused(ended):
    assert refused(ended, full=True).key == "--full"


def test_another_specimen_is_refused(ended, monkeypatch):
    nuclei = fissura.simulation.discretization.nuclei_from_case
    monkeypatch.setattr(
        fissura.simulation.discretization,
        "nuclei_from_case",
        lambda case, domain: nuclei(case.model_copy(update={"seed": 9}), domain),
    )
    assert "the specimen is not the one of the checkpoint" in refused(ended).problem


def test_other_versions_are_told(ended, tmp_path, monkeypatch, caplog, no_pictures):
    shutil.copytree(ended, tmp_path / "run")
    monkeypatch.setattr("fissura.running.resuming.versions", lambda: {"numpy": "9.9"})
    fissura.run(build("refinement", output__vtk=0), output=tmp_path / "run", resume=True)
    assert "now 9.9: what follows may differ in the last bits" in caplog.text


def test_a_folder_without_a_checkpoint_is_refused(tmp_path):
    error = refused(tmp_path)
    assert "has no checkpoint.npz" in error.problem
    assert "--overwrite" in error.allowed
    with pytest.raises(InputError, match="has no checkpoint"):
        fissura.run(build("refinement"), output=tmp_path / "none", resume=True)
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("damage", ["cut", "empty", "text", "a class", "a field", "newer"])
def test_a_damaged_checkpoint_is_refused(damage, ended, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(ended, folder)
    path = folder / "checkpoint.npz"
    if damage in ("cut", "empty"):
        os.truncate(path, 0 if damage == "empty" else path.stat().st_size // 2)
    else:
        with np.load(path) as archive:
            found = {name: archive[name] for name in archive.files}
        text = {
            "text": {"text": np.frombuffer(b"{", np.uint8)},
            "a class": {"text": np.frombuffer(found["text"].tobytes().replace(b'"State"', b'"Path"'), np.uint8)},
            "a field": {"text": np.frombuffer(found["text"].tobytes().replace(b'"totals"', b'"sums"'), np.uint8)},
            "newer": {"format_version": np.array(99)},
        }[damage]
        np.savez(path, **(found | text))
    error = refused(folder)
    assert error.key == str(path)
    assert "--overwrite" in error.allowed
    assert ("another version of Fissura" in error.problem) == (damage in ("text", "a class", "a field"))


def test_missing_sections_are_refused(ended, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(ended, folder)
    (folder / "section.npz").unlink()
    assert "section.npz" in str(refused(folder))


def test_resuming_needs_a_folder():
    with pytest.raises(InputError, match="goes on with the run in a folder"):
        fissura.run(build("refinement"), resume=True)


# --- a full disk -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("where", ["curve", "checkpoint", "states"])
def test_a_run_goes_on_after_the_disk_was_full(where, tmp_path, no_pictures, few_checkpoints, monkeypatch):
    case = build("refinement")
    fissura.run(case, output=tmp_path / "run")
    folder = tmp_path / "again"
    place = {
        "curve": "fissura.results.curve_writer.CurveWriter.write",
        "checkpoint": "fissura.running.saving.write_checkpoint",
        "states": "fissura.running.chosen.write_snapshot",
    }[where]

    def fill(step):
        if step.number == 11:
            inside.setattr(place, partial(_fails, OSError(28, "No space left on device")))

    with monkeypatch.context() as inside, pytest.raises(OSError, match="No space"):
        fissura.run(case, output=folder, on_step=fill)
    assert summary(folder)["status"] == "failed"
    fissura.run(case, output=folder, resume=True)
    assert_same(folder, tmp_path / "run")
