import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.results.section import ON_LEDGE, cut, outlines
from fissura.simulation.loop import Simulation

from .synthetic import random_points, stack, voronoi_structure

SIZE = np.array([0.08, 0.05, 0.03])


@pytest.fixture(scope="module")
def block():
    return voronoi_structure(random_points(200, SIZE, spacing=0.006), SIZE)


def areas(section):
    shapes = outlines(section)
    parts = [shapes.points[a:b] for a, b in zip(shapes.offsets[:-1], shapes.offsets[1:], strict=True)]
    return np.array([0.5 * abs(np.sum(p[:, 0] * np.roll(p[:, 1], -1) - np.roll(p[:, 0], -1) * p[:, 1])) for p in parts])


def test_two_cubes():
    section, rows = cut(stack(), 0.003)
    assert rows.contacts.tolist() == [0]
    assert section.contacts == 1
    assert sorted(section.lines[0, :, 1].tolist()) == pytest.approx([0.0, 0.01])
    assert section.lines[0, :, 0].tolist() == pytest.approx([0.01, 0.01])
    assert areas(section) == pytest.approx([1e-4, 1e-4])


@given(share=st.floats(0.001, 0.999))
def test_outlines_fill_the_section(block, share):
    section, _ = cut(block, share * SIZE[2])
    assert areas(section).sum() == pytest.approx(SIZE[0] * SIZE[1], rel=1e-5)


@given(share=st.floats(0.001, 0.999))
def test_a_point_of_an_outline_is_nearest_to_its_own_nucleus(block, share):
    z = share * SIZE[2]
    section, rows = cut(block, z)
    shapes = outlines(section)
    for k, body in enumerate(rows.bodies):
        middle = np.append(shapes.points[shapes.offsets[k] : shapes.offsets[k + 1]].mean(axis=0), z)
        assert np.linalg.norm(block.x - middle, axis=1).argmin() == body


def test_lines_lie_between_their_two_bodies(block):
    section, rows = cut(block, 0.5 * SIZE[2])
    assert (section.sides[: section.contacts] >= 0).all()
    assert (section.sides[section.contacts :, 1] == -1).all()
    pairs = rows.bodies[section.sides[: section.contacts]]
    assert np.array_equal(pairs, block.contacts.bodies[rows.contacts])
    middle = np.append(section.lines[: section.contacts].mean(axis=1), np.full((len(pairs), 1), 0.5 * SIZE[2]), axis=1)
    far = [np.linalg.norm(middle - block.x[pairs[:, side]], axis=1) for side in (0, 1)]
    assert far[0] == pytest.approx(far[1], rel=1e-4)


@pytest.mark.parametrize("width", [0.0, 0.004])
def test_notches_are_left_out(small_case, width):
    notch = {"face": "bottom", "position": 0.06, "depth": 0.03, "width": width}
    tessellation = Simulation(small_case(notch=notch)).tessellation
    section, _ = cut(tessellation, 0.02)
    assert areas(section).sum() == pytest.approx(0.12 * 0.06 - 0.03 * width, rel=1e-5)
    skin = section.lines[section.skin]
    outline = 2 * (0.12 + 0.06 + 0.03)  # ledges at the tip are no part of it
    assert np.linalg.norm(skin[:, 1] - skin[:, 0], axis=1).sum() == pytest.approx(outline, rel=1e-5)
    assert width or (section.sides[:, 1] == ON_LEDGE).any()
    walls = section.lines[section.contacts :]
    inside = np.abs(walls[:, :, 0] - 0.06).max(axis=1) < 0.5 * width + 1e-6
    low = walls[inside][:, :, 1].max(axis=1) < 0.03 + 1e-6
    assert np.ptp(walls[inside][low], axis=1)[:, 1].sum() == pytest.approx(0.06, rel=1e-5)  # both walls
