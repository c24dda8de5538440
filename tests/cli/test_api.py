"""Running from Python, and live progress of a run."""

from __future__ import annotations

import itertools
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from fissura.case import load_case
from fissura.errors import InputError, RunStopped
from fissura.progress.live import RunProgress, duration
from fissura.running import run as api
from fissura.text.quantities import force

from .fakes import TINY, FakeSimulation


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


class FakeDisplay:
    """What a notebook is asked to show."""

    def __init__(self) -> None:
        self.pages: list[dict[str, str]] = []

    def display(self, page: dict[str, str], *, raw: bool, display_id: bool) -> FakeDisplay:
        assert raw
        assert display_id
        self.pages.append(page)
        return self

    def update(self, page: dict[str, str], *, raw: bool) -> None:
        assert raw
        self.pages.append(page)


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> FakeDisplay:
    """As if this ran in a notebook: its pages are kept, and a second passes between any two looks at the clock."""
    shown, seconds = FakeDisplay(), itertools.count()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "IPython.display", shown)
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    monkeypatch.setattr("fissura.progress.lines.time.monotonic", lambda: float(next(seconds)))
    return shown


def test_a_notebook_shows_progress_and_clears_it(
    tiny: Path, fake: type[FakeSimulation], notebook: FakeDisplay, capsys: pytest.CaptureFixture[str]
) -> None:
    case = load_case(tiny).with_({"name": "beam & co"})
    api.run(case)
    texts = [page["text/plain"] for page in notebook.pages]
    assert texts[:2] == ["beam & co: building the specimen", "first step"]
    assert texts[2].startswith("step 1, ")
    assert texts[-1] == ""
    assert len(texts) == 23
    assert "beam &amp; co" in notebook.pages[0]["text/html"]
    assert '<progress value="0.5" max="1"' in notebook.pages[11]["text/html"]
    notebook.pages.clear()
    fake.ending = RunStopped("no way on", 13, 0.1)
    with pytest.raises(RunStopped):
        api.run(case)
    assert notebook.pages[-1]["text/plain"] == ""
    notebook.pages.clear()
    fake.ending = None
    api.run(case, progress=False)
    assert notebook.pages == []
    assert capsys.readouterr() == ("", "")


def test_progress_of_a_script_is_shown_when_it_is_wanted(
    tiny: Path, fake: type[FakeSimulation], capsys: pytest.CaptureFixture[str]
) -> None:
    api.run(tiny)
    assert capsys.readouterr() == ("", "")
    api.run(tiny, progress=True)
    out, err = capsys.readouterr()
    assert out == ""
    assert "100 %  step 20" in err


def test_progress_where_energy_leads(tiny: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tiny.write_text(TINY.replace('control.target = "2 um"', 'control = { type = "dissipation", target = "2 um" }'))
    progress = RunProgress(Console(stderr=True), load_case(tiny))
    for number, (gauge, load) in enumerate([(1e-6, 200.0), (1.2e-6, 400.0), (1.1e-6, 210.0), (1.05e-6, 20.0)], 1):
        leads = "gauge" if number == 1 else "dissipation"
        progress.step(
            SimpleNamespace(
                number=number,
                controlled=gauge,
                load=load,
                bodies=9,
                refinements=1,
                iterations=2,
                control=leads,
                done=gauge / 2e-6,
                stage=1,
            )  # type: ignore[arg-type]
        )
    lines = capsys.readouterr().err.splitlines()
    assert [line.split("%")[0].strip() for line in lines] == ["50", "60", "60", "100"]
    assert ["of the peak" in line for line in lines] == [False, False, True, True]
    assert f"load {force(20.0)} (5 % of the peak), 9 bodies" in lines[3]


def test_api_runs_tables(tiny: Path, fake: type[FakeSimulation]) -> None:
    """Tables of a case file, as nested dictionaries."""
    tables = tomllib.loads(tiny.read_text())
    result: Any = api.run(tables, seed=3)
    assert result.status == "finished"
    assert fake.built[0].case == load_case(tiny).with_({"name": "case", "seed": 3})
    with pytest.raises(InputError, match=r"^control\.target: "):
        api.run(tables | {"control": {"target": "1 kN"}})
