"""Bodies and cracks of a step as PyVista meshes, and the view of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from fissura.errors import InputError
from fissura.pictures import pyvista_tools
from fissura.pictures.meshes import meshes_of, step_of
from fissura.pictures.result_window import result_view, skin_of
from fissura.results import Result
from fissura.results.vtk import write_snapshot
from fissura.running.recorder import Recorder
from results.pictured import SIZE, coarse_and_fine
from results.synthetic import simulation, snapshot, step

from .rendering import needs_rendering

pyvista = pytest.importorskip("pyvista")


def torn(t: Any, width: float) -> Any:
    """A block torn in two at half its length; bodies turn, too."""
    right = t.x[:, 0] > 0.5 * SIZE[0]
    displacement = np.zeros((len(t), 6))
    displacement[right, 0] = width
    displacement[:, 5] = 1e-4
    across = right[t.contacts.bodies[:, 0]] != right[t.contacts.bodies[:, 1]]
    return snapshot(t, displacement, np.where(across, width, 0.0))


@pytest.fixture(scope="module")
def shot() -> Any:
    return torn(coarse_and_fine()[1], 5e-6)


@pytest.fixture
def result(shot: Any) -> Result:
    recorder = Recorder(simulation(), None)
    recorder.add(step(1, 1e-4, 100.0, shot))
    return recorder.finish("finished")


def test_meshes_are_the_structure(result: Result, shot: Any) -> None:
    t = shot.tessellation
    meshes = result.to_pyvista()
    bodies, cracks = meshes["bodies"], meshes["cracks"]
    body = bodies.cell_data["body"]
    np.testing.assert_array_equal(np.sort(body), np.arange(len(t)))
    # VTK's own volume of a polyhedron drops slivers here and there; that inside the faces does not.
    assert bodies.extract_surface(algorithm=None).triangulate().volume == pytest.approx(SIZE.prod(), rel=1e-6)
    assert np.median(np.abs(bodies.compute_cell_sizes()["Volume"] / t.volume[body] - 1.0)) < 1e-9
    assert bodies.bounds == pytest.approx([0, SIZE[0], 0, SIZE[1], 0, SIZE[2]], abs=1e-12)
    np.testing.assert_allclose(bodies.cell_data["displacement"], shot.displacement[body, :3])
    open_ = np.flatnonzero(shot.damage > 0)
    np.testing.assert_array_equal(np.unique(cracks.cell_data["contact"]), open_)
    area = cracks.compute_cell_sizes()["Area"].sum()
    assert area == pytest.approx(t.contacts.area[open_].sum(), rel=1e-6)


@needs_rendering
def test_nothing_has_cracked(shot: Any) -> None:
    whole = snapshot(shot.tessellation)
    recorder = Recorder(simulation(), None)
    recorder.add(step(1, 1e-4, 100.0, whole))
    result = recorder.finish("finished")
    assert result.to_pyvista()["cracks"].n_cells == 0
    result_view(result, off_screen=True).close()


def test_steps_of_the_folder_are_read_from_its_files(result: Result, shot: Any, tmp_path: Path) -> None:
    """In memory and from the file, the meshes of a step are the same."""
    write_snapshot(tmp_path, 3, shot)
    (tmp_path / "bodies_0007.vtu").touch()  # without its contacts
    (tmp_path / "bodies_last.vtu").touch()
    there = Result(result.case, False, result.curve, result.summary, {}, tmp_path)
    assert step_of(there, None) == 3
    read, made = there.to_pyvista(3), result.to_pyvista(1)
    for name in ("bodies", "cracks"):
        np.testing.assert_array_equal(read[name].points, made[name].points)
        assert set(read[name].cell_data) == set(made[name].cell_data)
        for key, values in made[name].cell_data.items():
            np.testing.assert_array_equal(read[name].cell_data[key], values)
    with pytest.raises(InputError, match=r"step: there is no state of step 7 \(allowed: one of 3\)"):
        meshes_of(there, 7)


def test_no_states() -> None:
    with pytest.raises(InputError, match="has no states of steps"):
        Recorder(simulation(), None).finish("stopped").to_pyvista()


def test_skin_is_the_surface(result: Result, shot: Any) -> None:
    skin = skin_of(result.to_pyvista()["bodies"])
    faces = shot.tessellation.surface
    assert skin.n_cells == len(faces.polygons)
    assert skin.compute_cell_sizes()["Area"].sum() == pytest.approx(faces.area.sum(), rel=1e-6)
    np.testing.assert_array_equal(np.unique(skin.cell_data["body"]), np.unique(faces.body))


@needs_rendering
def test_view(result: Result) -> None:
    view = result_view(result, off_screen=True)
    try:
        words = [actor.GetInput() for actor in view.actors.values() if hasattr(actor, "GetInput")]
        words += [actor.GetText(2) for actor in view.actors.values() if hasattr(actor, "GetText")]
        assert "little beam: step 1, load 100 N, displacements x 200" in words
        # That is the round number with which the largest displacement is 4.5 % of the block's diagonal at most.
        motion = np.linalg.norm(result.to_pyvista()["bodies"].point_data["displacement"], axis=1).max()
        assert 200.0 * motion <= 0.045 * np.linalg.norm(SIZE) < 500.0 * motion
        assert "fine body" in words
        assert list(view.scalar_bars.keys()) == ["crack opening [µm]"]
    finally:
        view.close()


@needs_rendering
def test_show_needs_a_screen_or_a_picture(result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(pyvista_tools, "can_open_windows", lambda: False)
    with pytest.raises(InputError, match="no screen to open a window on"):
        result.show()
    with pytest.raises(InputError, match=r"written as \.png only"):
        result.show(output=tmp_path / "view.pdf")
    assert not list(tmp_path.iterdir())


@needs_rendering
@pytest.mark.slow
def test_a_picture(result: Result, tmp_path: Path) -> None:
    result.show(output=tmp_path / "view.png")
    with Image.open(tmp_path / "view.png") as picture:
        assert picture.size == pyvista_tools.WINDOW
