"""Folders of ensembles to which something has happened."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fissura.case import Case
from fissura.cli import app
from fissura.ensemble.kept import kept
from fissura.ensemble.outcome import Outcome
from fissura.ensemble.plan import Plan
from fissura.ensemble.store import Store

Build = Callable[..., Case]


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-30])


def zeroed(path: Path) -> None:
    """As a power failure leaves it."""
    path.write_bytes(b"\0" * path.stat().st_size)


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def renumbered(path: Path) -> None:
    summary = json.loads(path.read_text())
    summary["realisation"]["number"] = 7
    path.write_text(json.dumps(summary))


def another(path: Path) -> None:
    path.write_text('{"format_version": 1}')


def nested(path: Path) -> None:
    path.write_text("[" * 100_000)


@pytest.mark.parametrize(
    ("name", "damage", "said"),
    [
        ("summary.json", emptied, "is not JSON"),
        ("summary.json", zeroed, "is not JSON"),
        ("summary.json", cut, "is not JSON"),
        ("summary.json", Path.unlink, "cannot be read"),
        ("summary.json", renumbered, "is of run 7"),
        ("summary.json", another, "is not of a realisation"),
        ("case.json", emptied, "is not JSON"),
        ("case.json", nested, "is nested too deeply"),
        ("curve.csv", emptied, "is damaged"),
        ("curve.csv", zeroed, "is damaged"),
        ("curve.csv", Path.unlink, "cannot be read"),
    ],
)
def test_a_broken_file_costs_its_realisation_only(
    tiny: Build, tmp_path: Path, name: str, damage: Callable[[Path], None], said: str
) -> None:
    store, plan = Store(tmp_path), Plan(tiny(), 3)
    for task in plan.tasks():
        store.write(Outcome.failed(task, ValueError("why")))
    damage(tmp_path / "runs" / "0002" / name)
    found = kept(tmp_path)
    assert list(found.summaries) == [("companion", 0), ("run", 1), ("run", 3)]
    (note,) = found.notes()
    assert note.startswith(f"{tmp_path / 'runs' / '0002'}: {name} {said}")
    assert note.endswith("this realisation counts as missing and is computed again")


def test_what_is_no_realisation_is_left_alone_and_named(tiny: Build, tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.write(Outcome.failed(Plan(tiny(), 3).run(3), ValueError("why")))
    runs = tmp_path / "runs"
    for name in ("0003_old", "3", "00003", "copy of 0003", "0004é", "-003", ".0009.part"):
        (runs / name).mkdir()
    (runs / "0005").write_text("notes")
    found = kept(tmp_path)
    assert list(found.summaries) == [("run", 3)]
    assert {path.name for path in found.strangers} == {
        *("0003_old", "3", "00003", "copy of 0003", "0004é", "-003", "0005")
    }
    (note,) = found.notes()
    assert note.startswith(f"no realisation of this ensemble, and left alone: {runs / '-003'}")
    assert note.endswith(", ...")


def test_many_broken_ones_are_counted(tiny: Build, tmp_path: Path) -> None:
    store = Store(tmp_path)
    for task in Plan(tiny(), 9, companions="none").tasks():
        store.write(Outcome.failed(task, ValueError("why")))
        emptied(store.place("run", task.number) / "summary.json")
    *_, last = kept(tmp_path).notes()
    assert last == "4 more realisations cannot be read and are computed again"


def test_there_may_be_nothing(tmp_path: Path) -> None:
    found = kept(tmp_path)
    assert (found.summaries, list(found.notes())) == ({}, [])


@pytest.mark.usefixtures("inline", "few_pictures")
def test_resume_computes_again_what_is_broken_and_says_so(tiny_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    command = ["ensemble", str(tiny_file), "--runs", "3", "--output", str(folder)]
    assert CliRunner().invoke(app, command).exit_code == 0
    curve, other = (folder / "runs" / name / "curve.csv" for name in ("0002", "0003"))
    before, untouched = curve.read_text().count("\n"), other.stat().st_mtime_ns
    emptied(folder / "runs" / "0002" / "summary.json")
    (folder / "runs" / "0003_old").mkdir()
    done = CliRunner().invoke(app, [*command, "--resume"])
    assert done.exit_code == 0
    assert "3 of 3 finished" in done.stdout
    assert f"warning: {folder / 'runs' / '0002'}: summary.json is not JSON" in done.stderr
    assert f"left alone: {folder / 'runs' / '0003_old'}\n" in done.stderr
    assert "4 runs, companions included, 3 of them there already" in done.stderr
    assert (folder / "runs" / "0003_old").is_dir()
    assert (curve.read_text().count("\n"), other.stat().st_mtime_ns) == (before, untouched)
