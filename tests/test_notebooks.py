"""Notebooks of the documentation: what is stored is whole, and running them again gives the same."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
NAMES = sorted(path.stem for path in (ROOT / "docs" / "notebooks").glob("*.ipynb"))


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script that runs notebooks."""
    for name in ("nbformat", "nbclient", "ipykernel"):
        pytest.importorskip(name)
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module("notebooks")


def stored(script: ModuleType, name: str) -> Any:
    return script.nbformat.read(script.FOLDER / f"{name}.ipynb", as_version=4)


def test_there_are_some() -> None:
    assert len(NAMES) >= 3


@pytest.mark.parametrize("name", NAMES)
def test_what_is_stored_is_whole(name: str, script: ModuleType) -> None:
    """Every cell was run, in order and without errors; no line of progress is left, and no path of a machine."""
    notebook = stored(script, name)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert not [output for cell in cells for output in cell.outputs if output.output_type == "error"]
    text = "\n".join(script.texts(notebook))
    assert "<progress" not in text
    assert "/src/fissura" not in text
    assert not any(cell.metadata for cell in notebook.cells)
    assert not [output for cell in cells for output in cell.outputs if "image/jpeg" in output.get("data", {})]


def test_differences_are_told(script: ModuleType) -> None:
    notebook, other = stored(script, NAMES[0]), stored(script, NAMES[0])
    assert script.differences(notebook, other) == []
    cell = next(cell for cell in other.cells if cell.get("outputs"))
    cell.outputs = []
    assert script.differences(notebook, other) != []


def test_last_digits_are_no_difference(script: ModuleType) -> None:
    assert script._alike("peak 1.497 kN,  2.50e-07 m", "peak 1.498 kN, 2.5e-07 m")
    assert script._alike("balance -0.00 %", "balance 0.00 %")
    assert not script._alike("peak 1.49 kN", "peak 1.59 kN")
    assert not script._alike("540 bodies", "540 facets")


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_notebooks_run_and_show_what_they_say(name: str, script: ModuleType) -> None:
    from fissura.pictures.pyvista_tools import can_render

    if not can_render():
        pytest.skip("nothing can be drawn here")
    assert script.differences(stored(script, name), script.executed(script.FOLDER / f"{name}.ipynb")) == []
