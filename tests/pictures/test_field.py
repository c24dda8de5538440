"""The picture of the random field."""

import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from equilibrium.models import beam
from fissura.material.field import MARGINALS, marginal_named
from fissura.pictures.field import draw_marginal, plot_field
from fissura.simulation.loop import Simulation


@pytest.mark.parametrize("size", [(0.2, 0.02, 0.02), (0.02, 0.15, 0.04), (0.04, 0.04, 0.12)])
def test_any_shape_fits(size, tmp_path):
    """Panels never collapse, which matplotlib would warn of; weak and strong places show."""
    case = beam(
        specimen={"size": list(size)},
        notch=None,
        supports=[{"type": "clamp", "face": "bottom"}],
        load={"face": "top", "at": None},
        gauge=None,
        control={"type": "displacement"},
        field={"length": "20 mm", "marginal": "weibull"},
    )
    simulation = Simulation(case, full=True)
    plot_field(
        simulation.field, case.field, simulation.domain, simulation.tessellation, tmp_path / "field.png", "a name"
    )
    pixels = imread(tmp_path / "field.png")[:, :, :3]
    assert (pixels[:, :, 0] > pixels[:, :, 2] + 0.15).mean() > 0.02
    assert (pixels[:, :, 2] > pixels[:, :, 0] + 0.15).mean() > 0.02


@pytest.mark.parametrize("name", MARGINALS)
def test_paper_shows_every_distribution(name):
    axes = Figure().add_subplot()
    draw_marginal(axes, marginal_named(name, 0.25), name)
    curve = axes.lines[0].get_xydata()
    low, high = axes.get_ylim()
    assert curve[0, 1] <= low < high <= curve[-1, 1] + 0.4
    assert ("graft" in {text.get_text() for text in axes.texts}) == (name == "grafted")
