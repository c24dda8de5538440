"""The page of an ensemble: what moves on it, links to runs, and what is there without the extra ``report``."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import fissura
import fissura.ensemble.report as report
from fissura.case import Case
from fissura.cli import app
from fissura.ensemble import interactive
from fissura.ensemble.outcome import compute
from fissura.ensemble.plan import Plan
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.runner import evaluate
from fissura.ensemble.store import Store
from fissura.errors import InputError
from fissura.reports import libraries
from reports.browsing import launcher, needs_browser, opened
from reports.unpacking import data_of

Build = Callable[..., Case]

pytestmark = pytest.mark.usefixtures("few_pictures")


@pytest.fixture(scope="module")
def folder(tiny: Build, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An ensemble of four runs and a companion; its case has a title to be careful with."""
    place: Path = tmp_path_factory.mktemp("ensemble")
    plan = Plan(tiny(name="tiny & 'co' {{7 + 7}}"), 4, "both", master=4)
    store = Store(place)
    store.begin(plan)
    for task in plan.tasks():
        store.write(compute(task))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "ENSEMBLE_PICTURES", {"curves": report.ENSEMBLE_PICTURES["curves"]})
        evaluate(plan, store)
    return place


@pytest.fixture
def result(folder: Path) -> EnsembleResult:
    return EnsembleResult.load(folder)


def traces(data: dict[str, Any], name: str, view: int = 0) -> list[dict[str, Any]]:
    return [trace for trace in data["lines"]["views"][view]["traces"] if trace["name"] == name]


def test_curves_with_mean_and_band(result: EnsembleResult) -> None:
    data = data_of((result.folder / "report.html").read_text())
    band = result.band
    assert band is not None
    assert len(data["lines"]["views"]) == (2 if band.over == "dissipated energy" else 1)
    runs = traces(data, "runs")
    assert [trace["showlegend"] for trace in runs] == [True, False, False, False]
    for number, trace in zip(result.paths, runs, strict=True):
        assert f"run {number}<br>" in trace["hovertemplate"]
        path = result.paths[number]
        assert trace["y"].max() / trace["y"][-1] == pytest.approx(path.load.max() / path.load[-1])
        assert len(trace["x"]) == len(path.value)
    assert len(traces(data, "deterministic")) == 1
    (mean,) = traces(data, "mean", -1)
    until = band.until
    np.testing.assert_allclose(mean["y"] / mean["y"].max(), band.mean[:until] / band.mean[:until].max())


def test_a_view_over_the_dissipated_energy(result: EnsembleResult) -> None:
    energy = np.linspace(0.0, 1e-3, 5)
    from fissura.ensemble.band import Band

    band = Band("dissipated energy", energy, np.full(5, 4), 100 * energy, np.tile(energy, (3, 1)), energy)
    object.__setattr__(result, "band", band)
    first, second = interactive.page_data(result)[0]["lines"]["views"]
    assert (first["name"], second["name"]) == ("over the gauge opening", "over the dissipated energy")
    assert "mean" not in {trace["name"] for trace in first["traces"]}
    assert second["x"] == "dissipated energy [mJ]"
    assert {"runs", "mean", "5 % to 95 %"} <= {trace["name"] for trace in second["traces"]}


def test_where_cracks_started(result: EnsembleResult) -> None:
    data, told = interactive.page_data(result)
    assert told["marked"] == int(np.isfinite(result.runs["crack_start_x_m"]).sum()) > 0
    assert data["scene"]["marks"]["high"] == pytest.approx(result.peaks.max())
    assert ("load", "#b42318") in told["signs"]


def test_only_some_of_many_curves(result: EnsembleResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(interactive, "MOST_LINES", 2)
    page = report.write_report(result, tmp_path / "a.html").read_text()
    assert len(traces(data_of(page), "runs")) == 2
    assert "Drawn are 2 of 4 runs" in page


def test_only_some_of_many_rows(result: EnsembleResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(report, "MOST_ROWS", 3)
    page = report.write_report(result, tmp_path / "a.html").read_text()
    assert "The first 3 of 5; runs.csv has all of them." in page


def test_pictures_that_move_are_not_there_twice(folder: Path) -> None:
    assert (folder / "pictures" / "curves.png").exists()
    assert "data:image/png" not in (folder / "report.html").read_text()


def test_without_the_extra(result: EnsembleResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(report, "have_libraries", lambda: False)
    page = report.write_report(result, tmp_path / "a.html").read_text()
    assert "<script" not in page
    assert 'pip install "fissura[report]"' in page
    assert page.count("data:image/png;base64,") == 1
    assert len(page) < 1e6
    assert not (tmp_path / "pictures").exists()
    monkeypatch.setattr(libraries, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"fissura\[report\]"):
        fissura.report(result)


def test_the_title_is_escaped(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    assert "<title>tiny &amp; &#39;co&#39; {{7 + 7}}: 4 runs</title>" in page


def test_a_study(tiny: Build, tmp_path: Path, inline: None) -> None:
    study = fissura.sweep(
        tiny(field=None, control__stop_load=0.8), {"material.f_t": ["2 MPa", "3 MPa"]}, output=tmp_path
    )
    data, told = interactive.page_data(study)
    names = [trace["name"] for trace in data["lines"]["views"][0]["traces"]]
    assert len(names) == len(set(names)) == 2
    assert "2 MPa" in names[0]
    assert told["marked"] == 0


# Pages of runs, and links to them


def test_pages_of_all_runs(folder: Path, tmp_path: Path) -> None:
    assert 'href="runs' not in (folder / "report.html").read_text()
    done = CliRunner().invoke(app, ["report", str(folder), "--runs"])
    assert done.exit_code == 0, done.stderr
    assert done.stdout.startswith(f"report: {folder / 'report.html'}")
    page = (folder / "report.html").read_text()
    links = re.findall('href="([^"]*report.html)"', page)
    assert links == [*(f"runs/{number:04d}/report.html" for number in range(1, 5)), "companions/0000/report.html"]
    for link in links:
        assert "which left no states" in (folder / link).read_text()
    # From elsewhere they lead to the same files.
    other = fissura.report(folder, tmp_path / "a.html").read_text()
    for link in re.findall('href="([^"]*report.html)"', other):
        assert (tmp_path / link).is_file()


def test_a_run_that_cannot_be_read(folder: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    copy = EnsembleResult.load(folder).save(tmp_path / "copy")
    (copy.folder / "runs" / "0002" / "curve.csv").write_text("")
    for path in copy.folder.glob("*/*/report.html"):
        path.unlink()
    told: list[tuple[int, int]] = []
    from fissura.api.pages import _runs

    _runs(copy, lambda done, count: told.append((done, count)))
    assert "run 0002 has no page" in caplog.text
    assert told[-1] == (5, 5)
    assert not (copy.folder / "runs" / "0002" / "report.html").exists()
    assert (copy.folder / "runs" / "0003" / "report.html").exists()


def test_pages_of_runs_are_of_ensembles(folder: Path) -> None:
    with pytest.raises(InputError, match="--runs: is for ensembles"):
        fissura.report(folder / "runs" / "0001", runs=True)


@pytest.fixture
def started() -> Iterator[Any]:
    with launcher() as browsers:
        found = browsers()
        yield found
        found.close()


@pytest.mark.slow
@needs_browser
def test_in_a_browser(started: Any, folder: Path) -> None:
    for width in (1280, 400):
        with opened(started, folder / "report.html", width=width) as page:
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            assert page.title() == "tiny & 'co' {{7 + 7}}: 4 runs"
            assert page.locator("#curve .legendtext").count() >= 3
            assert "peak load of the run" in page.locator("#view-colours").inner_text()
            before = page.locator("#view").screenshot()
            page.select_option("#view-cut", "0")
            page.wait_for_timeout(300)
            assert page.locator("#view").screenshot() != before
