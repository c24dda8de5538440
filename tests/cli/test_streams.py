"""Output that nobody reads, and every way a run can be ended from outside: the command as users start it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fissura.cli.streams import forgiving, unwritten
from fissura.results import Result, read_curve

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pipes and signals")

FISSURA = [sys.executable, "-m", "fissura"]


def status(folder: Path) -> str:
    return str(json.loads((folder / "summary.json").read_text())["status"])


def test_a_stream_whose_reader_has_gone_swallows_everything() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w", encoding="utf-8") as stream:
        found = forgiving(stream)
        for _ in range(3):
            print("text", file=found, flush=True)
        assert unwritten(found) == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_disk_without_room_is_told_at_the_end() -> None:
    with open("/dev/full", "w", encoding="utf-8") as stream:
        found = forgiving(stream)
        print("text", file=found, flush=True)
        assert unwritten(found) == "No space left on device"
        done = subprocess.run([*FISSURA, "new", "beam"], stdout=stream, stderr=subprocess.PIPE, check=False)
    assert done.returncode == 4
    assert done.stderr.decode() == "error: standard output: cannot be written: No space left on device\n"


def test_streams_without_a_descriptor_are_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    for stream in (None, sys.stdout):
        assert forgiving(stream) is stream
        assert unwritten(stream) == ""


def test_a_run_goes_on_when_nobody_reads_what_it_says(tiny: Path) -> None:
    reader, writer = os.pipe()
    process = subprocess.Popen([*FISSURA, "run", str(tiny)], stdout=writer, stderr=writer)
    os.close(writer)
    os.read(reader, 1)
    os.close(reader)  # as head -1 does
    assert process.wait(timeout=300) == 0
    assert status(Path("results/tiny")) == "finished"


def started(case: Path) -> subprocess.Popen[str]:
    """A run with small steps that has taken some of them."""
    long = 'control = { target = "60 um", max_step = "0.02 um" }'
    case.write_text(case.read_text().replace('control.target = "2 um"', long))
    process = subprocess.Popen(
        [*FISSURA, "run", str(case)],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (signal.SIGINT, signal.SIGHUP)],
    )
    curve = Path("results/tiny/curve.csv")
    while not curve.exists() or len(curve.read_bytes().splitlines()) < 4:
        assert process.poll() is None
        time.sleep(0.02)
    return process


@pytest.mark.slow
def test_a_terminal_that_closes_ends_a_run_and_saves_it(tiny: Path) -> None:
    process = started(tiny)
    assert process.stderr is not None
    process.stderr.close()  # it cannot be told either
    process.send_signal(signal.SIGHUP)
    assert process.wait(timeout=120) == 130
    result = Result.load("results/tiny")
    assert result.summary["status"] == "interrupted"
    assert result.steps == len(read_curve("results/tiny")["step"]) >= 3
    assert list(result.snapshots) == [result.steps]


@pytest.mark.slow
def test_ctrl_c_at_any_time_leaves_no_traceback(tiny: Path) -> None:
    """While Python starts there is nothing to be done, but from the first line of ours on there is.

    What Python says itself of an interruption inside one of its callbacks, where nothing can be caught, does not count.
    """
    for wait in (0.5, 0.7, 0.9, 1.1, 1.3):
        process = subprocess.Popen(
            [*FISSURA, "run", str(tiny), "--output", f"out{wait}"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        time.sleep(wait)
        process.send_signal(signal.SIGINT)
        _, text = process.communicate(timeout=120)
        ignored = text.count("Exception ignored")
        assert process.returncode in (0, 130, -signal.SIGINT)  # the last one: Python itself had not begun
        assert text.count("Traceback") <= ignored
