"""``fissura run`` and ``new``: options, messages, and every way a run can end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fissura.case import Case, case_from_dict, load_case
from fissura.errors import RunStopped
from fissura.files.folder import Folder
from fissura.text.quantities import force, length

from .fakes import TINY, FakeSimulation, call, recorder


@pytest.mark.parametrize("name", ["beam", "tension"])
def test_new_prints_a_valid_case(tmp_path: Path, name: str) -> None:
    done = call("new", name)
    assert done.exit_code == 0
    (tmp_path / "case.toml").write_text(done.stdout)
    assert load_case(tmp_path / "case.toml").material.E == 60e9
    assert done.stdout.isascii()


KINDS = [
    *("anchor", "beam", "brazilian", "disc-with-hole", "dog-bone", "double-edge-notched"),
    *("four-point", "l-panel", "mesh"),
    *("tension", "torsion", "wedge-splitting"),
]


def test_new_lists_templates_and_refuses_others() -> None:
    done = call("new", "--list")
    assert done.exit_code == 0
    assert [line.split()[0] for line in done.stdout.splitlines()] == KINDS
    for arguments, problem in ((["new", "boat"], "'boat' is not known"), (["new"], "missing")):
        done = call(*arguments)
        assert done.exit_code == 2
        assert done.stderr == f"error: template: {problem} (allowed: {', '.join(KINDS)})\n"


@pytest.mark.parametrize("arguments", [["run"], ["walk"], ["run", "x", "--seed", "-1"], ["run", "x", "--seed", "a"]])
def test_wrong_usage(arguments: list[str]) -> None:
    assert call(*arguments).exit_code == 2


def test_run_writes_to_results_and_shows_steps(tiny: Path, fake: type[FakeSimulation]) -> None:
    done = call("run", tiny)
    assert done.exit_code == 0, done.output
    assert Path("results/tiny/summary.json").read_text() == "finished"
    assert "peak load  1 [kN]" in done.stdout
    assert "curve.csv, summary.json" in done.stdout
    shown = [line for line in done.stderr.splitlines() if "step" in line]
    assert len(shown) == 20
    where = f"50 %  step 10, gauge {length(1e-6)}, load {force(1234.0)}, 110 bodies"
    assert f"{where}, 2 refinements, 4 iterations, 0 s elapsed" in done.stderr
    assert all(line.endswith(("elapsed", "left", "almost done")) for line in shown)


def test_run_options(tiny: Path, fake: type[FakeSimulation]) -> None:
    assert call("run", tiny, "--full", "--seed", "7", "--quiet").output == ""
    assert Path("results/tiny_full/curve.csv").exists()
    (simulation,) = fake.built
    assert (simulation.full, simulation.case.seed) == (True, 7)
    assert call("run", tiny, "--output", "deep/er").exit_code == 0
    assert Path("deep/er/curve.csv").exists()


def test_run_refuses_a_folder_with_files_before_computing(tiny: Path, fake: type[FakeSimulation]) -> None:
    Path("out").mkdir()
    Path("out/notes.txt").write_text("mine")
    for option in ([], ["--overwrite"]):
        done = call("run", tiny, "--output", "out", *option)
        assert (done.exit_code, fake.built) == (2, [])
        assert done.stderr.startswith("error: output: out ")
        assert "files that Fissura did not write" in done.stderr
    assert [path.name for path in Path("out").iterdir()] == ["notes.txt"]
    # What is of a run already may be replaced, but not without a word.
    Folder.begun(Path("out"), "run").add("curve.csv")
    done = call("run", tiny, "--output", "out")
    assert (done.exit_code, fake.built) == (2, [])
    assert done.stderr == "error: output: out is not empty (allowed: a new or empty folder, or --overwrite)\n"
    assert call("run", tiny, "--output", "out", "--overwrite").exit_code == 0
    assert Path("out/notes.txt").read_text() == "mine"


@pytest.mark.parametrize("folder", ["tiny.toml", "tiny.toml/below", "x" * 300])
def test_run_refuses_a_folder_that_cannot_be_written(tiny: Path, fake: type[FakeSimulation], folder: str) -> None:
    done = call("run", tiny, "--output", folder)
    assert (done.exit_code, fake.built) == (2, [])
    assert done.stderr.startswith("error: output: ")
    assert len(done.stderr.splitlines()) == 1


def test_run_with_a_bad_case(tiny: Path) -> None:
    tiny.write_text(TINY.replace('"8 mm"', '"8 kg"'))
    for command in ("run", "check"):
        done = call(command, tiny)
        assert done.exit_code == 2
        assert done.stderr.startswith('error: notch.depth: "8 kg" is not a length')
        assert len(done.stderr.splitlines()) == 1
    assert not Path("results").exists()


def test_run_that_stops(tiny: Path, fake: type[FakeSimulation]) -> None:
    fake.ending = RunStopped("the step became too small", 13, 1.25e-6)
    done = call("run", tiny)
    assert done.exit_code == 3
    assert "error: stopped at step 13" in done.stderr
    assert "the 12 steps before it are saved in results/tiny: curve.csv, summary.json" in done.stderr
    assert Path("results/tiny/summary.json").read_text() == "stopped"


def test_run_out_of_memory(tiny: Path, fake: type[FakeSimulation]) -> None:
    fake.ending = MemoryError()
    done = call("run", tiny)
    assert done.exit_code == 3
    assert "out of memory" in done.stderr
    assert Path("results/tiny/summary.json").read_text() == "stopped"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_run_interrupted(tiny: Path, fake: type[FakeSimulation], number: signal.Signals) -> None:
    # What a shell starts in the background ignores interruptions.
    inherited = signal.signal(number, signal.default_int_handler)
    before = signal.getsignal(number)

    def steps(self: FakeSimulation) -> Iterator[Any]:
        for step in FakeSimulation.steps(self):
            yield step
            if step.number == 3:
                os.kill(os.getpid(), number)

    fake.steps = steps  # type: ignore[method-assign]
    done = call("run", tiny)
    assert done.exit_code == 130
    assert "interrupted; the 3 steps before it are saved in results/tiny" in done.stderr
    assert Path("results/tiny/summary.json").read_text() == "interrupted"
    assert signal.getsignal(number) is before
    signal.signal(number, inherited)


def test_run_interrupted_while_building(tiny: Path, fake: type[FakeSimulation]) -> None:
    def refuse(self: FakeSimulation, case: Case, *, full: bool = False) -> None:
        raise KeyboardInterrupt

    fake.__init__ = refuse  # type: ignore[method-assign, assignment]
    done = call("run", tiny)
    assert done.exit_code == 130
    assert done.stderr == "interrupted; nothing was saved\n"


def test_run_on_a_full_disk(tiny: Path, fake: type[FakeSimulation]) -> None:
    recorder().fail_at = 4
    done = call("run", tiny)
    assert done.exit_code == 4
    assert "error: results/tiny/curve.csv: cannot be written: No space left on device" in done.stderr
    assert "kept in results/tiny: curve.csv" in done.stderr


def test_run_warns_once(tiny: Path, fake: type[FakeSimulation]) -> None:
    recorder().warnings = ("refinement came too late [1]",)
    done = call("run", tiny, "--quiet")
    assert done.exit_code == 0
    assert done.stderr == "warning: refinement came too late [1]\n"


def test_run_reads_the_measured_file_first(tiny: Path, fake: type[FakeSimulation]) -> None:
    Path("m.csv").write_text("# cmod_mm,min_N,max_N\n1,2\n")
    tiny.write_text(TINY + 'output.measured = "m.csv"\n')
    done = call("run", tiny)
    assert (done.exit_code, fake.built) == (2, [])
    assert "output.measured" in done.stderr


def test_a_bug_is_not_hidden(tiny: Path, fake: type[FakeSimulation]) -> None:
    fake.ending = ZeroDivisionError()
    assert isinstance(call("run", tiny).exception, ZeroDivisionError)


# The command as users start it, and nothing faked


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "fissura", *arguments],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_command_prints_one_line_for_a_wrong_case(tiny: Path) -> None:
    tiny.write_text(TINY.replace("l_f", "lf"))
    done = command("run", str(tiny))
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: discretization.lf: unknown key; did you mean discretization.l_f?")
    assert len(done.stderr.splitlines()) == 1


def test_check_of_a_tiny_beam(tiny: Path) -> None:
    done = call("check", "--build", tiny)
    assert done.exit_code == 0, done.output
    assert "bodies at full resolution" in done.stdout


def test_run_and_compare_a_tiny_beam(tiny: Path) -> None:
    for option in ([], ["--full"]):
        done = call("run", tiny, *option)
        assert done.exit_code == 0, done.output
    done = call("compare", "results/tiny", "results/tiny_full")
    assert done.exit_code == 0, done.output
    assert Path("results/tiny/compare.png").stat().st_size > 1000
    assert case_from_dict(load_case(tiny).model_dump()) == load_case(tiny)
