"""Regions: points inside, overlap with the specimen, messages for a case whose regions make no sense."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fissura.case import BallRegion, BoxRegion
from fissura.errors import InputError
from fissura.material import Regions, check_not_everywhere, elastic_from_case

BALL = BallRegion(type="ball", center=(0.0, 0.0, 0.0), radius=1.0)
BOX = BoxRegion(type="box", lower=(2.0, 0.0, 0.0), upper=(3.0, 4.0, 5.0))


#: Corners of a cube.
UNIT = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])


def test_distance_from_a_ball_and_a_box():
    x = np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 2.0], [2.5, 1.0, 1.0], [3.0, 4.0, 5.0], [6.0, 8.0, 5.0]])
    assert_allclose(Regions.from_parts([BALL, BOX]).distance(x), [-0.5, 1.0, 0.0, 0.0, 5.0])
    assert_array_equal(Regions.from_parts([BALL, BOX]).contains(x), [True, False, True, True, False])
    assert_array_equal(Regions.from_parts([BOX]).contains(x), [False, False, True, True, False])


def test_no_region_contains_nothing():
    assert len(Regions()) == 0
    assert not Regions().contains(np.zeros((4, 3))).any()
    assert (Regions().distance(np.zeros((2, 3))) == np.inf).all()
    assert not Regions().overlaps(UNIT)


coordinate = st.floats(-2.0, 3.0)


@given(st.tuples(coordinate, coordinate, coordinate), st.floats(0.05, 2.0))
def test_overlap_as_seen_by_a_grid_of_points(corner, size):
    """Points of the specimen that a region contains prove that it overlaps."""
    grid = np.stack(np.meshgrid(*[np.linspace(0.01, 0.99, 12)] * 3), axis=-1).reshape(-1, 3)
    low = np.array(corner)
    box = Regions(lower=low[None], upper=low[None] + size)
    ball = Regions(balls=low[None], radii=np.array([size]))
    for region in (box, ball):
        if region.contains(grid).any():
            assert region.overlaps(UNIT)
    nearest = np.clip(low, 0.0, 1.0)
    assert ball.overlaps(UNIT) == bool(np.linalg.norm(low - nearest) < size)
    assert box.overlaps(UNIT) == bool(((low < 1.0) & (low + size > 0.0)).all())


INSIDE = {"type": "box", "lower": [0, 0, 0], "upper": [0.02, 0.06, 0.04]}
BESIDE = {"type": "box", "lower": [0.12, 0, 0], "upper": [0.14, 0.06, 0.04]}  # touches the specimen
BELOW = {"type": "ball", "center": [0.05, -0.03, 0.02], "radius": 0.02}


@pytest.mark.parametrize(
    ("elastic", "key"),
    [
        ([BESIDE], "material.elastic"),
        (BELOW, "material.elastic"),
        ([INSIDE, BESIDE], "material.elastic[1]"),
        ([BELOW, INSIDE], "material.elastic[0]"),
    ],
)
def test_a_region_outside_the_specimen(small_case, elastic, key):
    with pytest.raises(InputError, match="outside the specimen") as caught:
        elastic_from_case(small_case(material__elastic=elastic))
    assert caught.value.key == key


def test_regions_of_a_case(small_case):
    reaching = {"type": "ball", "center": [0.05, -0.01, 0.02], "radius": 0.02}  # its centre is outside
    assert len(elastic_from_case(small_case())) == 0
    regions = elastic_from_case(small_case(material__elastic=[INSIDE, reaching]))
    x = np.array([[0.01, 0.03, 0.02], [0.05, 0.005, 0.02], [0.09, 0.03, 0.02]])
    assert_array_equal(regions.contains(x), [True, True, False])


def test_nothing_is_left_to_crack():
    x = np.random.default_rng(0).uniform(0.0, [3.0, 1.0, 1.0], (50, 3))
    left = Regions(lower=np.array([[0.0, 0.0, 0.0]]), upper=np.array([[1.5, 1.0, 1.0]]))
    check_not_everywhere(left, x)
    check_not_everywhere(Regions(), x)
    both = Regions(lower=np.array([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0]]), upper=np.array([[1.5, 1.0, 1.0], [3.0, 1, 1]]))
    with pytest.raises(InputError, match="whole specimen") as caught:
        check_not_everywhere(both, x)
    assert caught.value.key == "material.elastic"
