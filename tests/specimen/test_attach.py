"""Functionals attached to bodies: exact for rigid motions on every discretization (theory section 6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose, assert_array_equal

from equilibrium.models import nearest_admitted
from fissura.adaptivity import region_from_case
from fissura.equilibrium.attach import attach, owners_of
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case

from .motion import rigid, value, vectors


@pytest.fixture(scope="module", params=["coarse", "graded", "fine"])
def structure(request, small_case):
    case = small_case(load__width=0.02)
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    region = region_from_case(case, domain, full=request.param == "fine")
    if request.param == "coarse":
        region = replace(region, r_f=0.004)
    return discretize(nuclei, domain, region.spacing(nuclei.x)), conditions_from_case(case, domain), domain


@given(vectors, vectors)
def test_rigid_motions(structure, shift, turn):
    t, c, _ = structure
    u = np.concatenate([rigid(t.x, shift, turn), np.tile(turn, (len(t), 1))], axis=1)
    for functional in (*c.supports, *c.loads, *c.gauges):
        exact = value(functional, rigid(functional.points, shift, turn))
        assert_allclose(np.vdot(attach(functional, t), u), exact, atol=1e-12)


def test_forces_and_moments_balance(structure):
    """As a load it is the given force at the given place."""
    t, c, _ = structure
    load = attach(c.loads[0], t)
    assert_allclose(load[:, :3].sum(axis=0), [0.0, -1.0, 0.0], atol=1e-12)
    moment = (load[:, 3:] + np.cross(t.x, load[:, :3])).sum(axis=0)
    assert_allclose(moment, np.cross([0.06, 0.06, 0.02], [0.0, -1.0, 0.0]), atol=1e-12)


def test_owners_hold_the_points(structure):
    """The owner of a surface point has a facet there, and lies on its side of the notch."""
    t, c, domain = structure
    functionals = (*c.loads, *c.gauges, *c.supports)
    points, cells = (np.concatenate([getattr(f, name) for f in functionals]) for name in ("points", "cells"))
    body = owners_of(functionals, t)
    assert_array_equal(body, nearest_admitted(domain, t.x, points, cells))
    assert all(on_surface(t.surface, *pair) for pair in zip(body, points, strict=True))
    top = t.surface.body[t.surface.surface == t.surface.names.index("top")]
    assert np.isin(owners_of(c.loads, t), top).all()


def on_surface(surface, body, point):
    """Whether a point lies in a polygon of a body on the surface."""
    shapes = surface.polygons
    for q in np.flatnonzero(surface.body[shapes.facet] == body):
        corners = shapes.points[shapes.offsets[q] : shapes.offsets[q + 1]] - point
        normal = surface.normal[shapes.facet[q]]
        inward = np.cross(np.roll(corners, -1, axis=0) - corners, -corners) @ normal
        if np.abs(corners @ normal).max() < 1e-12 and (inward > -1e-12).all():
            return True
    return False


def test_only_owners_take_part(structure):
    t, c, _ = structure
    touched = np.flatnonzero(np.abs(attach(c.loads[0], t)).sum(axis=1) > 0.0)
    assert_array_equal(touched, np.unique(owners_of(c.loads, t)))
