"""The specimen of a case, drawn before it is run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from typer.testing import CliRunner

from fissura.cli import app
from fissura.pictures import specimen as specimen_picture
from fissura.pictures.lettering import fit
from fissura.pictures.specimen import Sight, plot_specimen
from fissura.simulation.loop import Simulation


def test_axes_of_a_sight_are_a_right_handed_frame() -> None:
    for azimuth, elevation in ((0.0, 0.0), (30.0, 25.0), (-120.0, -80.0)):
        axes = Sight(azimuth, elevation).axes
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-15)
        assert np.linalg.det(axes) == pytest.approx(1.0)
    assert Sight(0.0, 0.0).axes == pytest.approx(np.eye(3))  # along z: x to the right, y up
    assert Sight(90.0, 0.0).axes[2] == pytest.approx([1.0, 0.0, 0.0])


def drawn(monkeypatch, small_case, sight: Sight, **changes) -> tuple[Simulation, Figure]:
    kept: list[Figure] = []
    monkeypatch.setattr(specimen_picture, "save", lambda figure, path, dpi: kept.append(figure))
    simulation = Simulation(small_case(**changes))
    plot_specimen(simulation, "any.png", sight)
    return simulation, kept[0]


@pytest.mark.parametrize("sight", [Sight(), Sight(0.0, 0.0), Sight(-150.0, -40.0)])
def test_what_is_seen_of_a_box_is_its_shadow(monkeypatch, small_case, sight: Sight) -> None:
    """Facets in view cover the shadow of a convex specimen once: together they have its area."""
    simulation, figure = drawn(monkeypatch, small_case, sight, notch=[])
    shadow = 1e6 * sum(part.area * max(part.normal @ sight.axes[2], 0.0) for part in simulation.domain.faces())
    corners = [path.vertices for path in figure.axes[0].collections[0].get_paths()]
    areas = [abs(np.sum(p[:-1, 0] * p[1:, 1] - p[1:, 0] * p[:-1, 1])) / 2.0 for p in corners]
    assert sum(areas) == pytest.approx(shadow, rel=1e-9)


def test_every_surface_and_condition_is_named(monkeypatch, small_case) -> None:
    simulation, figure = drawn(monkeypatch, small_case, Sight())
    words = " ".join(text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text")))
    for name in simulation.domain.surfaces:
        assert name in words
    for part in simulation.case.supports:
        assert f"support, {part.type}" in words
    assert "load" in words
    assert ("gauge, from a to b" in words) == (simulation.case.gauge is not None)


def test_named_loads_platens_and_gravity_are_in_the_legend(monkeypatch, small_case) -> None:
    loads = {
        "left": {"face": "top", "at": 0.04, "width": 0.01, "platen": "glued"},
        "right": {"face": "bottom", "at": 0.08, "width": 0.01, "platen": "frictionless"},
    }
    stage = [{"load": {"left": 0.5, "right": 0.5}, "to": "0.1 mm"}]
    changes = {"loads": loads, "gravity": {"density": 2400.0}, "stage": stage, "load": None, "control": None}
    _, figure = drawn(monkeypatch, small_case, Sight(), **changes)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"load left", "load right", "platen, glued", "platen, frictionless", "gravity"} <= set(words)
    assert "load" not in words
    assert len(words) == len(set(words))
    # What faces the eye lies before the specimen, what does not behind it.
    assert sorted(artist.get_zorder() for artist in figure.axes[0].collections[:3]) == [0.5, 1, 1.5]


@pytest.mark.parametrize("direction", [[0, -1, 0], [0, 0, -1]])
def test_gravity_is_drawn_in_any_direction(monkeypatch, small_case, direction) -> None:
    """Along the line of sight, too, where an arrow has no length."""
    _, figure = drawn(monkeypatch, small_case, Sight(0.0, 0.0), gravity={"density": 2400.0, "direction": direction})
    assert "gravity" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_long_name_stays_inside(monkeypatch, small_case) -> None:
    _, figure = drawn(monkeypatch, small_case, Sight(), name="long name " * 9 + "end")
    fit(figure)
    title = figure._suptitle
    box = title.get_window_extent()
    assert title.get_text().startswith("long name")
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1


def test_command(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    Path("beam.toml").write_text(runner.invoke(app, ["new", "beam"]).stdout)
    found = runner.invoke(app, ["show", "beam.toml", "--azimuth", "-20", "--elevation", "-25"])
    assert (found.exit_code, found.stdout) == (0, "picture: beam_specimen.png\n")
    with Image.open("beam_specimen.png") as picture:
        assert min(picture.size) > 500
    wrong = runner.invoke(app, ["show", "beam.toml", "--output", "beam.stl"])
    assert wrong.exit_code == 2
    assert "--output" in wrong.stderr
