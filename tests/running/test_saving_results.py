"""`Result.save` and `Result.load` give back the same numbers."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import Result
from fissura.running.recorder import Recorder
from fissura.running.storing import Folder
from results.pictured import record
from results.synthetic import simulation, steps


def same(a: Any, b: Any) -> None:
    """Assert that two results are the same, bit for bit."""
    assert (a.full, a.summary) == (b.full, b.summary)
    assert a.case.model_dump(exclude={"source"}) == b.case.model_dump(exclude={"source"})
    assert list(a.curve) == list(b.curve)
    for name in a.curve:
        np.testing.assert_array_equal(a.curve[name], b.curve[name])
        assert a.curve[name].dtype.kind == b.curve[name].dtype.kind
    assert list(a.snapshots) == list(b.snapshots)
    for number, snapshot in a.snapshots.items():
        equal(snapshot, b.snapshots[number])
    if not a.steps:
        return
    assert len(a.frames) == len(b.frames)
    for mine, other in zip(a.frames, b.frames, strict=True):
        equal(mine, other)


def equal(a: Any, b: Any) -> None:
    for field in fields(a):
        mine, other = getattr(a, field.name), getattr(b, field.name)
        if hasattr(mine, "__dataclass_fields__"):
            equal(mine, other)
        else:
            np.testing.assert_array_equal(mine, other, field.name)


@pytest.mark.parametrize("vtk", [0, 3])
def test_results_in_memory(tmp_path: Path, vtk: int) -> None:
    recorder = Recorder(simulation(vtk=vtk), None)
    for step in steps([100.0 / 3.0, 300.0, 1234.0, 50.0]):
        recorder.add(step)
    result = recorder.finish("finished")
    folder = result.save(tmp_path / "a")
    assert folder == tmp_path / "a"
    found = Result.load(folder)
    same(result, found)
    assert found.folder == folder
    assert {"curve.png", "crack.png", "case.json"} <= {path.name for path in folder.iterdir()}
    assert (folder / "bodies.pvd").exists() == (vtk > 0)
    same(found, Result.load(found.save(tmp_path / "b")))


def test_results_of_a_folder_are_copied(tmp_path: Path) -> None:
    result = record(tmp_path / "run")
    (tmp_path / "run" / "checkpoint.npz").write_bytes(b"where the run stands")
    (tmp_path / "run" / "notes.txt").write_text("mine")
    Folder(tmp_path / "run").add("checkpoint.npz")
    assert len(result.snapshots) == 2  # the peak and the end; a run writes only the last
    assert list(Result.load(tmp_path / "run").snapshots) == [6]
    copy = result.save(tmp_path / "copy")
    same(result, Result.load(copy))
    assert (copy / "checkpoint.npz").read_bytes() == b"where the run stands"
    assert not (copy / "notes.txt").exists()
    again = Result.load(copy).save(tmp_path / "again")
    same(result, Result.load(again))


def test_a_run_without_steps(tmp_path: Path) -> None:
    result = Recorder(simulation(), None).finish("stopped", "no way on")
    same(result, Result.load(result.save(tmp_path / "none")))


def test_what_must_not_be_replaced_stays(tmp_path: Path) -> None:
    result = record(tmp_path / "run")
    with pytest.raises(InputError, match="is the folder of these results"):
        result.save(tmp_path / "run", overwrite=True)
    result.save(tmp_path / "copy")
    with pytest.raises(InputError, match="is not empty"):
        result.save(tmp_path / "copy")
    (tmp_path / "copy" / "notes.txt").write_text("mine")
    same(result, Result.load(result.save(tmp_path / "copy", overwrite=True)))
    assert (tmp_path / "copy" / "notes.txt").read_text() == "mine"
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.tex").write_text("x")
    with pytest.raises(InputError, match="files that Fissura did not write"):
        result.save(tmp_path / "other", overwrite=True)


def test_a_folder_that_is_gone(tmp_path: Path) -> None:
    result = record(tmp_path / "run")
    (tmp_path / "run" / "summary.json").unlink()
    with pytest.raises(InputError, match="holds no results"):
        result.save(tmp_path / "copy")
