"""Functionals attached to bodies: exact for rigid motions on every discretization (theory section 6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose, assert_array_equal

from fissura.adaptivity import region_from_case
from fissura.equilibrium.attach import attach, owners
from fissura.specimen import conditions_from_case, specimen_from_case
from fissura.tessellation import discretize, nuclei_from_case

from .motion import rigid, value, vectors


@pytest.fixture(scope="module", params=["coarse", "graded", "fine"])
def structure(request, small_case):
    case = small_case(load__width=0.02)
    box = specimen_from_case(case)
    nuclei = nuclei_from_case(case, box)
    region = region_from_case(case, box, full=request.param == "fine")
    if request.param == "coarse":
        region = replace(region, r_f=0.004)
    return discretize(nuclei, box, region.spacing(nuclei.x)), conditions_from_case(case, box)


@given(vectors, vectors)
def test_rigid_motions(structure, shift, turn):
    t, c = structure
    u = np.concatenate([rigid(t.x, shift, turn), np.tile(turn, (len(t), 1))], axis=1)
    for functional in (*c.supports, c.load, c.control):
        exact = value(functional, rigid(functional.points, shift, turn))
        assert_allclose(np.vdot(attach(functional, t), u), exact, atol=1e-12)


def test_forces_and_moments_balance(structure):
    """As a load it is the given force at the given place."""
    t, c = structure
    load = attach(c.load, t)
    assert_allclose(load[:, :3].sum(axis=0), [0.0, -1.0, 0.0], atol=1e-12)
    moment = (load[:, 3:] + np.cross(t.x, load[:, :3])).sum(axis=0)
    assert_allclose(moment, np.cross([0.06, 0.06, 0.02], [0.0, -1.0, 0.0]), atol=1e-12)


def test_owners_hold_the_points(structure):
    """The owner of a surface point has a facet there."""
    t, c = structure
    points = np.concatenate([c.load.points, c.control.points])
    body = owners(t, points)
    distance = np.linalg.norm(points[:, None] - t.x, axis=2)
    assert_allclose(distance[np.arange(len(points)), body], distance.min(axis=1), rtol=1e-12)
    top = t.surface.body[t.surface.surface == t.surface.names.index("top")]
    assert np.isin(owners(t, c.load.points), top).all()


def test_only_owners_take_part(structure):
    t, c = structure
    touched = np.flatnonzero(np.abs(attach(c.load, t)).sum(axis=1) > 0.0)
    assert_array_equal(touched, np.unique(owners(t, c.load.points)))
