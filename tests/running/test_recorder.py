import json
import logging
import os
import signal
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import fissura.results.curve as curve_module
import fissura.running.recorder as recorder_module
from fissura.errors import InputError
from fissura.machine.interrupts import interruptible
from fissura.results import Result, read_curve
from fissura.running.recorder import Recorder
from results.synthetic import simulation, snapping, steps

LOADS = [100.0, 200.0, 300.0, 250.0, 220.0, 200.0, 180.0, 150.0, 120.0, 100.0]


def record(folder, loads=LOADS, **output):
    recorder = Recorder(simulation(**output), folder)
    for step in steps(loads):
        recorder.add(step)
    return recorder.finish("finished")


def test_snapshots_are_evenly_spaced_plus_peak_and_last():
    assert list(record(None, vtk=2).snapshots) == [3, 5, 10]
    assert list(record(None, vtk=4).snapshots) == [3, 5, 8, 10]
    assert list(record(None, vtk=0).snapshots) == [3, 10]


def test_a_long_step_stands_for_several_snapshots():
    recorder = Recorder(simulation(vtk=5), None)
    for step in steps([10.0, 20.0]):
        recorder.add(step)
    assert list(recorder.finish("finished").snapshots) == [1, 2]


def test_snapshots_follow_the_fall_of_the_load_where_energy_leads():
    recorder = Recorder(simulation({"type": "dissipation", "stop_load": 0.1}, vtk=3), None)
    for step in snapping():
        recorder.add(step)
    # Shares after the peak at step 3: 1/3 of the load is lost of the 0.9 to lose, then 0.8, then 0.9.
    assert list(recorder.finish("finished").snapshots) == [3, 4, 5, 6]


def test_a_run_led_by_energy_reloads(tmp_path):
    recorder = Recorder(simulation({"type": "dissipation"}), tmp_path)
    for step in snapping():
        recorder.add(step)
    result, again = recorder.finish("finished"), Result.load(tmp_path)
    assert result.led_by_energy.tolist() == again.led_by_energy.tolist() == [False] * 2 + [True] * 4
    assert dict(again.table())["steps"].startswith("6 (4 under dissipation control) with")
    assert 'timestep="3"' in (tmp_path / "bodies.pvd").read_text()


def test_files_of_a_run(tmp_path):
    folder = tmp_path / "new" / "run"
    result = record(folder)
    vtu = {f"{kind}_{number:04d}.vtu" for kind in ("bodies", "contacts") for number in (3, 5, 10)}
    others = {
        ".fissura", "bodies.pvd", "contacts.pvd", "case.json", "curve.csv", "curve.png", "crack.png", "run.log",
        "summary.json", "state_last.npz", "section.npz",
    }  # fmt: skip
    assert {p.name for p in folder.iterdir()} == vtu | others
    assert all(p.stat().st_size > 0 for p in folder.iterdir())
    assert result.folder == folder


def test_no_vtk_files_when_none_are_wanted(tmp_path):
    record(tmp_path, vtk=0)
    assert not [p for p in tmp_path.iterdir() if p.suffix in (".vtu", ".pvd")]


def test_result_reloads(tmp_path):
    result = record(tmp_path)
    again = Result.load(tmp_path)
    assert again.case == result.case
    assert again.summary == result.summary
    assert again.full is False
    for name, values in result.curve.items():
        if name == "control":
            assert again.curve[name].tolist() == values.tolist()
        else:
            np.testing.assert_allclose(again.curve[name], values, rtol=1e-11)
    assert list(again.snapshots) == [10]
    np.testing.assert_array_equal(again.last.opening, result.last.opening)


def test_a_killed_run_keeps_its_curve_and_summary(tmp_path):
    recorder = Recorder(simulation(), tmp_path)
    for count, step in enumerate(steps(LOADS)[:4], 1):
        recorder.add(step)
        assert len(read_curve(tmp_path)["step"]) == count
    result = Result.load(tmp_path)
    assert result.summary["status"] == "running"
    assert result.peak_load == 300.0
    assert result.snapshots == {}
    recorder.finish("interrupted")


def test_text_of_the_case_is_copied(tmp_path):
    source = "# as written\n"
    plain = simulation()
    plain.case.__dict__["source"] = source
    Recorder(plain, tmp_path).finish("stopped", "nothing happened")
    assert (tmp_path / "case.toml").read_text() == source
    assert json.loads((tmp_path / "case.json").read_text())["seed"] == 7


def test_run_without_steps(tmp_path):
    result = Recorder(simulation(), tmp_path).finish("stopped", "no equilibrium in the first step")
    assert result.steps == 0
    assert np.isnan(result.peak_load)
    assert "no equilibrium" in repr(result)
    assert "no equilibrium" in repr(Result.load(tmp_path))
    assert not (tmp_path / "curve.png").exists()


def test_files_of_an_earlier_run_are_removed_and_others_kept(tmp_path):
    record(tmp_path, vtk=5)
    (tmp_path / "notes.txt").write_text("mine")
    record(tmp_path, LOADS[:1], vtk=0)
    assert not list(tmp_path.glob("*.vtu"))
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert len(read_curve(tmp_path)["step"]) == 1


def test_folder_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        Recorder(simulation(), tmp_path / "file")


def test_times_count_from_the_start_of_the_simulation():
    started = SimpleNamespace(**vars(simulation()), cpu_start=-1000.0, wall_start=-2000.0)
    recorder = Recorder(started, None)
    recorder.add(steps(LOADS)[0])
    result = recorder.finish("finished")
    assert result.curve["cpu_s"][0] > 1000
    assert result.summary["wall_s"] > 2000


def test_warnings_are_logged(caplog):
    recorder = Recorder(simulation(), None)
    for step in steps(LOADS, max_elastic_utilisation=1.5):
        recorder.add(step)
    with caplog.at_level(logging.WARNING):
        recorder.finish("finished")
    assert "1.50 times their strength" in caplog.text


def test_only_files_of_the_earlier_run_are_removed(tmp_path):
    record(tmp_path, vtk=1)
    for name in ("bodies_9999.vtu", "contacts_0001.vtu", "moments.png", "photo.jpg"):
        (tmp_path / name).write_text("mine")
    record(tmp_path, LOADS[:2], vtk=0)
    for name in ("bodies_9999.vtu", "contacts_0001.vtu", "moments.png", "photo.jpg"):
        assert (tmp_path / name).read_text() == "mine"
    assert sorted(path.name for path in tmp_path.glob("*.vtu")) == ["bodies_9999.vtu", "contacts_0001.vtu"]


def statuses(folder, monkeypatch):
    """Every status that is written from here on, with the files that are there then."""
    found, write = [], recorder_module.write_summary

    def note(path, summary):
        found.append((summary["status"], {p.name for p in folder.iterdir()}))
        write(path, summary)

    monkeypatch.setattr(recorder_module, "write_summary", note)
    return found


def test_the_final_status_comes_last(tmp_path, monkeypatch):
    found = statuses(tmp_path, monkeypatch)
    record(tmp_path)
    assert [status for status, _ in found[:-1]] == ["running"] * (len(found) - 1)
    status, files = found[-1]
    assert status == "finished"
    assert {"state_last.npz", "section.npz", "crack.png", "curve.png", "bodies_0010.vtu"} <= files


def test_the_summary_is_not_written_after_every_step(tmp_path, monkeypatch):
    found = statuses(tmp_path, monkeypatch)
    now = [0.0]
    monkeypatch.setattr(recorder_module.time, "monotonic", lambda: now[0])
    recorder = Recorder(simulation(vtk=0), tmp_path)
    for step in steps(LOADS):
        now[0] += 0.3
        recorder.add(step)
    assert len(found) == 1 + 2  # at the start, and each time a second has passed
    recorder.finish("finished")
    assert len(found) == 4


@pytest.mark.parametrize("error", [ValueError("bad font"), MemoryError(), OSError("full")])
def test_no_picture_ends_a_run(tmp_path, monkeypatch, caplog, error):
    def fail(*_):
        raise error

    monkeypatch.setattr("fissura.pictures.crack.plot_crack", fail)
    monkeypatch.setattr("fissura.pictures.curves.plot_curve", fail)
    result = record(tmp_path)
    assert result.summary["status"] == Result.load(tmp_path).summary["status"] == "finished"
    for name in ("crack.png", "curve.png"):
        assert f"{name} was not drawn: {str(error) or 'MemoryError'}" in caplog.text


def test_an_interruption_while_pictures_are_drawn_keeps_everything_else(tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("fissura.pictures.crack.plot_crack", interrupt)
    with pytest.raises(KeyboardInterrupt) as caught:
        record(tmp_path)
    assert caught.value.result.steps == 10
    again = Result.load(tmp_path)
    assert again.summary["status"] == "finished"
    assert list(again.snapshots) == [10]
    assert (tmp_path / "section.npz").exists()
    assert not (tmp_path / "curve.png").exists()


def test_a_full_disk_at_the_end_is_no_finished_run(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device", "state_last.npz")

    monkeypatch.setattr(recorder_module, "write_state", full)
    with pytest.raises(OSError, match="No space left") as caught:
        record(tmp_path)
    assert caught.value.result.steps == 10
    summary = Result.load(tmp_path).summary
    assert summary["status"] == "failed"
    assert "not all files could be written" in summary["message"]
    assert "No space left" in summary["message"]


@pytest.mark.skipif(sys.platform == "win32", reason="sends signals")
def test_a_signal_waits_until_a_step_is_recorded(tmp_path, monkeypatch):
    recorder = Recorder(simulation(), tmp_path)
    first, second = steps(LOADS)[:2]
    recorder.add(first)
    writer, write = recorder._curve, recorder._curve.write

    def interrupted(values):
        os.kill(os.getpid(), signal.SIGTERM)
        write(values)

    monkeypatch.setattr(writer, "write", interrupted)
    before = signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        with interruptible(lambda _: None), pytest.raises(KeyboardInterrupt):
            recorder.add(second)
    finally:
        signal.signal(signal.SIGTERM, before)
    result = recorder.finish("interrupted")
    assert result.steps == len(read_curve(tmp_path)["step"]) == 2
    assert list(Result.load(tmp_path).snapshots) == [2]


def test_recording_costs_the_same_at_every_step(tmp_path, monkeypatch):
    """What is looked at for a step does not grow with the steps before it."""
    rows = [0]
    make = curve_module.columns

    def count(some):
        some = list(some)
        rows[0] += len(some)
        return make(some)

    monkeypatch.setattr(curve_module, "columns", count)
    written, now = [], iter(range(10**6))
    monkeypatch.setattr(recorder_module, "write_summary", lambda path, summary: written.append(summary["steps"]))
    monkeypatch.setattr(recorder_module.time, "monotonic", lambda: next(now))  # a summary for every step
    recorder = Recorder(simulation(vtk=0), tmp_path)
    recorder._history = SimpleNamespace(add=lambda _: None, write=lambda _: None, frames=())
    for step in steps([100.0] * 200):
        recorder.add(step)
    assert written == list(range(201))
    assert rows[0] == 200
    assert len(recorder.finish("stopped").curve["step"]) == 200


def test_run_survives_a_measured_band_that_has_gone(tmp_path, caplog):
    band = tmp_path / "band.csv"
    band.write_text("0.01,1,2\n")
    recorder = Recorder(simulation(measured=str(band)), tmp_path / "run")
    band.unlink()
    recorder.add(steps(LOADS)[0])
    recorder.finish("finished")
    assert "curve.png was not drawn" in caplog.text
    assert Result.load(tmp_path / "run").case.output.measured == band
