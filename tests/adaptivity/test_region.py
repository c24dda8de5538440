"""The refined region: distances, spacing, growth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fissura.adaptivity import RefinedRegion, region_from_case
from fissura.specimen import domain_from_case

BASE = RefinedRegion(l_f=1.0, l_c=4.0, r_f=2.0, ramp=6.0)
coordinates = st.floats(-10.0, 10.0)
points = st.tuples(coordinates, coordinates, coordinates)


def test_ball_around_a_centre():
    region = replace(BASE, centers=np.array([[1.0, 2.0, 3.0], [30.0, 0.0, 0.0]]))
    x = np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 3.0], [1.0, 7.0, 3.0], [30.0, 0.0, 4.0]])
    assert_allclose(region.distance(x), [-2.0, 0.0, 3.0, 2.0], atol=1e-14)
    assert_allclose(region.spacing(x), [0.0, 0.0, 1.0 + 3.0 * 0.5, 2.0])


def test_line():
    region = replace(BASE, lines=np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 5.0]]]))
    x = np.array([[3.0, 0.0, 2.0], [0.0, 1.0, 5.0], [0.0, 3.0, 9.0], [0.0, 0.0, -4.0]])
    assert_allclose(region.distance(x), [1.0, -1.0, 3.0, 2.0])


def test_ball_with_its_own_radius():
    region = replace(BASE, balls=np.array([[0.0, 0.0, 0.0]]), radii=np.array([5.0]))
    assert_allclose(region.distance(np.array([[0.0, 7.0, 0.0], [1.0, 0.0, 0.0]])), [2.0, -4.0])


def test_box():
    region = replace(BASE, lower=np.array([[0.0, 0.0, 0.0]]), upper=np.array([[1.0, 2.0, 3.0]]))
    x = np.array([[0.5, 1.0, 1.0], [1.0, 2.0, 3.0], [4.0, 6.0, 3.0], [0.5, 1.0, -2.0]])
    assert_allclose(region.distance(x), [0.0, 0.0, 5.0, 2.0])
    assert_allclose(region.spacing(x)[:2], 0.0)


def test_nearest_part_counts():
    region = replace(
        BASE,
        centers=np.array([[0.0, 0.0, 0.0]]),
        lines=np.array([[[10.0, 0.0, 0.0], [10.0, 9.0, 0.0]]]),
        balls=np.array([[20.0, 0.0, 0.0]]),
        radii=np.array([1.0]),
        lower=np.array([[30.0, -1.0, -1.0]]),
        upper=np.array([[31.0, 1.0, 1.0]]),
    )
    x = np.array([[1.0, 0.0, 0.0], [11.0, 5.0, 0.0], [20.5, 0.0, 0.0], [30.5, 0.0, 0.0], [36.0, 0.0, 0.0]])
    assert_allclose(region.distance(x), [-1.0, -1.0, -0.5, 0.0, 5.0])


@pytest.mark.parametrize("l_c", [4.0, 1.0], ids=["coarser", "equal"])
@pytest.mark.parametrize("ramp", [0.0, 6.0])
def test_everywhere(ramp, l_c):
    region = replace(BASE, everywhere=True, ramp=ramp, l_c=l_c)
    assert_array_equal(region.spacing(np.zeros((3, 3))), 0.0)


@pytest.mark.parametrize("ramp", [0.0, 6.0])
def test_nowhere(ramp):
    assert_array_equal(replace(BASE, ramp=ramp).spacing(np.zeros((3, 3))), 4.0)


def test_without_a_ramp():
    region = replace(BASE, ramp=0.0, centers=np.zeros((1, 3)))
    assert_array_equal(region.spacing(np.array([[2.0, 0, 0], [2.0 + 1e-9, 0, 0], [50.0, 0, 0]])), [0.0, 4.0, 4.0])


def test_ramp_is_linear():
    d = np.linspace(0.01, 12.0, 50)
    region = replace(BASE, centers=np.zeros((1, 3)))
    x = np.stack([2.0 + d, 0 * d, 0 * d], axis=1)
    assert_allclose(region.spacing(x), 1.0 + 3.0 * np.minimum(d / 6.0, 1.0))


@given(st.lists(points, max_size=4), points, st.lists(points, min_size=1, max_size=20))
def test_growth_only_refines(centers, another, places):
    x = np.array(places)
    region = BASE.grown(np.array(centers).reshape(-1, 3))
    larger = region.grown(np.array([another]))
    assert (larger.distance(x) <= region.distance(x)).all()
    assert (larger.spacing(x) <= region.spacing(x)).all()
    assert (larger.spacing(np.array([another])) == 0.0).all()


@given(st.lists(points, max_size=5), st.randoms(use_true_random=False))
def test_order_of_growth_does_not_matter(centers, random):
    one = BASE.grown(np.array(centers).reshape(-1, 3))
    shuffled = [*centers, *centers]
    random.shuffle(shuffled)
    other = BASE
    for center in shuffled:
        other = other.grown(np.array([center]))
    assert_array_equal(one.centers, other.centers)
    assert len(BASE.centers) == 0


def test_region_of_a_case(small_case):
    regions = [
        {"type": "ball", "center": [0.02, 0.03, 0.02], "radius": 0.01},
        {"type": "box", "lower": [0.1, 0.0, 0.0], "upper": [0.12, 0.06, 0.04]},
    ]
    case = small_case(adaptivity__regions=regions, adaptivity__r_c=0.05, notch__width=0.004)
    region = region_from_case(case, domain_from_case(case), full=False)
    assert (region.l_f, region.l_c, region.r_f) == (0.008, 0.032, 0.016)
    assert region.ramp == pytest.approx(0.034)
    assert_allclose(region.lines[:, :, 0], [[0.058, 0.058], [0.062, 0.062]])
    x = np.array([[0.058, 0.03, 0.01], [0.02, 0.03, 0.02], [0.11, 0.01, 0.01], [0.06, 0.048, 0.0]])
    assert (region.spacing(x[:3]) == 0.0).all()
    assert region.spacing(x)[3] > 0.0


def test_region_of_a_full_run(small_case):
    case = small_case(adaptivity__notch_tips=False)
    domain = domain_from_case(case)
    x = np.random.default_rng(0).uniform(0.0, 1.0, (20, 3)) * domain.size
    assert_array_equal(region_from_case(case, domain, full=True).spacing(x), 0.0)
    assert_array_equal(region_from_case(case, domain, full=False).spacing(x), 0.032)
