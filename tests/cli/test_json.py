"""``--json``: one object on standard output, and errors as one on standard error; the log of a run; completion."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fissura.api.check import check
from fissura.results import Result

from .fakes import TINY, FakeSimulation, call


def test_check(tiny: Path) -> None:
    done = call("check", "--build", "--json", tiny)
    found = json.loads(done.stdout)
    report = check(tiny)
    assert (done.exit_code, done.stderr) == (0, "")
    assert (found["bodies_start"], found["bodies_full"]) == (report.bodies_start, report.bodies_full)
    assert found["limits_m"]["in tension"] == pytest.approx(2 * 60e9 * 35 / 2.2e6**2)
    assert found["stages"][0]["control"] == report.stages[0][0]
    assert found["counted"] is True


def test_run_compare_and_the_log(tiny: Path) -> None:
    done = call("run", "--json", tiny)
    assert (done.exit_code, done.stderr) == (0, "")
    found, result = json.loads(done.stdout), Result.load("results/tiny")
    assert found["peak_load_N"] == result.peak_load
    assert found["folder"] == str(Path("results/tiny"))
    assert {"curve.csv", "run.log", "summary.json"} <= set(found["files"])

    lines = Path("results/tiny/run.log").read_text(encoding="utf-8").splitlines()
    assert "numba" in lines[0]
    assert "tiny, seed 1" in lines[1]
    assert sum("INFO    step " in line and "gauge" in line for line in lines) == result.steps
    assert "finished, wall time" in lines[-1]

    again = call("run", "--json", tiny, "--output", "from_json", "--seed", "2")
    assert again.exit_code == 0
    done = call("compare", "--json", "results/tiny", "from_json")
    found = json.loads(done.stdout)
    assert done.stderr == ""
    a, b = (found["numbers"]["peak_load_N"][name] for name in "ab")
    assert found["numbers"]["peak_load_N"]["difference"] == pytest.approx((a - b) / b)
    assert [Path(name).name for name in found["pictures"]] == ["compare.png"]
    assert len(logging.getLogger("fissura").handlers) == 0


def test_the_case_of_a_result_can_be_run(tiny: Path) -> None:
    assert call("run", tiny, "--quiet").exit_code == 0
    assert call("run", "results/tiny/case.json", "--output", "again", "--quiet").exit_code == 0
    one, two = Result.load("results/tiny"), Result.load("again")
    assert one.curve["load_N"].tobytes() == two.curve["load_N"].tobytes()


def test_errors(tiny: Path) -> None:
    tiny.write_text(TINY.replace("l_f", "lf"))
    for command in ("check", "run"):
        done = call(command, "--json", tiny)
        error = json.loads(done.stderr)["error"]
        assert (done.exit_code, done.stdout) == (2, "")
        assert error["key"] == "discretization.lf"
        assert error["exit_status"] == 2
        assert error["message"].startswith("discretization.lf: unknown key")
    done = call("compare", "--json", "nowhere", "nowhere")
    assert json.loads(done.stderr)["error"]["problem"] == "there is no such folder"


@pytest.mark.parametrize(("ending", "status"), [(MemoryError(), 3), (KeyboardInterrupt(), 130)])
def test_runs_that_end_early(
    tiny: Path, fake: type[FakeSimulation], monkeypatch: pytest.MonkeyPatch, ending: BaseException, status: int
) -> None:
    monkeypatch.setattr(fake, "ending", ending)
    done = call("run", "--json", tiny)
    assert (done.exit_code, done.stdout) == (status, "")
    assert json.loads(done.stderr)["error"]["exit_status"] == status


def test_verbose_tells_what_happens_within_steps(tiny: Path) -> None:
    quiet, verbose = (call("run", tiny, "--overwrite", *how) for how in ((), ("--verbose",)))
    assert verbose.exit_code == 0, verbose.stderr
    assert "stiffness of elastic contacts" in verbose.stderr
    assert "stiffness of elastic contacts" not in quiet.stderr
    assert logging.getLogger("fissura").level == logging.NOTSET


def test_a_log_is_continued(tiny: Path) -> None:
    assert call("run", tiny, "--quiet").exit_code == 0
    first = Path("results/tiny/run.log").read_text(encoding="utf-8")
    tiny.write_text(TINY.replace("2 um", "3 um"))
    assert call("run", tiny, "--resume", "--quiet").exit_code == 0
    whole = Path("results/tiny/run.log").read_text(encoding="utf-8")
    assert whole.startswith(first)
    assert ", continued after step " in whole[len(first) :]


def test_a_folder_that_is_no_result_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for command in ("moments", "animate"):
        done = call(command, ".")
        assert done.exit_code == 2
        assert done.stderr.startswith(f"error: {tmp_path}: holds no results of a run (no summary.json)")


def test_shells_complete(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "fissura", "--show-completion", "bash"]
    environment = os.environ | {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert "COMPREPLY" in done.stdout, done.stderr
