"""The specimen of a case in a window that turns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from fissura.cli import app
from fissura.errors import InputError
from fissura.pictures import pyvista_tools
from fissura.pictures.pyvista_tools import polygon_mesh, pyvista, screenshot
from fissura.pictures.specimen import Sight
from fissura.pictures.specimen_window import specimen_view
from fissura.simulation.loop import Simulation

from .rendering import needs_rendering

runner = CliRunner()

PLATEN = {"load__width": 0.01, "load__platen": "glued", "gravity": {"density": 2400.0}}


@pytest.fixture
def beam(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("beam.toml").write_text(runner.invoke(app, ["new", "beam"]).stdout)
    return tmp_path


def without_pyvista(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(pyvista_tools, "import_module", missing)


def test_without_pyvista(beam: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    without_pyvista(monkeypatch)
    with pytest.raises(InputError, match=r'pip install "fissura\[view\]"'):
        pyvista()
    found = runner.invoke(app, ["show", "beam.toml", "--interactive"])
    assert found.exit_code == 2
    assert found.stderr == (
        'error: pyvista: is not installed; 3D views need it (allowed: pip install "fissura[view]")\n'
    )


def test_without_a_screen(beam: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    monkeypatch.setattr(pyvista_tools, "can_open_windows", lambda: False)
    found = runner.invoke(app, ["show", "beam.toml", "--interactive"])
    assert (found.exit_code, found.stderr.split(":")[1].strip()) == (2, "--interactive")
    wrong = runner.invoke(app, ["show", "beam.toml", "--interactive", "--output", "beam.pdf"])
    assert wrong.exit_code == 2
    assert "--output: beam.pdf: views are written as .png only" in wrong.stderr


def test_where_nothing_can_be_drawn(small_case: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The drivers of which there are none are asked in a process of their own, which they end."""
    pytest.importorskip("pyvista")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pyvista_tools, "can_render", pyvista_tools.can_render.__wrapped__)
    monkeypatch.setattr(pyvista_tools.sys, "platform", "linux")
    monkeypatch.setattr(pyvista_tools, "_TRIAL", "import os; os.abort()")
    with pytest.raises(InputError, match="cannot draw on this machine"):
        specimen_view(Simulation(small_case()), off_screen=True)


def test_polygons_as_a_mesh() -> None:
    pytest.importorskip("pyvista")
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [2, 0, 1], [0, 2, 1]], float)
    mesh = polygon_mesh(points, np.array([0, 4, 7]))
    assert mesh.compute_cell_sizes()["Area"] == pytest.approx([1.0, 2.0])
    assert polygon_mesh(points[:0], np.array([0])).n_cells == 0


@needs_rendering
def test_what_is_shown(small_case: Any) -> None:
    pv = pytest.importorskip("pyvista")
    simulation = Simulation(small_case(**PLATEN))
    view = specimen_view(simulation, Sight(90.0, 0.0), off_screen=True)
    try:
        position, focal, up = (np.array(part) for part in view.camera_position)
        assert (position - focal) / np.linalg.norm(position - focal) == pytest.approx([1.0, 0.0, 0.0])
        assert up == pytest.approx([0.0, 1.0, 0.0])
        meshes = [actor.mapper.dataset for actor in view.actors.values() if isinstance(actor, pv.Actor)]
        skin = sum(mesh.area for mesh in meshes[:3])  # coarse, fine, walls of the notch
        assert skin == pytest.approx(1e6 * simulation.tessellation.surface.area.sum(), rel=1e-5)
        words = {actor.GetInput() for actor in view.actors.values() if hasattr(actor, "GetInput")}
        expected = {"coarse body", "fine body", "wall of a notch", "platen, glued", "support, pin", "support, roller"}
        assert {*expected, "load", "gauge, from a to b", "gravity"} <= words
    finally:
        view.close()


@needs_rendering
@pytest.mark.slow
def test_a_picture_of_the_view(beam: Path) -> None:
    found = runner.invoke(app, ["show", "beam.toml", "--interactive", "--output", "view.png"])
    assert (found.exit_code, found.stdout) == (0, "picture: view.png\n")
    with Image.open("view.png") as picture:
        assert picture.size == pyvista_tools.WINDOW
        assert len(picture.convert("RGB").getcolors(1_000_000)) > 100
    bad = runner.invoke(app, ["show", "beam.toml", "--interactive", "--output", "no/view.png"])
    assert bad.exit_code == 4


@needs_rendering
@pytest.mark.slow
def test_words_of_users_are_no_mathematics(small_case: Any, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    pictures = []
    for name in ("$x$", "$y$"):
        screenshot(specimen_view(Simulation(small_case(name=name)), off_screen=True), tmp_path / "view.png")
        with Image.open(tmp_path / "view.png") as picture:
            pictures.append(np.asarray(picture.crop((0, 0, 60, 30))))
    assert (pictures[0] != pictures[1]).any()
    assert pictures[0].min() < 128
