"""``fissura run --resume``: messages and exit states."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

from fissura.results import read_curve
from fissura.text.quantities import force
from sameness import assert_same

from .fakes import TINY, call


@pytest.fixture
def quick(tiny: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("fissura.running.recorder.Recorder._draw", lambda *_: None)
    monkeypatch.chdir(tiny.parent)
    return tiny


def test_a_finished_run_is_left_alone_and_goes_on_to_a_larger_target(quick: Path) -> None:
    assert call("run", quick).exit_code == 0
    before = Path("results/tiny/curve.csv").stat().st_mtime_ns
    done = call("run", quick, "--resume")
    assert done.exit_code == 0
    assert "the run in results/tiny has ended, and control.target is not larger: nothing was changed" in done.stderr
    assert Path("results/tiny/curve.csv").stat().st_mtime_ns == before
    steps = len(read_curve("results/tiny")["step"])
    quick.write_text(TINY.replace('"2 um"', '"3 um"'))
    done = call("run", quick, "--resume")
    assert done.exit_code == 0, done.stderr
    assert f"continues after step {steps}, gauge 2.00 µm" in done.stderr
    assert read_curve("results/tiny")["gauge_m"][-1] == 3e-6


def test_a_run_that_ended_under_a_force_tells_the_force(quick: Path) -> None:
    data = tomllib.loads(TINY)
    del data["control"]
    data["stage"] = [{"to": ["2 um", "50 % of load"]}]
    case = quick.with_suffix(".json")
    case.write_text(json.dumps(data))
    assert call("run", case, "--output", "staged").exit_code == 0
    curve = read_curve("staged")
    assert (
        "has ended, and no stage goes further: nothing was changed"
        in call("run", case, "--output", "staged", "--resume").stderr
    )
    data["stage"][0]["to"].append("3 um")
    case.write_text(json.dumps(data))
    done = call("run", case, "--output", "staged", "--resume")
    assert done.exit_code == 0, done.stderr
    assert f"continues after step {len(curve['step'])}, load {force(curve['load_N'][-1])}\n" in done.stderr


def test_what_is_refused(quick: Path) -> None:
    done = call("run", quick, "--resume")
    assert done.exit_code == 2
    assert "results/tiny has no checkpoint.npz" in done.stderr
    assert call("run", quick, "--seed", "2").exit_code == 0
    for options in ([], ["--seed", "3"], ["--seed", "2", "--full"], ["--overwrite"]):
        done = call("run", quick, "--resume", *options)
        assert done.exit_code == 2
        assert done.stderr.startswith("error: --")
        assert done.stderr.count("\n") == 1
    assert call("run", quick, "--resume", "--seed", "2").exit_code == 0


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_run_that_a_signal_ended_goes_on(quick: Path, number: signal.Signals) -> None:
    quick.write_text(TINY.replace('"5 mm"', '"3 mm"') + 'output.checkpoint = "1 ms"\n')
    command = [sys.executable, "-m", "fissura", "run", str(quick), "--quiet"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as run:
        while not Path("results/tiny/checkpoint.npz").exists():
            assert run.poll() is None
            time.sleep(0.01)
        run.send_signal(number)
        assert run.stderr is not None
        told = run.stderr.read()
    kept = json.loads(Path("results/tiny/summary.json").read_text())
    if number == signal.SIGKILL:
        assert run.returncode == -number
        assert kept["status"] == "running"
    else:
        assert run.returncode == 130
        assert kept["status"] == "interrupted"
        assert told.endswith("; --resume goes on with it\n")
    assert subprocess.run([*command, "--resume"], check=False).returncode == 0
    assert json.loads(Path("results/tiny/summary.json").read_text())["status"] == "finished"


FULL_DISK = """
import resource, signal, sys
from fissura.__main__ import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop(1)), resource.RLIM_INFINITY))
main()
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="no such limits")
@pytest.mark.parametrize("size", [500, 5_000, 20_000, 60_000, 150_000])
def test_a_run_goes_on_after_no_file_could_grow(quick: Path, size: int) -> None:
    """The system lets no file grow beyond some bytes: the checkpoint of before stays."""
    assert call("run", quick).exit_code == 0
    shutil.copytree("results/tiny", "results/again")
    longer = quick.with_name("longer.toml")
    longer.write_text(TINY.replace('"2 um"', '"6 um"') + 'output.checkpoint = "1 ms"\n')
    options = ["run", str(longer), "--resume", "--quiet", "--output"]
    assert call(*options, "results/tiny").exit_code == 0
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(size), *options, "results/again"],
        stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    assert done.returncode in (2, 4)
    assert done.stderr.splitlines()[-1].startswith("error: ")
    assert done.stderr.count("error: ") == 1
    assert call(*options, "results/again").exit_code == 0
    assert_same(Path("results/tiny"), Path("results/again"))
