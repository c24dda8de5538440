"""One realisation: what it leaves behind, however it ends, and how that is written and read."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fissura import Result, run
from fissura.case import Case
from fissura.ensemble.outcome import CrackStart, Outcome, compute
from fissura.ensemble.plan import Plan
from fissura.ensemble.store import Store
from fissura.ensemble.table import COLUMNS, read_table, table, write_table
from fissura.errors import InputError, RunStopped

Build = Callable[..., Case]


def test_a_realisation_is_the_run_of_its_case(tiny: Build, tmp_path: Path) -> None:
    task = Plan(tiny(), 4, "both", master=9).run(3)
    outcome, alone = compute(task), run(task.case)
    summary = Store(tmp_path).write(outcome)
    again = Result.load(tmp_path / "runs" / "0003")
    assert again.case == task.case
    assert (outcome.status, again.peak_load, again.steps) == ("finished", alone.peak_load, alone.steps)
    for name in ("load_N", "gauge_m", "dissipated_J"):
        np.testing.assert_array_equal(outcome.curve[name], alone.curve[name])
        np.testing.assert_allclose(again.curve[name], alone.curve[name], rtol=1e-11)
    about = summary["realisation"]
    assert (about["kind"], about["number"], about["field_seed"]) == ("run", 3, task.case.field.seed)
    assert not (tmp_path / "runs" / ".0003.part").exists()


def test_all_files_of_a_run_are_kept_when_asked(tiny: Build, tmp_path: Path) -> None:
    task = Plan(tiny(output__vtk=1), 1, "geometry", keep=True).companion(0)
    Store(tmp_path).write(compute(task))
    names = {path.name for path in (tmp_path / "companions" / "0000").iterdir()}
    assert {"curve.csv", "summary.json", "case.json", "bodies.pvd", "crack.png", "state_last.npz"} <= names
    assert Result.load(tmp_path / "companions" / "0000").last.damage.max() > 0.0


def test_the_crack_starts_where_a_contact_first_opens_wide() -> None:
    def step(number: int, *openings: float) -> Any:
        contacts = SimpleNamespace(centroid=np.arange(6.0).reshape(2, 3))
        snapshot = SimpleNamespace(opening=np.array(openings), tessellation=SimpleNamespace(contacts=contacts))
        return SimpleNamespace(snapshot=snapshot, gauge=0.1 * number, load=10.0 * number)

    start = CrackStart(2.0)
    for number, openings in enumerate([(0.0, 0.0), (1.9, 0.0), (2.0, 2.5), (9.0, 3.0)]):
        start.watch(step(number, *openings))
    assert start.found == {"x_m": 3.0, "y_m": 4.0, "z_m": 5.0, "gauge_m": pytest.approx(0.2), "load_N": 20.0}


def test_the_crack_of_a_notched_beam_starts_at_its_notch(tiny: Build) -> None:
    found = compute(Plan(tiny(), 1, "geometry").companion(0)).crack_start
    assert found is not None
    assert found["x_m"] == pytest.approx(0.04, abs=0.006)
    assert 0.005 < found["y_m"] < 0.016


STOPPED = RunStopped("no equilibrium", 3, 1e-6)
OUT_OF_MEMORY = RunStopped("out of memory", 3, 1e-6)
OUT_OF_MEMORY.__cause__ = MemoryError()
ENDS = [
    (STOPPED, "stopped", False, "no equilibrium"),
    (OUT_OF_MEMORY, "stopped", True, "out of memory"),
    (InputError("field.length", "too small"), "failed", False, "field.length: too small"),
    (MemoryError(), "failed", True, "MemoryError"),
    (OSError(28, "No space left on device"), "failed", True, "No space left"),
    (ZeroDivisionError("a bug"), "failed", True, "ZeroDivisionError: a bug"),
]


@pytest.mark.parametrize(("error", "status", "again", "message"), ENDS, ids=lambda value: type(value).__name__)
def test_every_way_to_end_is_an_outcome(
    tiny: Build,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    error: Exception,
    status: str,
    again: bool,
    message: str,
) -> None:
    task = Plan(tiny(), 2, "both").run(2)
    part = run(task.case)
    if status == "stopped":
        error.result = part  # type: ignore[attr-defined]

    def fail(*arguments: Any, **options: Any) -> None:
        raise error

    monkeypatch.setattr("fissura.ensemble.outcome.run_case", fail)
    outcome = compute(task)
    assert (outcome.status, outcome.again) == (status, again)
    assert message in outcome.message
    store = Store(tmp_path)
    summary = store.write(outcome)
    loaded = Result.load(store.place("run", 2))
    assert (loaded.summary["status"], loaded.steps) == (status, part.steps if status == "stopped" else 0)
    assert (loaded.folder / "error.txt").exists() == (status == "failed")
    # A deterministic failure is done, the machine's fault is tried again.
    assert (task.key in store.kept().again, task.key in store.kept().done) == (again, not again)
    rows = table([summary])
    assert (rows["status"][0], rows["number"][0]) == (status, 2)
    assert message in rows["error"][0]
    assert np.isnan(rows["peak_load_N"][0]) == (status == "failed")


def test_a_disk_that_fills_leaves_no_half_realisation(
    tiny: Build, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fissura.ensemble.store as module

    task = Plan(tiny(), 1).run(1)

    def full(path: Path, summary: Any) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(module, "write_summary", full)
    with pytest.raises(OSError, match="No space"):
        Store(tmp_path).write(Outcome.failed(task, MemoryError()))
    assert list((tmp_path / "runs").iterdir()) == []
    assert Store(tmp_path).kept().summaries == {}


def test_tables_are_read_back(tiny: Build, tmp_path: Path) -> None:
    plan, store = Plan(tiny(), 2, "both"), Store(tmp_path)
    store.write(compute(plan.companion(0)))
    store.write(compute(plan.run(1)))
    store.write(Outcome.failed(plan.run(2), InputError("a, b", 'with "quotes"\nand two lines')))
    rows = table(store.kept().summaries.values())
    assert rows["kind"].tolist() == ["companion", "run", "run"]
    assert rows["past_peak"].tolist() == [True, True, False]
    assert rows["field_seed"].tolist() == [-1, *(plan.seeds(k)[1] for k in (1, 2))]
    write_table(rows, tmp_path)
    for name in ("runs.csv", "runs.parquet"):
        found = read_table(tmp_path / name)
        assert list(found) == list(COLUMNS)
        for column in COLUMNS:
            np.testing.assert_array_equal(found[column], rows[column])
    with (tmp_path / "runs.csv").open(newline="") as file:
        last = list(csv.DictReader(file))[-1]
    assert (last["peak_load_N"], last["bodies_end"], last["past_peak"]) == ("", "", "false")
    import pyarrow.parquet

    raw = pyarrow.parquet.read_table(tmp_path / "runs.parquet").to_pydict()
    assert raw["peak_load_N"][2] is None
    assert raw["field_seed"][0] is None


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n", "kind,number\nrun\n", "\x00"])
def test_what_is_not_a_table_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "runs.csv").write_text(text)
    with pytest.raises(InputError, match=r"runs\.csv"):
        read_table(tmp_path)
    (tmp_path / "runs.parquet").write_text(text)
    with pytest.raises(InputError, match=r"runs\.parquet"):
        read_table(tmp_path / "runs.parquet")


def test_the_plan_of_a_folder_is_kept_to(tiny: Build, tmp_path: Path) -> None:
    store = Store(tmp_path)
    with pytest.raises(InputError, match=r"ensemble\.json"):
        store.resume(Plan(tiny(), 2))
    store.begin(Plan(tiny(), 2, "both"))
    assert store.resume(Plan(tiny(), 5, "both", companions="each", keep=True)) == ""
    changed = [
        (Plan(tiny(material__f_t="2.3 MPa"), 2, "both"), "material.f_t was 2200000.0 and is now 2300000.0"),
        (Plan(tiny(field__length="21 mm"), 2, "both"), "field.length"),
        (Plan(tiny(field=None), 2), 'mode was "both" and is now "geometry"'),
        (Plan(tiny(), 2, "both", master=2), "seed was 1 and is now 2"),
        (Plan(tiny(), 2, "both", full=True), "full was false"),
        (Plan(tiny(), 2, "both", "latin-hypercube"), "sampling"),
    ]
    for plan, message in changed:
        with pytest.raises(InputError) as caught:
            store.resume(plan)
        assert message in str(caught.value)
    # A Latin hypercube of another size is another one.
    store.begin(Plan(tiny(), 2, "both", "latin-hypercube"))
    with pytest.raises(InputError, match="runs was 2 and is now 3"):
        store.resume(Plan(tiny(), 3, "both", "latin-hypercube"))


def test_other_versions_are_a_warning(tiny: Build, tmp_path: Path) -> None:
    store, path = Store(tmp_path), tmp_path / "ensemble.json"
    store.begin(Plan(tiny(), 2))
    data = json.loads(path.read_text())
    data["versions"]["numpy"] = "1.0"
    path.write_text(json.dumps(data))
    assert "numpy 1.0, now" in store.resume(Plan(tiny(), 2))


def test_a_new_ensemble_removes_the_earlier_one_and_nothing_else(tiny: Build, tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.begin(Plan(tiny(), 1))
    store.write(compute(Plan(tiny(), 1).run(1)))
    (tmp_path / "notes.txt").write_text("mine")
    store.begin(Plan(tiny(), 1, master=2))
    assert sorted(path.name for path in tmp_path.iterdir()) == [".fissura", "case.json", "ensemble.json", "notes.txt"]
