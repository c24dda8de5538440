import matplotlib.image
import numpy as np
import pytest

from fissura.pictures.crack import FINE, HEAT, plot_crack
from fissura.running.recorder import Recorder
from results.synthetic import random_points, simulation, snapshot, step, voronoi_structure


def drawn(path, size, opened):
    """Picture of a box whose contacts at half its length have opened; pixels (h, w, 3)."""
    t = voronoi_structure(random_points(150, size, spacing=0.06 * size[0]), size)
    near = np.abs(t.contacts.centroid[:, 0] - size[0] / 2) < 0.1 * size[0]
    depth = 1 - t.contacts.centroid[:, 1] / size[1]
    shot = snapshot(t, opening=np.where(near & opened, 50e-6 * depth, 0.0))
    recorder = Recorder(simulation(), None)
    recorder.add(step(1, 1e-5, 100.0, shot))
    plot_crack(recorder.finish("finished"), path)
    return matplotlib.image.imread(path)[..., :3]


def covers(pixels, colour):
    return np.mean(np.abs(pixels - colour).max(axis=-1) < 0.02)


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    size = np.array([0.2, 0.05, 0.05])
    folder = tmp_path_factory.mktemp("crack")
    return [drawn(folder / f"{opened}.png", size, opened) for opened in (False, True)]


def test_bodies_on_the_front_are_drawn(beam):
    fine = [int(FINE[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    assert covers(beam[0], fine) > 0.25


def test_openings_are_drawn_only_where_there_are_some(beam):
    strong = [np.array(HEAT(share)[:3]) for share in (0.5, 0.6, 0.7, 0.8)]
    assert sum(covers(beam[0], colour) for colour in strong) == 0
    assert sum(covers(beam[1], colour) for colour in strong) > 1e-3


def test_cracks_add_the_zoomed_panel(beam):
    assert beam[1].shape[1] == beam[0].shape[1]
    assert beam[1].shape[0] > 1.8 * beam[0].shape[0]


@pytest.mark.parametrize("size", [(0.05, 0.05, 0.05), (0.03, 0.1, 0.03)])
def test_compact_specimens_have_their_panels_side_by_side(tmp_path, size):
    pixels = drawn(tmp_path / "crack.png", np.array(size), True)
    assert pixels.shape[1] > pixels.shape[0]
