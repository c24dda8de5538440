"""Processes that compute side by side, and that die."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import psutil
import pytest

from fissura.batch.processes import DEATHS, _Job, _Worker, computed
from fissura.errors import EnsembleStopped

unix = pytest.mark.skipif(sys.platform == "win32", reason="needs signals")


def square(x: int) -> int:
    return x * x


def die_of_odd(x: int) -> int:
    if x % 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return x * x


def die_once(folder: str) -> str:
    mark = Path(folder) / "died"
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def wait_for_ever(folder: str) -> None:
    try:
        (Path(folder) / "begun").touch()
        time.sleep(600.0)
    finally:
        (Path(folder) / "tidied").touch()


def wait_for_release(folder: str) -> str:
    (Path(folder) / "begun").touch()
    while not (Path(folder) / "released").exists():
        time.sleep(0.01)
    return "done"


def warn(x: int) -> int:
    logging.getLogger("fissura.running.run").warning("something looks wrong in %d", x)
    return x


def refuse() -> None:
    raise ValueError("no kernels")


def listening() -> set[int]:
    """Ports on which this process and those that it started wait for others."""
    me = psutil.Process()
    return {
        connection.laddr.port
        for process in (me, *me.children(recursive=True))
        for connection in process.net_connections(kind="inet")
        if connection.status == psutil.CONN_LISTEN
    }


def test_processes_do_not_repeat_warnings_that_results_hold(capfd: pytest.CaptureFixture[str]) -> None:
    assert sorted(computed(warn, range(3), 2)) == [(k, k) for k in range(3)]
    assert "looks wrong" not in capfd.readouterr().err


def test_all_tasks_are_computed_and_taken_as_needed() -> None:
    taken = []

    def tasks() -> Iterator[int]:
        for k in range(6):
            taken.append(k)
            yield k

    with closing(computed(square, tasks(), 2)) as found:
        first = next(found)
        assert first in [(0, 0), (1, 1)]
        assert len(taken) <= 3  # one for each process, and the next
        assert {first, *found} == {(k, k * k) for k in range(6)}
    assert list(computed(square, [], 2)) == []


@unix
@pytest.mark.skipif(sys.platform == "darwin", reason="connections of other processes need special rights there")
def test_nobody_else_can_reach_them() -> None:
    before = listening()
    with closing(computed(square, range(3), 2)) as found:
        next(found)
        assert len(psutil.Process().children(recursive=True)) >= 2
        assert listening() == before


@unix
def test_a_task_that_kills_its_processes_is_given_up_and_the_others_are_not() -> None:
    assert sorted(computed(die_of_odd, range(3), 1)) == [(0, 0), (1, None), (2, 4)]
    assert DEATHS == 4


@unix
def test_a_task_whose_process_dies_is_computed_by_another(tmp_path: Path) -> None:
    assert list(computed(die_once, [str(tmp_path)], 1)) == [(str(tmp_path), "done")]


@unix
def test_processes_that_die_while_they_start_end_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sitecustomize.py").write_text('import os, sys\nif "spawn" in str(sys.orig_argv):\n    os._exit(9)\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    with pytest.raises(EnsembleStopped, match=r"die while they start, perhaps for lack of memory \(exit status 9\)"):
        list(computed(square, range(3), 2))


def test_a_preparation_that_fails_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(EnsembleStopped, match="no kernels"):
        list(computed(square, range(3), 1, refuse))
    assert capfd.readouterr().err == ""


def begun(folder: Path) -> Iterator[str]:
    """A task, and then, once a process has begun with it, an interruption."""
    yield str(folder)
    while not (folder / "begun").exists():
        time.sleep(0.02)
    raise KeyboardInterrupt


@unix
def test_an_interruption_ends_them_and_lets_them_tidy_up(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        list(computed(wait_for_ever, begun(tmp_path), 1))
    assert (tmp_path / "tidied").exists()


def test_a_result_that_nobody_waits_for_any_more_is_no_error(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    worker = _Worker[str, str](wait_for_release, None)
    worker.pipe.recv()  # ready
    assert worker.take(_Job(str(tmp_path)))
    while not (tmp_path / "begun").exists():
        time.sleep(0.01)
    worker.pipe.close()
    (tmp_path / "released").touch()
    worker.process.join(60.0)
    assert worker.process.exitcode == 0
    assert capfd.readouterr().err == ""


@unix
def test_they_end_with_the_process_that_started_them(tmp_path: Path) -> None:
    code = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from test_processes import computed, wait_for_ever
if __name__ == "__main__":
    list(computed(wait_for_ever, [{str(tmp_path)!r}], 1))
"""
    (tmp_path / "script.py").write_text(code)
    script = subprocess.Popen([sys.executable, str(tmp_path / "script.py")])
    while not (tmp_path / "begun").exists():
        assert script.poll() is None
        time.sleep(0.02)
    others = psutil.Process(script.pid).children(recursive=True)
    script.kill()
    script.wait()
    assert psutil.wait_procs(others, timeout=30.0)[1] == []
