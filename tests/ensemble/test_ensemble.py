"""Whole ensembles: with processes, through the command line, with everything that may go wrong on the way."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from rich.console import Console
from typer.testing import CliRunner

import fissura.batch.computing as computing
import fissura.batch.machines as machines
import fissura.ensemble.runner as runner
from fissura.batch.machines import Machines, workers_that_fit
from fissura.case import Case
from fissura.cli import app
from fissura.ensemble.outcome import Outcome, compute
from fissura.ensemble.plan import Plan
from fissura.ensemble.progress import EnsembleProgress
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.runner import run_ensemble
from fissura.ensemble.store import Store
from fissura.ensemble.task import Task
from fissura.errors import EnsembleStopped, InputError
from fissura.machine.kernel_threads import KernelThreads
from fissura.machine.threads import VARIABLE
from fissura.results.curve import read_curve

Build = Callable[..., Case]

#: What differs from run to run of the same realisation.
TIMES = ("cpu_s", "wall_s")


def call(*arguments: str | Path | int) -> Any:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def curves(folder: Path) -> dict[str, dict[str, list[Any]]]:
    """All curves of an ensemble without times, as written: to the last digit."""
    found = {}
    for path in sorted(folder.glob("*/[0-9]*/curve.csv")):
        curve = read_curve(path)
        found[str(path.parent.relative_to(folder))] = {k: v.tolist() for k, v in curve.items() if k not in TIMES}
    return found


def check_page(folder: Path, pictures: int) -> str:
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == pictures
    # Nothing is loaded from anywhere.
    assert re.findall(r"""<[^>]*\s(?:src|href)\s*=\s*["'](?!data:)""", page) == []
    style = re.search("<style>(.*?)</style>", page, re.DOTALL)
    assert style is not None
    assert not re.search(r"@import|url\(", style[1])
    return page


def test_processes_compute_what_one_process_computes(tiny: Build, tmp_path: Path) -> None:
    seen: list[Any] = []
    found = run_ensemble(
        tiny(),
        6,
        output=tmp_path / "two",
        seed=4,
        workers=2,
        on_start=lambda plan, missing, there: seen.append((plan.runs, missing, there)),
        on_outcome=lambda summary: seen.append(summary["realisation"]["number"]),
    )
    assert seen[0] == (6, 7, 0)
    assert sorted(seen[1:]) == list(range(7))
    assert found.complete
    alone = Store(tmp_path / "one")
    for task in Plan(tiny(), 6, "both", master=4).tasks():
        alone.write(compute(task))
    assert curves(tmp_path / "two") == curves(tmp_path / "one")
    assert len(curves(tmp_path / "one")) == 7
    page = check_page(tmp_path / "two", 4)
    assert "6 of 6 finished" in page
    loaded = EnsembleResult.load(tmp_path / "two")
    assert loaded.plan.master == 4
    np.testing.assert_array_equal(loaded.peaks, found.peaks)
    np.testing.assert_array_equal(
        loaded.rows["seed"][1:], [Plan(tiny(), 6, "both", master=4).seeds(k)[0] for k in range(1, 7)]
    )
    assert loaded.result(2).peak_load == pytest.approx(found.peaks[1], rel=1e-11)
    statistics = json.loads((tmp_path / "two" / "statistics.json").read_text())
    assert statistics["peak_load_N"]["mean"] == pytest.approx(found.peaks.mean())
    assert set(statistics["fits"]) == {"Gaussian", "Weibull"}


@pytest.mark.usefixtures("inline", "few_pictures")
def test_the_command_says_what_came_out(tiny_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    options = ("--output", folder, "--seed", 3)
    done = call("ensemble", tiny_file, "--runs", 4, "--mode", "both", "--sampling", "latin-hypercube", *options)
    assert done.exit_code == 0
    assert "4 of 4 finished" in done.stdout
    assert "latin-hypercube, seed 3" in done.stdout
    assert str(folder / "report.html") in done.stdout
    assert (folder / "case.toml").read_text() == tiny_file.read_text()
    leading = json.loads((folder / "runs" / "0004" / "case.json").read_text())["field"]["leading"]
    assert len(leading) == 10
    # Results are not replaced unless that is said.
    again = call("ensemble", tiny_file, "--runs", 4, *options)
    assert again.exit_code == 2
    assert "--overwrite" in again.stderr
    assert (
        call("ensemble", tiny_file, "--runs", 4, "--mode", "geometry", "--overwrite", "--quiet", *options).stdout == ""
    )


@pytest.mark.usefixtures("inline", "few_pictures")
def test_resume_computes_what_is_missing_and_no_more(tiny: Build, tmp_path: Path) -> None:
    case, computed = tiny(), []

    def note(summary: dict[str, Any]) -> None:
        computed.append(summary["realisation"]["number"])
        if computed == [0, 1, 2]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_ensemble(case, 4, output=tmp_path, on_outcome=note)
    assert (tmp_path / "runs.csv").exists()
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("runs/*/summary.json")}
    (tmp_path / "runs" / ".0003.part").mkdir()  # as a process leaves it that is killed while it writes
    result = run_ensemble(case, 4, output=tmp_path, resume=True, on_outcome=note)
    assert computed == [0, 1, 2, 3, 4]
    assert result.complete
    assert all(path.stat().st_mtime_ns == then for path, then in before.items())
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == ["0001", "0002", "0003", "0004"]
    # More runs go on from there, fewer leave the others out.
    assert run_ensemble(case, 5, output=tmp_path, resume=True, on_outcome=note).count("finished") == 5
    assert computed[5:] == [5]
    assert len(run_ensemble(case, 3, output=tmp_path, resume=True).runs["number"]) == 3


@pytest.mark.usefixtures("inline", "few_pictures")
def test_failures_are_counted_named_and_tried_again(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def some(run: Any, tasks: Iterable[Task], *rest: Any) -> Iterator[tuple[Task, Outcome]]:
        for task in tasks:
            error = {2: MemoryError("no room"), 3: InputError("field.length", "too small")}.get(task.number)
            yield task, compute(task) if error is None else Outcome.failed(task, error)

    folder = tmp_path / "out"
    working = computing.results
    monkeypatch.setattr(computing, "results", some)
    done = call("ensemble", tiny_file, "--runs", 5, "--output", folder)
    assert done.exit_code == 3
    assert "3 of 5 finished, 2 failed" in done.stdout
    assert "run 0002 failed: MemoryError: no room" in done.stderr
    assert "run 0003 failed: field.length: too small" in done.stderr
    page = check_page(folder, 1)
    assert "MemoryError: no room" in page
    result = EnsembleResult.load(folder)
    assert result.statistics.numbers.tolist() == [1, 4, 5]
    monkeypatch.setattr(computing, "results", working)
    assert "--resume tries 1 of them again" in done.stderr
    # What the machine was to blame for is tried again, what the case is to blame for is not.
    again = call("ensemble", tiny_file, "--runs", 5, "--output", folder, "--resume")
    assert again.exit_code == 3
    assert "4 of 5 finished, 1 failed" in again.stdout


@pytest.mark.usefixtures("inline")
def test_an_ensemble_of_failures_still_has_a_page(tiny: Build, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        computing, "results", lambda run, tasks, *rest: ((task, Outcome.failed(task, MemoryError())) for task in tasks)
    )
    result = run_ensemble(tiny(), 3, output=tmp_path)
    assert (result.count("failed"), result.complete, len(result.peaks)) == (3, False, 0)
    assert "3 failed" in check_page(tmp_path, 0)


@pytest.mark.usefixtures("inline", "few_pictures")
def test_what_runs_warn_of_is_told_once(tiny: Build, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    run_ensemble(tiny(), 3, output=tmp_path)
    told = [r.getMessage() for r in caplog.records if r.name == "fissura.ensemble.runner"]
    assert sum(text.startswith("specimen.size: ") for text in told) == 1
    assert len({text.partition(":")[0] for text in told}) == len(told)
    assert all(text.endswith("(companion 0000, perhaps others)") for text in told)


@pytest.mark.usefixtures("inline")
def test_text_of_the_user_is_text_on_the_page_and_in_its_pictures(tiny: Build, tmp_path: Path) -> None:
    case = tiny(name="run_$SEED & $x^2 {{ 7 }}")
    case.__dict__["source"] = "# <script>alert(1)</script> </pre> {{ 7 }}\n"
    run_ensemble(case, 1, output=tmp_path, companions="none")
    page = check_page(tmp_path, 1)
    assert "<h1>run_$SEED &amp; $x^2 {{ 7 }}: 1 runs</h1>" in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &lt;/pre&gt; {{ 7 }}" in page


@pytest.mark.usefixtures("inline")
def test_a_single_run_has_no_scatter(tiny: Build, tmp_path: Path) -> None:
    result = run_ensemble(tiny(), 1, output=tmp_path, companions="none", mode="field")
    assert result.complete
    assert "peak load" in repr(result)
    check_page(tmp_path, 1)


@pytest.mark.usefixtures("inline", "few_pictures")
def test_a_disk_that_fills_ends_the_ensemble(tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write, folder = Store.write, tmp_path / "out"

    def full(store: Store, outcome: Outcome) -> dict[str, Any]:
        if outcome.task.number == 2:
            raise OSError(28, "No space left on device", "runs/.0002.part")
        return write(store, outcome)

    monkeypatch.setattr(Store, "write", full)
    done = call("ensemble", tiny_file, "--runs", 3, "--output", folder)
    assert done.exit_code == 4
    assert "No space left" in done.stderr
    assert "--resume" in done.stderr
    monkeypatch.setattr(Store, "write", write)
    assert call("ensemble", tiny_file, "--runs", 3, "--output", folder, "--resume").exit_code == 0


@pytest.mark.usefixtures("inline")
def test_a_scheduler_that_goes_is_no_crash(tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def going(run: Any, tasks: Iterable[Task], *rest: Any) -> Iterator[tuple[Task, Outcome]]:
        task = next(iter(tasks))
        yield task, compute(task)
        raise EnsembleStopped("the scheduler or its connection has gone")

    monkeypatch.setattr(computing, "results", going)
    done = call("ensemble", tiny_file, "--runs", 3, "--output", tmp_path / "out")
    assert done.exit_code == 3
    assert "3 of 4 runs are missing" in done.stderr
    assert "--resume" in done.stderr


def test_processes_that_die_while_they_start_are_no_crash(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As for lack of memory."""
    (tmp_path / "sitecustomize.py").write_text('import os, sys\nif "spawn" in str(sys.orig_argv):\n    os._exit(9)\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    folder = tmp_path / "out"
    done = call("ensemble", tiny_file, "--runs", 3, "--output", folder)
    assert done.exit_code == 3
    *_, last = done.stderr.splitlines()
    assert last.startswith("error: processes die while they start, perhaps for lack of memory (exit status 9); ")
    assert last.endswith(f"what has ended is saved in {folder}; the same command with --resume goes on from there")
    assert "Traceback" not in done.stderr


def threads_of(task: Task) -> Outcome:
    return Outcome(task, "finished", f"{KernelThreads().count} threads")


@pytest.mark.parametrize(("environment", "expected"), [(None, 1), ("3", 3)])
def test_workers_use_one_thread_unless_told_otherwise(
    tiny: Build, monkeypatch: pytest.MonkeyPatch, environment: str | None, expected: int
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    if environment is not None:
        monkeypatch.setenv(VARIABLE, environment)
    tasks = Plan(tiny(), 1, companions="none").tasks()
    ((_, outcome),) = computing.results(threads_of, tasks, Machines(1), Outcome.failed)
    assert outcome.message == f"{expected} threads"
    assert os.environ.get(VARIABLE) == environment


def test_arguments_that_do_not_go_together(tiny: Build, tmp_path: Path) -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"resume": True, "overwrite": True}, "--resume"),
        ({"resume": True, "output": tmp_path / "none"}, "--resume"),
        ({"workers": 2, "scheduler": "tcp://127.0.0.1:1"}, "--workers"),
        ({"scheduler": "nonsense"}, "--scheduler"),
        ({"scheduler": "tcp://127.0.0.1:1"}, "--scheduler"),  # nobody listens there
        ({"leading_modes": 4}, "--leading-modes"),
        ({"sampling": "latin-hypercube", "leading_modes": 100_000}, "--leading-modes"),
        ({"workers": 0}, "--workers"),
        ({"threads_per_worker": 0}, "--threads-per-worker"),
        ({"workers": 1_000_000}, "--workers"),
        ({"threads_per_worker": 1_000_000}, "--threads-per-worker"),
        ({"threads_per_worker": 2, "scheduler": "tcp://127.0.0.1:1"}, "--threads-per-worker"),
        ({"scheduler": "tls://127.0.0.1:1"}, "--scheduler"),  # without credentials
    ]
    for arguments, key in wrong:
        with pytest.raises(InputError) as caught:
            run_ensemble(tiny(), 2, **{"output": tmp_path / "out", **arguments})
        assert caught.value.key == key
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("package", ["distributed", "pyarrow"])
def test_a_missing_extra_is_named(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    scheduler = ("--scheduler", "tcp://127.0.0.1:1") if package == "distributed" else ()
    done = call("ensemble", tiny_file, "--runs", 2, "--output", tmp_path / "out", *scheduler)
    assert done.exit_code == 2
    assert f"{package}, which is not installed" in done.stderr
    assert "pip install fissura[ensemble]" in done.stderr
    assert not (tmp_path / "out").exists()


def test_fewer_workers_where_memory_is_short(tiny: Build, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machines, "usable_processors", lambda: 16)
    assert workers_that_fit(tiny(), full=True) <= 16
    monkeypatch.setattr(machines, "physical_memory", lambda: 1.5e9)
    assert workers_that_fit(tiny(), full=True) == 4
    monkeypatch.setattr(machines, "physical_memory", lambda: 1.0)
    assert workers_that_fit(tiny(), full=True) == 1


def test_progress_estimates_the_time_left(tiny: Build, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("fissura.progress.live.time.monotonic", lambda: now[0])
    console = Console(width=200, record=True, file=open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    with EnsembleProgress(console) as progress:
        progress.start(Plan(tiny(), 9), 8, 2)
        about = {"kind": "run", "number": 5}
        for status in ("finished", "failed", "finished", "finished"):
            now[0] += 30.0
            progress.outcome({"status": status, "message": "why", "realisation": about, "peak_load_N": None})
    text = console.export_text()
    console.file.close()
    assert "tiny: 10 runs, companions included, 2 of them there already" in text
    assert "run 0005 failed: why" in text
    assert "3 of 10 runs, 30 s elapsed, about 3:30 min left" in text
    assert "6 of 10 runs, 1 failed, 2:00 min elapsed, about 2:00 min left" in text


def processes(words: str) -> list[psutil.Process]:
    """Processes below this one whose command line contains a text."""
    found = []
    for process in psutil.Process().children(recursive=True):
        try:
            if words in " ".join(process.cmdline()):
                found.append(process)
        except psutil.Error:
            continue
    return found


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_but_its_run(tiny: Build, tmp_path: Path) -> None:
    case, killed = tiny(control__max_step="0.5 um"), []

    def kill(summary: dict[str, Any]) -> None:
        if summary["realisation"]["number"] in (2, 6):
            # The other worker, too, is in the middle of a run: both die.
            for worker in processes("multiprocessing.spawn"):
                os.kill(worker.pid, signal.SIGKILL)
                killed.append(worker.pid)

    result = run_ensemble(case, 10, output=tmp_path / "killed", workers=2, seed=6, on_outcome=kill)
    assert len(set(killed)) >= 4
    assert result.complete
    run_ensemble(case, 10, output=tmp_path / "calm", workers=1, seed=6)
    assert curves(tmp_path / "killed") == curves(tmp_path / "calm")
    assert len(curves(tmp_path / "calm")) == 11


def die_twice_of_three(task: Task) -> Outcome:
    if task.number != 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return compute(task)


@pytest.mark.slow
def test_a_run_that_kills_its_workers_has_failed(tiny: Build, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "compute", die_twice_of_three)
    result = run_ensemble(tiny(), 3, output=tmp_path, workers=1, companions="none")
    assert result.runs["status"].tolist() == ["failed", "finished", "failed"]
    assert all("died" in result.runs["error"][k] for k in (0, 2))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGINT")
def test_ctrl_c_and_resume(tiny_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "fissura",
        "ensemble",
        tiny_file,
        "--runs",
        "12",
        "--output",
        folder,
        "--workers",
        "2",
    ]
    process = subprocess.Popen(
        [str(word) for word in command],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # ignored by what a shell starts aside
    )
    while len(list(folder.glob("runs/[0-9]*"))) < 3:
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)  # a terminal sends it to all processes
    message = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert "--resume goes on from there" in message
    assert "Traceback" not in message
    there = {path: path.stat().st_mtime_ns for path in folder.glob("runs/[0-9]*/summary.json")}
    assert 3 <= len(there) < 12
    done = call("ensemble", tiny_file, "--runs", 12, "--output", folder, "--workers", 1, "--resume")
    assert done.exit_code == 0
    assert "12 of 12 finished" in done.stdout
    assert all(path.stat().st_mtime_ns == then for path, then in there.items())
    calm = tmp_path / "calm"
    assert call("ensemble", tiny_file, "--runs", 12, "--output", calm, "--workers", 2).exit_code == 0
    assert curves(folder) == curves(calm)


@pytest.mark.slow
def test_a_scheduler_with_workers_of_its_own(tiny_file: Path, tmp_path: Path) -> None:
    file, started = tmp_path / "scheduler.json", []
    environment = os.environ | {"MKL_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

    def start(*words: str) -> None:
        command = [sys.executable, "-m", "dask", *words, "--scheduler-file", str(file), "--no-dashboard"]
        started.append(subprocess.Popen(command, stderr=subprocess.DEVNULL, env=environment, cwd=tmp_path))

    try:
        start("scheduler", "--host", "127.0.0.1", "--port", "0")
        while not file.exists():
            assert started[0].poll() is None
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        for _ in range(2):
            start("worker", "--nthreads", "1", "--host", "127.0.0.1")
        far, near = tmp_path / "far", tmp_path / "near"
        done = call("ensemble", tiny_file, "--runs", 6, "--scheduler", address, "--output", far)
        assert done.exit_code == 0
        assert call("ensemble", tiny_file, "--runs", 6, "--workers", 1, "--output", near).exit_code == 0
        assert curves(far) == curves(near)
        assert len(curves(far)) == 7
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait(timeout=60)
