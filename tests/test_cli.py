"""The command line, and running from Python.

Most tests put a simulation and a recorder in place that compute nothing, so that every way a run can end
is at hand; the last ones run a tiny beam.
"""

from __future__ import annotations

import errno
import gc
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner, Result

import fissura.results.recorder
from fissura import api, check
from fissura.case import Case, case_from_dict, load_case
from fissura.cli import app, start_light
from fissura.errors import InputError, RunStopped
from fissura.progress import RunProgress, duration
from fissura.results.quantities import energy, force, length

EXAMPLE = Path(__file__).parents[1] / "examples" / "beam_d100.toml"

TINY = """
specimen.size = ["80 mm", "20 mm", "10 mm"]
notch = { position = "40 mm", depth = "8 mm" }
supports = [
    { type = "pin", face = "bottom", at = "10 mm" },
    { type = "roller", face = "bottom", at = "70 mm" },
]
load = { face = "top", at = "40 mm" }
gauge.a = { face = "bottom", at = "38 mm" }
gauge.b = { face = "bottom", at = "42 mm" }
material = { E = "60 GPa", alpha = 0.29, f_t = "2.2 MPa", G_t = "35 J/m^2" }
discretization = { l_f = "5 mm", l_c = "10 mm" }
control.target = "2 um"
output.vtk = 0
"""


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case file in an otherwise empty current directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return path


class FakeContacts:
    """Lengths only."""

    def __init__(self, length: Any, fine: Any) -> None:
        self.length, self.fine = length, fine

    def __len__(self) -> int:
        return len(self.length)


class FakeSimulation:
    """Twenty equal steps of a run; every fifth refines."""

    ending: BaseException | None = None
    after = 12
    built: list[Any]

    def __init__(self, case: Case, *, full: bool = False) -> None:
        self.case, self.full = case, full
        self.bodies_start, self.bodies_full = 100, 300
        self.field = None
        lengths = np.array([0.004, 0.009, 0.012])
        self.tessellation = SimpleNamespace(contacts=FakeContacts(lengths, lengths < 0.01))
        type(self).built.append(self)

    def steps(self) -> Iterator[Any]:
        for number in range(1, 21):
            yield SimpleNamespace(
                number=number,
                gauge=self.case.control.target * number / 20,
                load=1234.0,
                bodies=100 + number,
                refinements=int(number % 5 == 0),
                iterations=4,
                control="gauge",
            )
            if self.ending is not None and number == self.after:
                raise self.ending


class FakeRecorder:
    """Keeps the numbers of the steps, and how the run ended."""

    warnings: tuple[str, ...] = ()
    fail_at = 0

    def __init__(self, simulation: FakeSimulation, folder: Path | None) -> None:
        self.folder, self.steps = folder, list[int]()

    def add(self, step: Any) -> None:
        self.steps.append(step.number)
        if self.folder is not None:
            (self.folder / "curve.csv").write_text(",".join(map(str, self.steps)))
        if step.number == self.fail_at:
            raise OSError(errno.ENOSPC, "No space left on device", str(self.folder and self.folder / "curve.csv"))

    def finish(self, status: str, message: str = "") -> Any:
        if self.folder is not None:
            (self.folder / "summary.json").write_text(status)
        return SimpleNamespace(
            folder=self.folder,
            status=status,
            message=message,
            curve={"step": np.array(self.steps)},
            summary={"warnings": list(self.warnings)},
            table=lambda: [("status", status), ("peak load", "1 [kN]")],
        )


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> type[FakeSimulation]:
    """Nothing is computed."""
    simulation = type("Simulation", (FakeSimulation,), {"built": []})
    module = ModuleType("fissura.simulation")
    module.Simulation = simulation  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "fissura.simulation", module)
    monkeypatch.setattr(fissura.results.recorder, "Recorder", type("Recorder", (FakeRecorder,), {}))
    return simulation


def recorder() -> Any:
    return fissura.results.recorder.Recorder


# new, --version, help


@pytest.mark.parametrize("name", ["beam", "tension"])
def test_new_prints_a_valid_case(tmp_path: Path, name: str) -> None:
    done = call("new", name)
    assert done.exit_code == 0
    (tmp_path / "case.toml").write_text(done.stdout)
    assert load_case(tmp_path / "case.toml").material.E == 60e9
    assert done.stdout.isascii()


def test_new_lists_templates_and_refuses_others() -> None:
    done = call("new", "--list")
    assert done.exit_code == 0
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["beam", "tension"]
    for arguments, problem in ((["new", "boat"], "'boat' is not known"), (["new"], "missing")):
        done = call(*arguments)
        assert done.exit_code == 2
        assert done.stderr == f"error: template: {problem} (allowed: beam, tension)\n"


def test_a_light_start_keeps_what_the_user_set(monkeypatch: pytest.MonkeyPatch) -> None:
    thresholds = gc.get_threshold()
    monkeypatch.setenv("OPENBLAS_THREAD_TIMEOUT", "26")
    try:
        start_light()
        assert os.environ["OPENBLAS_THREAD_TIMEOUT"] == "26"
        assert gc.isenabled()
        assert gc.get_threshold() > thresholds
    finally:
        gc.set_threshold(*thresholds)


def test_reading_a_case_of_common_units_needs_no_pint_and_no_solver() -> None:
    code = f"import sys, fissura; fissura.load_case({str(EXAMPLE)!r}); print({{'pint', 'numpy'}} & set(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "set()"


def test_version() -> None:
    done = call("--version")
    assert done.exit_code == 0
    assert done.stdout == f"fissura {fissura.__version__}\n"


@pytest.mark.parametrize("arguments", [["run"], ["walk"], ["run", "x", "--seed", "-1"], ["run", "x", "--seed", "a"]])
def test_wrong_usage(arguments: list[str]) -> None:
    assert call(*arguments).exit_code == 2


# run


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
    assert "left" in shown[0]


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
    done = call("run", tiny, "--output", "out")
    assert (done.exit_code, fake.built) == (2, [])
    assert done.stderr.startswith("error: output: out is not empty")
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


# From Python


def test_api_run(tiny: Path, fake: type[FakeSimulation]) -> None:
    seen: list[Any] = []
    result: Any = api.run(tiny, seed=5, on_start=seen.append, on_step=seen.append)
    assert (result.status, result.folder) == ("finished", None)
    assert seen[0] is fake.built[0]
    assert [step.number for step in seen[1:]] == list(range(1, 21))
    assert fake.built[0].case.seed == 5
    assert list(tiny.parent.iterdir()) == [tiny]


@pytest.mark.parametrize(
    ("ending", "status"),
    [(RunStopped("no way on", 13, 0.1), "stopped"), (KeyboardInterrupt(), "interrupted")],
)
def test_api_run_that_ends_early_saves(
    tiny: Path, fake: type[FakeSimulation], ending: BaseException, status: str
) -> None:
    fake.ending = ending
    with pytest.raises(type(ending)) as caught:
        api.run(load_case(tiny), output="out")
    result: Any = caught.value.result  # type: ignore[attr-defined]
    assert result.status == status
    assert len(result.curve["step"]) == 12
    assert Path("out/summary.json").read_text() == status


@pytest.mark.parametrize("seed", [-1, 1.5, True, 2**64])
def test_api_refuses_a_seed(tiny: Path, seed: Any) -> None:
    with pytest.raises(InputError, match="seed"):
        api.run(tiny, seed=seed)


# Progress


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.4, "0 s"), (59.4, "59 s"), (200, "3:20 min"), (7400, "2:03 h"), (3599.9, "1:00 h")],
)
def test_duration(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_progress_in_a_terminal(tiny: Path, fake: type[FakeSimulation], capsys: pytest.CaptureFixture[str]) -> None:
    simulation: Any = fake(load_case(tiny))
    console = Console(stderr=True, force_terminal=True, width=150)
    with RunProgress(console, simulation.case) as progress:
        progress.start(simulation)
        for step in simulation.steps():
            progress.step(step)
    text = capsys.readouterr().err
    assert "step 20: 1 refinement, 120 bodies" in text
    assert "100 %" in text


def test_progress_where_energy_leads(tiny: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tiny.write_text(TINY.replace('control.target = "2 um"', 'control = { type = "dissipation", target = "2 um" }'))
    progress = RunProgress(Console(stderr=True), load_case(tiny))
    for number, (gauge, load) in enumerate([(1e-6, 200.0), (1.2e-6, 400.0), (1.1e-6, 210.0), (1.05e-6, 20.0)], 1):
        leads = "gauge" if number == 1 else "dissipation"
        progress.step(
            SimpleNamespace(number=number, gauge=gauge, load=load, bodies=9, refinements=1, iterations=2, control=leads)  # type: ignore[arg-type]
        )
    lines = capsys.readouterr().err.splitlines()
    assert [line.split("%")[0].strip() for line in lines] == ["50", "60", "60", "100"]
    assert ["of the peak" in line for line in lines] == [False, False, True, True]
    assert f"load {force(20.0)} (5 % of the peak), 9 bodies" in lines[3]


# Memory and check


def spacing(l_f: float) -> Case:
    case = load_case(EXAMPLE)
    return case.model_copy(update={"discretization": case.discretization.model_copy(update={"l_f": l_f})})


def test_estimates() -> None:
    assert check.estimate_bodies(spacing(0.01)) == pytest.approx(0.734 * 35.6 * 10.6 * 5.6)
    assert 0.993e9 < check.estimate_memory(23_647) < 1.3e9  # measured: 0.993e9
    assert 2.9e9 < check.estimate_memory(101_000) < 4.4e9
    assert check.estimate_elastic_memory(101_000) < check.estimate_memory(101_000)
    assert 1e8 < check.physical_memory() < 1e14


@pytest.mark.parametrize(
    ("l_f", "full", "refused"),
    [
        (0.01, False, False),
        (0.01, True, False),
        (0.001, False, False),  # 1.3 million bodies: 0.5 GB to place, 46 GB to solve
        (0.001, True, True),
        (0.0004, False, True),  # 8 GB to place
        (1e-5, False, True),
        (1e-300, False, True),
    ],
)
def test_memory_is_required(monkeypatch: pytest.MonkeyPatch, l_f: float, full: bool, refused: bool) -> None:
    monkeypatch.setattr(check, "physical_memory", lambda: 4e9)
    if not refused:
        case = spacing(l_f)
        check.require_memory(
            case.model_copy(update={"adaptivity": case.adaptivity.model_copy(update={"calibrate": False})}), full=full
        )
        return
    with pytest.raises(InputError) as caught:
        check.require_memory(spacing(l_f), full=full)
    assert caught.value.key == "discretization.l_f"
    assert ("without full resolution" in caught.value.allowed) == full


def test_calibration_needs_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check, "physical_memory", lambda: 4e9)
    with pytest.raises(InputError) as caught:
        check.require_memory(spacing(0.001))
    assert caught.value.key == "adaptivity.calibrate"
    assert "false" in caught.value.allowed


def test_run_refuses_what_does_not_fit(tiny: Path, fake: type[FakeSimulation]) -> None:
    tiny.write_text(TINY.replace('"5 mm"', '"1 um"'))
    for command in ("run", "check"):
        done = call(command, tiny)
        assert (done.exit_code, fake.built) == (2, [])
        assert "discretization.l_f" in done.stderr


def test_check_report(fake: type[FakeSimulation]) -> None:
    report = check.report(load_case(EXAMPLE))
    assert (report.bodies_start, report.bodies_full, report.contacts, report.fine_contacts) == (
        100,
        300,
        3,
        2,
    )
    assert report.tension_limit == pytest.approx(2 * 60e9 * 35 / 2.2e6**2)
    assert report.shear_limit == pytest.approx(report.tension_limit * 16 * 0.29 / 9)
    assert report.longest_contact == pytest.approx(0.03)
    assert report.fewest_steps == 50
    assert report.warnings == ()
    assert replace(report, max_step=report.target / 60.5).fewest_steps == 61


def test_check_warns_of_long_contacts(tiny: Path, fake: type[FakeSimulation]) -> None:
    tiny.write_text(TINY.replace("35 J/m^2", "0.1 J/m^2"))
    done = call("check", tiny)
    assert done.exit_code == 0
    assert "warning: a fine contact may be longer than the law allows" in done.stderr
    assert "bodies at full resolution  300" in done.stdout
    assert "steps                      50 or more" in done.stdout
    assert not Path("results").exists()


@pytest.mark.parametrize(
    ("control", "told", "steps"),
    [
        ({"type": "gauge"}, "gauge, to 2 mm", "50 or more, each at most 40 µm"),
        (
            {"type": "displacement", "stop_load": 0.2},
            "displacement of the load, to 2 mm or until 20 % of the peak load is left",
            "50 or more, each at most 40 µm",
        ),
        (
            {"type": "dissipation"},
            "dissipated energy, until the gauge is 2 mm or 5 % of the peak load is left",
            f"each at most 40 µm, with energy in the lead {energy(35 * 0.012 * 0.01 / 50)}",
        ),
    ],
)
def test_check_tells_what_leads(
    tiny: Path, fake: type[FakeSimulation], control: dict[str, Any], told: str, steps: str
) -> None:
    text = ", ".join(f"{key} = {json.dumps(value)}" for key, value in control.items())
    tiny.write_text(TINY.replace('control.target = "2 um"', f'control = {{ target = "2 mm", {text} }}'))
    table = dict(check.report(load_case(tiny)).table())
    assert (table["control"], table["steps"]) == (told, steps)


# compare


def test_compare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = import_module("fissura.results.compare")  # the package has a function of the same name

    def comparison(plot: Callable[[Path], Any]) -> Any:
        return lambda a, b: SimpleNamespace(table=lambda: [("peak load", "+1 %")], plot=plot)

    def full(path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(module, "compare", comparison(lambda path: path.write_text("x")))
    done = call("compare", tmp_path, "b")
    assert (done.exit_code, done.stdout) == (0, f"peak load  +1 %\npicture: {tmp_path / 'compare.png'}\n")
    assert call("compare", "a", "b", "--plot", tmp_path / "p.png").exit_code == 0
    assert (tmp_path / "p.png").exists()
    monkeypatch.setattr(module, "compare", comparison(full))
    done = call("compare", tmp_path, "b")
    assert done.exit_code == 4
    assert "compare.png: cannot be written: No space left" in done.stderr


def test_compare_without_results(tmp_path: Path) -> None:
    done = call("compare", tmp_path / "a", tmp_path / "b")
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")


# Pictures of bodies


def test_compare_bodies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compared = SimpleNamespace(table=lambda: [("peak load", "+1 %")], plot=lambda path: path.write_text("x"))
    monkeypatch.setattr(import_module("fissura.results.compare"), "compare", lambda a, b: compared)
    drawn: list[Path] = []
    monkeypatch.setattr("fissura.results.moments.plot_bodies", lambda comparison, path: drawn.append(path))
    assert call("compare", "a", "b", "--bodies", "--plot", tmp_path / "p.pdf").exit_code == 0
    assert drawn == [tmp_path / "p_bodies.pdf"]


@pytest.mark.parametrize("name", ["animate", "moments"])
def test_pictures_without_results(tmp_path: Path, name: str) -> None:
    done = call(name, tmp_path / "nowhere")
    assert done.exit_code == 2
    assert "there is no such folder" in done.stderr


@pytest.mark.parametrize(
    "wrong", [["--fps", "0"], ["--fps", "99"], ["--size", "10"], ["--output", "x.avi"], ["--output", "x"]]
)
def test_animate_refuses(tmp_path: Path, wrong: list[str]) -> None:
    done = call("animate", tmp_path, *wrong)
    assert done.exit_code == 2
    assert wrong[0] in done.stderr


def test_pictures_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from results.pictured import LOADS, record

    folder = tmp_path / "run"
    record(folder)
    monkeypatch.setattr("fissura.results.moments.DPI", 60)
    done = call("moments", folder)
    assert (done.exit_code, done.stdout) == (0, f"picture: {folder / 'moments.png'}\n")
    done = call("animate", folder, "--size", "320", "--fps", "5")
    assert done.exit_code == 0
    assert done.stdout == f"animation: {folder / 'refinement.gif'}, {len(LOADS) + 1} frames\n"
    assert (folder / "refinement.gif").stat().st_size > 0
    done = call("moments", folder, "--output", folder / "x.abc")
    assert done.exit_code == 2
    assert "--output" in done.stderr
    done = call("animate", folder, "--output", folder / "no" / "x.gif")
    assert done.exit_code == 4
    (folder / "section.npz").unlink()
    assert "run again" in call("animate", folder).stderr


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
    done = call("check", tiny)
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
