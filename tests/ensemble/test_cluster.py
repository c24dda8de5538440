"""Where realisations are computed, and what may go wrong there."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from distributed import LocalCluster
from typer.testing import CliRunner

import fissura.ensemble.cluster as cluster
from fissura.case import Case
from fissura.cli import app
from fissura.ensemble.cluster import outcomes
from fissura.ensemble.outcome import Outcome
from fissura.ensemble.plan import Plan, Task


def test_a_cluster_may_get_its_workers_later(
    tiny: Callable[..., Case], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    taken, told = [], []

    def tasks() -> Iterator[Task]:
        for task in Plan(tiny(), 5, companions="none").tasks():
            taken.append(task.number)
            yield task

    monkeypatch.setattr(cluster, "compute", lambda task: Outcome(task, "finished"))
    monkeypatch.setattr(cluster, "_AHEAD", 2)
    monkeypatch.setattr(cluster, "_LOOK", 0.05)
    monkeypatch.setattr(cluster, "_ALONE", 0.1)
    with LocalCluster(n_workers=0, threads_per_worker=1, processes=False, dashboard_address=None) as processes:

        def tell(record: object) -> None:
            told.append(record)
            processes.scale(1)

        monkeypatch.setattr(caplog.handler, "emit", tell)
        cluster.check_scheduler(processes)
        arriving = outcomes(tasks(), 0, scheduler=processes)
        first = next(arriving)
        assert (first.task.number, taken, len(told)) == (1, [1, 2], 1)
        assert sorted(outcome.task.number for outcome in arriving) == [2, 3, 4, 5]


def test_processes_that_die_while_they_start_are_no_crash(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As for lack of memory."""
    (tmp_path / "sitecustomize.py").write_text('import os, sys\nif "spawn" in str(sys.orig_argv):\n    os._exit(9)\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    folder = tmp_path / "out"
    done = CliRunner().invoke(app, ["ensemble", str(tiny_file), "--runs", "3", "--output", str(folder)])
    assert done.exit_code == 3
    *_, last = done.stderr.splitlines()
    assert last.startswith("error: processes die while they start, perhaps for lack of memory (exit status 9); ")
    assert last.endswith(f"what has ended is saved in {folder}; the same command with --resume goes on from there")
    assert "Traceback" not in done.stderr
