import numpy as np
import pytest

from fissura.pictures.front import rims, seen
from fissura.simulation.loop import Simulation
from fissura.tessellation.tessellation import Polygons
from results.synthetic import stack


def rectangles(*corners):
    """Polygons in the plane z = 0 from lower and upper corners; they face against z."""
    points = [[[x0, y0, 0.0], [x0, y1, 0.0], [x1, y1, 0.0], [x1, y0, 0.0]] for x0, y0, x1, y1 in corners]
    return Polygons(np.concatenate(points), np.arange(0, 4 * len(corners) + 1, 4), np.arange(len(corners)))


def lengths(lines):
    return np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)


def test_no_lines_between_pieces_of_one_body():
    """One below two half as wide: sides of different lengths lie on each other."""
    shapes = rectangles((0, 0, 2, 1), (0, 1, 1, 2), (1, 1, 2, 2), (2, 0, 3, 2))
    found = rims(shapes, np.arange(4), np.array([0, 0, 0, 1]))
    assert lengths(found).sum() == pytest.approx(8.0 + 6.0)
    inside = (
        (found[:, :, 0] > 0.0).all(axis=1) & (found[:, :, 0] < 2.0).all(axis=1) & (np.ptp(found[:, :, 1], axis=1) > 0)
    )
    assert not inside.any()
    assert not (found[:, :, 1] == 1.0).all(axis=1).any()
    assert lengths(rims(shapes, np.arange(4), np.array([0, 1, 2, 3]))).sum() == pytest.approx(6.0 + 4.0 + 4.0 + 6.0)


def test_a_side_is_covered_in_part():
    shapes = rectangles((0, 0, 3, 1), (1, 1, 2, 2))
    found = rims(shapes, np.arange(2), np.array([0, 0]))
    assert lengths(found).sum() == pytest.approx(8.0 + 4.0 - 2.0)
    upper = found[(found[:, :, 1] == 1.0).all(axis=1)]
    assert sorted(np.sort(upper[:, :, 0], axis=1).tolist()) == [[0.0, 1.0], [2.0, 3.0]]


def test_a_box_shows_its_front():
    surface = stack().surface
    chosen = seen(surface)
    assert (surface.surface[surface.polygons.facet[chosen]] == surface.names.index("front")).all()
    assert len(chosen) == 2
    assert len(rims(surface.polygons, chosen, surface.body[surface.polygons.facet[chosen]])) == 8


def test_nothing_is_seen_of_nothing():
    assert rims(Polygons.none(), np.empty(0, np.int64), np.empty(0, np.int64)).shape == (0, 2, 3)


@pytest.fixture(scope="module", params=[0.0, 0.004], ids=["ideal cut", "saw cut"])
def notched(request, small_case):
    notch = {"face": "bottom", "position": 0.06, "depth": 0.03, "width": request.param}
    return request.param, Simulation(small_case(notch=notch)).tessellation


def test_all_bodies_together_have_the_outline_of_the_specimen(notched):
    """Of an ideal cut both walls lie on each other."""
    width, tessellation = notched
    shapes = tessellation.surface.polygons
    found = rims(shapes, seen(tessellation.surface), np.zeros(len(seen(tessellation.surface)), np.int64))
    assert lengths(found).sum() == pytest.approx(2 * (0.12 + 0.06) + (2 * 0.03 if width else 0.0), rel=1e-6)


def test_bodies_have_no_line_at_the_level_of_a_notch_but_for_ledges(notched):
    _, tessellation = notched
    surface = tessellation.surface
    shapes, facet = surface.polygons, surface.polygons.facet
    lines = rims(shapes, seen(surface), surface.body[facet[seen(surface)]])
    level = lines[(np.abs(lines[:, :, 1] - 0.03) < 1e-9).all(axis=1)]
    ledges = shapes.points[np.repeat(surface.ledges[facet], np.diff(shapes.offsets))]
    assert len(ledges)
    low, high = ledges[:, 0].min(), ledges[:, 0].max()
    assert ((level[:, :, 0] > low - 1e-9) & (level[:, :, 0] < high + 1e-9)).all()
    assert high - low < 0.03  # far less than the specimen's length
