"""Coarsening: what is needed, when a region shrinks, and that nothing flickers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fissura.adaptivity import Coarsening, RefinedRegion, needed_contacts
from fissura.simulation import Simulation
from fissura.tessellation import discretize, nuclei_from_case
from fissura.specimen import specimen_from_case

ALPHA = 0.29


def history(damage, e_n, e_t):
    return np.array([[damage, e_n, e_t]])


@pytest.mark.parametrize(
    ("strain", "state", "used", "needed"),
    [
        ([0.1, 0, 0], history(1e-9, 1.0, 0.0), 0.0, True),  # damaged, however little, and unloaded
        ([0.1, 0, 0], history(0.0, 1.0, 0.0), 0.61, True),  # unloaded, but still highly stressed
        ([0.1, 0, 0], history(0.0, 1.0, 0.0), 0.59, False),
        ([1.0, 0, 0], history(0.0, 1.0, 0.0), 0.31, True),  # at its largest strain: it may come to be needed
        ([1.0, 0, 0], history(0.0, 1.0, 0.0), 0.29, False),
        ([-5.0, 0.1, 0], history(0.0, 0.0, 1.0), 0.59, False),  # compression is no strain of the history
        ([0, 0.6, 0.8], history(0.0, 0.0, 1.0), 0.31, True),
    ],
)
def test_needed_contacts(strain, state, used, needed):
    found = needed_contacts(np.array([strain], float), state, np.array([used]), ALPHA, 0.6)
    assert found.tolist() == [needed]


def test_a_coarsened_region_keeps_what_the_case_asks_for():
    region = RefinedRegion(
        1.0,
        4.0,
        r_f=6.0,
        ramp=8.0,
        centers=np.array([[50.0, 0, 0]]),
        lines=np.array([[[0.0, 0, 0], [0.0, 0, 9.0]]]),
        balls=np.array([[20.0, 0, 0]]),
        radii=np.array([2.0]),
        r_w=3.0,
    )
    small = region.coarsened(np.array([[35.0, 0, 0]]), np.array([[70.0, 0, 0]]))
    x = np.array([[0.0, 3, 4], [0.0, 3.1, 4], [21.9, 0, 0], [35, 3.0, 0], [35, 3.1, 0], [50.0, 0, 0], [70, 5.9, 0]])
    assert_array_equal(small.spacing(x) == 0.0, [True, False, True, True, False, False, True])


@pytest.fixture(scope="module")
def fine(small_case):
    """A beam, fine in a long box, its region, and all its nuclei."""
    case = small_case(notch=None)
    box = specimen_from_case(case)
    nuclei = nuclei_from_case(case, box)
    region = RefinedRegion(
        nuclei.spacing, 4 * nuclei.spacing, 2 * nuclei.spacing, 8 * nuclei.spacing, centers=nuclei.x, r_w=0.01
    )
    return discretize(nuclei, box, region.spacing(nuclei.x)), region, nuclei


def asked(fine, coarsening, chosen):
    tessellation, region, _ = fine
    active = np.flatnonzero(tessellation.contacts.fine)
    near = tessellation.contacts.centroid[active, 0] < chosen
    return coarsening.smaller(region, tessellation, active, near)


def test_it_waits_after_a_change_and_shrinks_only_where_that_saves_enough(fine):
    tessellation, _, nuclei = fine
    assert tessellation.fine.all()
    coarsening = Coarsening(nuclei.x)
    length = nuclei.x[:, 0].max()
    for _ in range(3):
        assert asked(fine, coarsening, 0.2 * length) is None
        coarsening = coarsening.stepped()
    small = asked(fine, coarsening, 0.2 * length)
    assert small is not None
    assert asked(fine, coarsening, 0.9 * length) is None
    assert asked(fine, coarsening.refined(nuclei.x[:1]), 0.2 * length) is None


def test_bodies_of_needed_contacts_stay_with_their_facets(fine):
    tessellation, _, nuclei = fine
    coarsening = replace(Coarsening(nuclei.x), rest=3)
    limit = 0.2 * nuclei.x[:, 0].max()
    small = asked(fine, coarsening, limit)
    assert small is not None
    bodies = np.unique(tessellation.contacts.bodies[tessellation.contacts.centroid[:, 0] < limit])
    assert (small.distance(tessellation.x[bodies]) <= -small.r_w + 1e-15).all()


def test_what_is_refined_again_stays(fine):
    _, region, nuclei = fine
    coarsening = replace(Coarsening(nuclei.x), rest=3)
    outside = np.array([[-1.0, -1.0, -1.0]])
    assert len(coarsening.refined(nuclei.x[:2]).lasting) == 0  # nothing was given up so far
    later = coarsening.coarsened(region).refined(np.concatenate([nuclei.x[:2], outside]))
    assert_array_equal(later.lasting, np.unique(nuclei.x[:2], axis=0))
    small = asked(fine, replace(later, rest=3), 0.2 * nuclei.x[:, 0].max())
    assert small is not None
    assert (small.distance(nuclei.x[:2]) <= -small.r_f).all()
