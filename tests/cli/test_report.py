"""``fissura report``, and ``fissura run --report``."""

from __future__ import annotations

import errno
from pathlib import Path
from typing import Any

import pytest

import fissura.api.pages
from fissura.errors import InputError
from fissura.reports import libraries
from fissura.results import Result
from reports.made import made

from .fakes import FakeSimulation, call


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place: Path = tmp_path_factory.mktemp("run")
    made(place)
    return place


def test_report(folder: Path, tmp_path: Path) -> None:
    done = call("report", folder)
    assert done.exit_code == 0
    assert done.stdout.startswith(f"report: {folder / 'report.html'}, 3.")
    assert (folder / "report.html").stat().st_size < 15e6
    assert call("report", folder, "--output", tmp_path / "a.html").exit_code == 0
    assert (tmp_path / "a.html").read_bytes() == (folder / "report.html").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("none",), "there is no such folder"),
        ((".",), "holds no results"),
        (("RUN", "--output", "a.pdf"), "--output: a.pdf: reports are written as .html only"),
    ],
)
def test_no_report(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = call("report", *(str(folder) if word == "RUN" else word for word in arguments))
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")
    assert words in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_report_that_cannot_be_written(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(data: str, path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr("fissura.api.pages.write_page", full)
    done = call("report", folder, "--output", tmp_path / "a.html")
    assert done.exit_code == 4
    assert f"{tmp_path / 'a.html'}: cannot be written: No space left" in done.stderr
    monkeypatch.undo()
    done = call("report", folder, "--output", tmp_path / "none" / "a.html")
    assert done.exit_code == 4
    assert "a.html: cannot be written" in done.stderr


def test_without_the_extra(
    folder: Path, tiny: Path, fake: type[FakeSimulation], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(libraries, "find_spec", lambda name: None if name == "plotly" else object())
    for words in (("report", folder), ("run", tiny, "--report", "--output", "out")):
        done = call(*words)
        assert done.exit_code == 2
        assert 'plotly: is not installed; reports need it (allowed: pip install "fissura[report]")' in done.stderr
    assert fake.built == []  # nothing was computed
    assert not Path("out").exists()


def reports(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What reports are asked for, instead of any."""
    asked: list[Any] = []

    def report(source: Any, path: Path | None = None, **more: Any) -> Path:
        asked.append(source)
        wanted = Path("report.html")
        wanted.write_text("page")
        return wanted

    monkeypatch.setattr("fissura.api.pages.report", report)
    return asked


def test_a_run_with_a_report(tiny: Path, fake: type[FakeSimulation], monkeypatch: pytest.MonkeyPatch) -> None:
    asked = reports(monkeypatch)
    assert call("run", tiny, "--output", "a").exit_code == 0
    assert asked == []
    done = call("run", tiny, "--output", "b", "--report", "--quiet")
    assert done.exit_code == 0
    assert done.stdout == "report: report.html, 0.0 MB\n"
    assert [str(result.folder) for result in asked] == ["b"]


def test_a_run_that_stops_has_a_report_too(
    tiny: Path, fake: type[FakeSimulation], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = reports(monkeypatch)
    monkeypatch.setattr(fake, "ending", fissura.RunStopped("no equilibrium", 13, 1e-6))
    done = call("run", tiny, "--output", "a", "--report")
    assert done.exit_code == 3
    assert "report: report.html" in done.stdout
    assert "no equilibrium" in done.stderr
    assert len(asked) == 1


def test_a_report_that_fails_leaves_the_run(
    tiny: Path, fake: type[FakeSimulation], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(source: Result, path: Path | None = None, **more: Any) -> Path:
        raise InputError("report.html", "is there, and Fissura did not write it", "another name")

    monkeypatch.setattr("fissura.api.pages.report", fails)
    done = call("run", tiny, "--output", "a", "--report")
    assert done.exit_code == 2
    assert "Fissura did not write it" in done.stderr
    assert (Path("a") / "curve.csv").exists()
