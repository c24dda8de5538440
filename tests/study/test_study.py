import csv
import io
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib import import_module

import pytest
from distributed import LocalCluster
from rich.console import Console
from typer.testing import CliRunner

from fissura.case.registry import SOLVERS
from fissura.cli import app
from fissura.errors import InputError
from fissura.machine.kernel_threads import KernelThreads
from fissura.machine.threads import VARIABLE
from fissura.study import runner
from fissura.study.definition import FULL, load_study, study_from_dict
from fissura.study.execute import failed
from fissura.study.progress import StudyProgress
from fissura.study.record import Record
from fissura.study.runner import run_study, write_result

from .models import STUDY, write_study

ONE = STUDY.replace("seeds = [1, 2]", "seeds = [1]").split('[[specimens]]\nname = "deep"')[0]
#: One specimen and seed; the second variation is refused, as its solver cannot be made.
REFUSED = (
    ONE
    + """
[[variations]]
name = "default"
[[variations]]
name = "gone"
change.solver.linear = "guess"
"""
)


def no_solver(*_, **__):
    raise InputError("solver.linear", "'guess' needs a package that is not installed")


@pytest.fixture(autouse=True, scope="module")
def guess():
    SOLVERS["guess"] = no_solver
    yield
    del SOLVERS["guess"]


def names(done):
    return [task.variation for task, _, _ in done]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A study that has run to its end: the plan's file, its folder, its outcome, and what was told on the way."""
    folder = tmp_path_factory.mktemp("study")
    path, done = write_study(folder, REFUSED), []
    outcome = run_study(load_study(path), folder / "out", on_done=lambda *told: done.append(told))
    return path, folder / "out", outcome, done


def test_every_run_is_saved_and_told(finished):
    path, folder, outcome, done = finished
    assert names(done) == [FULL, "default", "gone"]
    assert [left for _, _, left in done] == [2, 1, 0]
    assert all((folder / task.path).exists() for task in load_study(path).tasks())
    assert outcome.left == 0


def test_failures_are_kept_and_counted(finished):
    _, folder, outcome, _ = finished
    good, bad = outcome.found
    assert good.finished
    assert good.compared
    assert (bad.variation, bad.end, bad.compared) == ("gone", "refused", False)
    assert "solver.linear" in bad.message
    kept = Record.load(folder / "runs" / "beam" / "seed0001" / "gone.npz")
    assert (kept.status, kept.steps) == ("refused", 0)
    text = (write_result(outcome, folder), (folder / "study.md").read_text())[1]
    assert "2 adaptive runs, 1 of which did not finish" in text
    assert "adaptive refused, full target" in text


def test_what_is_done_is_not_run_again(finished):
    path, folder, first, _ = finished
    again = run_study(load_study(path), folder, on_done=lambda *_: pytest.fail("was run again"))
    assert [m.row() for m in again.found if m.compared] == [m.row() for m in first.found if m.compared]
    shown = run_study(load_study(path), folder, again=["default"], run=False)
    assert (len(shown.found), shown.left) == (1, 1)


def test_only_what_changed_is_run_again(finished, tmp_path):
    path, folder, _, _ = finished
    for text, expected in (
        (REFUSED.replace('"guess"', '"direct"'), ["gone"]),
        (REFUSED.replace("seeds = [1]", "seeds = [1, 2]"), [FULL, "default", "gone"]),
        (REFUSED, []),
    ):
        changed = load_study(write_study(tmp_path, text))
        left = []
        module = import_module("fissura.study.store")
        left = [task.variation for task in module.split(changed.tasks(), folder)[1]]
        assert left == expected
    module = import_module("fissura.study.store")
    tasks = list(load_study(path).tasks())
    assert [t.variation for t in module.split(tasks, folder, ["failures"])[1]] == ["gone"]
    assert [t.variation for t in module.split(tasks, folder, [FULL])[1]] == [FULL]
    with pytest.raises(InputError, match="'defualt' is not known"):
        run_study(load_study(path), folder, again=["defualt"])


def test_tables(finished):
    _, folder, outcome, _ = finished
    paths = write_result(outcome, folder)
    assert {path.name for path in paths} >= {"runs.csv", "study.md", "errors.png"}
    with (folder / "runs.csv").open() as file:
        good, bad = csv.DictReader(file)
    found = outcome.found[0]
    assert float(good["load"]) == pytest.approx(found.load, rel=1e-6)
    assert float(good["indicator_utilisation"]) == pytest.approx(found.indicators["utilisation"], rel=1e-6)
    assert (bad["load"], bad["end"]) == ("", "refused")


def test_an_interrupted_study_goes_on(tmp_path, caplog):
    plan = load_study(write_study(tmp_path, ONE))
    plan = study_from_dict({**plan.study.model_dump(), "variations": [{"name": "default"}]}, tmp_path)

    def interrupt(task, record, left):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(plan, tmp_path / "out", on_done=interrupt)
    done = []
    outcome = run_study(plan, tmp_path / "out", on_done=lambda *told: done.append(told))
    assert names(done) == ["default"]
    assert outcome.left == 0
    broken = next((tmp_path / "out").rglob("default.npz"))
    broken.write_bytes(b"half a file")
    run_study(plan, tmp_path / "out", on_done=lambda *told: done.append(told))
    assert names(done) == ["default", "default"]
    assert f"{broken}: cannot be read; this run counts as missing" in caplog.text


def test_an_unexpected_error_fails_one_run_only(tmp_path, monkeypatch):
    module = import_module("fissura.study.execute")

    class Broken(module.Simulation):
        def steps(self):
            if not self.full:
                raise ZeroDivisionError("nobody thought of this")
            yield from super().steps()

    monkeypatch.setattr(runner, "warm_up", lambda: None)
    monkeypatch.setattr(module, "Simulation", Broken)
    plan = load_study(write_study(tmp_path, ONE))
    plan = study_from_dict({**plan.study.model_dump(), "variations": [{"name": "default"}]}, tmp_path)
    (found,) = run_study(plan, tmp_path / "out").found
    assert (found.end, found.end_full) == ("failed", "target")
    assert found.message == "ZeroDivisionError: nobody thought of this"


@pytest.mark.parametrize(("environment", "expected"), [(None, 1), ("3", 3)])
def test_processes_use_one_thread_unless_told_otherwise(tmp_path, monkeypatch, environment, expected):
    class StartedError(Exception):
        pass

    def start(*_, **__):  # processes inherit the environment of this moment
        raise StartedError(KernelThreads().count)

    monkeypatch.delenv(VARIABLE, raising=False)
    if environment is not None:
        monkeypatch.setenv(VARIABLE, environment)
    monkeypatch.setattr(import_module("fissura.batch.computing"), "computed", start)
    with pytest.raises(StartedError) as caught:
        run_study(load_study(write_study(tmp_path, ONE)), tmp_path / "out", workers=2)
    assert caught.value.args == (expected,)
    assert os.environ.get(VARIABLE) == environment


def die_at_full_resolution(task):
    if task.full:
        os.kill(os.getpid(), signal.SIGKILL)
    return Record(task.specimen, task.seed, task.variation, {}, "failed", "tried")


def nothing():
    pass


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_process_that_dies_costs_its_run_only(tmp_path, monkeypatch):
    monkeypatch.setattr(runner, "execute", die_at_full_resolution)
    monkeypatch.setattr(runner, "warm_up", nothing)
    monkeypatch.setattr(runner.StudyResult, "comparing", lambda *_: None)
    plan, told = load_study(write_study(tmp_path, REFUSED)), []
    run_study(plan, tmp_path / "out", workers=2, on_done=lambda *of: told.append(of))
    assert {task.variation: record.message for task, record, _ in told} == {
        FULL: "the processes that computed it died, perhaps for lack of memory",
        "default": "tried",
        "gone": "tried",
    }
    assert all((tmp_path / "out" / task.path).exists() for task, *_ in told)


def tried(task):
    return failed(task, ValueError("tried"))


#: What a worker did before its first task.
prepared = []


def prepare():
    prepared.append(True)


def test_a_cluster_runs_them_too(tmp_path, monkeypatch):
    monkeypatch.setattr(runner, "execute", tried)
    monkeypatch.setattr(runner, "warm_up", prepare)
    monkeypatch.setattr(runner.StudyResult, "comparing", lambda *_: None)
    plan, told = load_study(write_study(tmp_path, REFUSED)), []
    with LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster:
        run_study(plan, tmp_path / "out", scheduler=cluster, on_done=lambda *of: told.append(of))
    assert {(task.variation, record.message) for task, record, _ in told} == {
        (name, "tried") for name in (FULL, "default", "gone")
    }
    assert all((tmp_path / "out" / task.path).exists() for task, *_ in told)
    assert prepared == [True]  # once in each worker
    with pytest.raises(InputError, match="--workers: is given together with --scheduler"):
        run_study(plan, tmp_path / "out", workers=2, scheduler="tcp://127.0.0.1:1")


def test_more_workers_than_the_machine_can_run_are_refused(study, tmp_path):
    with pytest.raises(InputError, match="--workers: 1000000 is not possible with"):
        run_study(load_study(study), tmp_path / "out", workers=1_000_000)


# The command


def call(*arguments):
    return CliRunner().invoke(app, ["study", *map(str, arguments)])


def test_command_reports(finished):
    path, folder, _, _ = finished
    done = call(path, "--output", folder, "--report")
    assert done.exit_code == 0, done.output
    assert "2, 1 of which did not finish" in done.stdout


def test_command_names_what_is_wrong(tmp_path):
    done = call(write_study(tmp_path, STUDY.replace("seeds", "sedes", 1)))
    assert done.exit_code == 2
    assert done.stderr.startswith("error: sedes: unknown key")
    assert len(done.stderr.splitlines()) == 1
    done = call(write_study(tmp_path), "--again", "nothing", "--output", tmp_path / "out")
    assert done.exit_code == 2
    assert "--again: 'nothing' is not known" in done.stderr


def test_command_interrupted(tmp_path, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "execute", interrupt)
    monkeypatch.setattr(runner, "warm_up", nothing)
    done = call(write_study(tmp_path), "--output", tmp_path / "out")
    assert done.exit_code == 130
    out = tmp_path / "out"
    assert done.stderr.endswith(f"interrupted; what has ended is saved in {out}; the same command goes on from there\n")
    done = call(write_study(tmp_path), "--output", out, "--again", "default")
    assert "the same command without --again goes on from there" in done.stderr


def test_command_says_how_to_go_on_when_processes_die(tmp_path, monkeypatch):
    (tmp_path / "sitecustomize.py").write_text('import os, sys\nif "spawn" in str(sys.orig_argv):\n    os._exit(9)\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    done = call(write_study(tmp_path), "--output", tmp_path / "out", "--workers", "2", "--quiet")
    assert done.exit_code == 3
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: processes die while they start, perhaps for lack of memory (exit status 9); ")
    assert line.endswith("the same command goes on from there")


def test_command_shows_how_far_it_is(tmp_path, monkeypatch):
    monkeypatch.setattr(runner, "warm_up", lambda: None)
    path = write_study(tmp_path, REFUSED)
    done = call(path, "--output", tmp_path / "out")
    assert done.exit_code == 0, done.output
    lines = done.stderr.splitlines()
    name = load_study(path).study.name
    assert lines[0] == f"{name}: 3 runs"
    assert any(line.startswith("beam, seed 1, gone: refused: solver.linear") for line in lines)
    assert lines[-1].startswith("3 of 3 runs, 1 refused, ")
    assert "left" not in lines[-1]
    done = call(path, "--output", tmp_path / "out", "--again", "default")
    assert done.stderr.splitlines()[0] == f"{name}: 3 runs, 2 of them there already"
    assert "3 of 3 runs, last beam, seed 1, default in " in done.stderr
    quiet = call(path, "--output", tmp_path / "out", "--again", "default", "--quiet")
    assert (quiet.exit_code, quiet.stderr) == (0, "")


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_estimates_the_time_left(study, monkeypatch, terminal):
    now, plan = [100.0], load_study(study)
    monkeypatch.setattr("fissura.progress.live.time.monotonic", lambda: now[0])
    console = Console(width=200, record=True, file=io.StringIO(), force_terminal=terminal)
    tasks = list(plan.tasks())
    with StudyProgress(console) as progress:
        progress.start(plan, 5, 1)
        for task, status, message in zip(
            tasks, ("finished", "failed"), ("", "Traceback\n  …\nOops: why"), strict=False
        ):
            now[0] += 30.0
            summary = {"wall_s": 12.0} if status == "finished" else {}
            progress.done(task, Record(task.specimen, task.seed, task.variation, {}, status, message, summary), 0)
    text = console.export_text()
    assert f"{plan.study.name}: 6 runs, 1 of them there already" in text
    assert f"{tasks[1]}: failed: Oops: why" in text
    assert "3 of 6 runs" in text
    assert "1 failed, 1:00 min elapsed, about 1:30 min left" in text
    if not terminal:
        assert f"2 of 6 runs, last {tasks[0]} in 12 s, 30 s elapsed, about 2:00 min left" in text


@pytest.mark.slow
def test_processes_give_the_same_results_and_can_be_interrupted(finished, tmp_path):
    _, folder, _, _ = finished
    write_study(tmp_path, REFUSED.replace('"guess"', '"direct"'))  # other processes know no such solver
    start = [sys.executable, "-m", "fissura", "study", "study.toml", "--output", "out", "--workers", "2"]
    with subprocess.Popen(
        start,
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # ignored by what a shell starts aside
    ) as running:
        assert running.stderr is not None
        assert "3 runs" in running.stderr.readline()
        while not list((tmp_path / "out").rglob("[!.]*.npz")):
            assert running.poll() is None
            time.sleep(0.02)
        os.killpg(running.pid, signal.SIGINT)
        assert running.wait(60) == 130
    saved = {p.name for p in (tmp_path / "out").rglob("[!.]*.npz")}
    assert saved
    done = subprocess.run(start, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=True)
    if len(saved) < 3:
        assert f"3 runs, {len(saved)} of them there already" in done.stderr
    for name in ("full", "default"):
        a, b = (Record.load(f / "runs" / "beam" / "seed0001" / f"{name}.npz") for f in (folder, tmp_path / "out"))
        assert list(a.curve["load_N"]) == list(b.curve["load_N"])
        assert list(a.energies.energy) == list(b.energies.energy)


def test_a_variation_may_be_renamed(finished, tmp_path):
    """The case decides what is done, not the name under which it was run."""
    path, folder, first, _ = finished
    copy = tmp_path / "out"
    shutil.copytree(folder, copy)
    record = next(copy.rglob("default.npz"))
    record.rename(record.with_name("other.npz"))
    renamed = path.with_name("renamed.toml")
    renamed.write_text(path.read_text().replace('name = "default"', 'name = "other"'))
    again = run_study(load_study(renamed), copy, run=False)
    assert again.left == 0
    assert {m.variation for m in again.found} == {"other", "gone"}
    assert [m.load for m in again.found if m.compared] == [m.load for m in first.found if m.compared]
