"""Identities that hold for every tessellation of a specimen, to round-off."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from fissura.specimen import Domain
from fissura.specimen.shapes.prism import FACES
from fissura.tessellation import Tessellation, owners
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.tessellation import LEDGE


def _facets(t: Tessellation) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Body, area vector and centroid of all facets, those of contacts from either side."""
    c, s = t.contacts, t.surface
    inner, outer = c.area[:, None] * c.normal, s.area[:, None] * s.normal
    return (
        np.concatenate([c.bodies[:, 0], c.bodies[:, 1], s.body]),
        np.concatenate([inner, -inner, outer]),
        np.concatenate([c.centroid, c.centroid, s.centroid]),
    )


def check_volumes(t: Tessellation, domain: Domain, rtol: float = 1e-10) -> None:
    assert (t.volume > 0.0).all()
    assert_allclose(t.volume.sum(), domain.volume, rtol=rtol)


def check_closed(t: Tessellation, l: float) -> None:  # noqa: E741
    """Every body is closed, and its facets enclose its volume: sum A n = 0, sum A n (x) c = V I."""
    body, vector, centroid = _facets(t)
    total, moment = np.zeros((len(t), 3)), np.zeros((len(t), 3, 3))
    np.add.at(total, body, vector)
    np.add.at(moment, body, vector[:, :, None] * (centroid - t.x[body])[:, None, :])
    assert_allclose(total / l**2, 0.0, atol=1e-9)
    assert_allclose(moment / t.volume[:, None, None], np.tile(np.eye(3), (len(t), 1, 1)), atol=1e-7)


def check_patch(t: Tessellation, l: float) -> None:  # noqa: E741
    """Affine displacements are in equilibrium with the tractions of their uniform stress, for alpha = 1."""
    strain = np.array([[0.3, 0.5, -0.7], [0.5, -1.0, 0.2], [-0.7, 0.2, 0.6]])
    c, s = t.contacts, t.surface
    i, j = c.bodies.T
    force = c.area[:, None] * ((t.x[j] - t.x[i]) @ strain) / c.length[:, None]
    outside = s.area[:, None] * (s.normal @ strain)
    total, moment = np.zeros((len(t), 3)), np.zeros((len(t), 3))
    for body, f, place in ((i, force, c.centroid), (j, -force, c.centroid), (s.body, outside, s.centroid)):
        np.add.at(total, body, f)
        np.add.at(moment, body, np.cross(place - t.x[body], f))
    assert_allclose(total / l**2, 0.0, atol=1e-9)
    assert_allclose(moment / l**3, 0.0, atol=1e-9)


def check_contacts(t: Tessellation) -> None:
    """No facet doubled, ``i < j``, normals and lengths those of the line between the nuclei."""
    c = t.contacts
    assert (c.bodies[:, 0] < c.bodies[:, 1]).all()
    assert len(np.unique(c.bodies, axis=0)) == len(c)
    assert (c.area > 0.0).all()
    line = t.x[c.bodies[:, 1]] - t.x[c.bodies[:, 0]]
    assert_allclose(c.normal * c.length[:, None], line, atol=1e-15)
    assert_allclose(np.linalg.norm(c.normal, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_array_equal(c.fine, t.fine[c.bodies].all(axis=1))


def check_surface(t: Tessellation, domain: Domain) -> None:
    """Named surfaces have their areas, and one facet for each body and plane; ledges face both ways."""
    s = t.surface
    assert s.names[: len(domain.surfaces)] == domain.surfaces
    assert s.names[len(domain.surfaces) :] in ((), (LEDGE,))
    parts = [domain.faces(name) for name in domain.surfaces]
    scale = domain.complex.extent**2
    for k, named in enumerate(parts):
        mine = s.surface == k
        assert_allclose(s.area[mine].sum(), sum(part.area for part in named), rtol=1e-9, atol=1e-9 * scale)
        vector = (s.area[mine, None] * s.normal[mine]).sum(axis=0)
        assert_allclose(vector, sum(part.area * part.normal for part in named), atol=1e-9 * scale)
    ledge = s.surface == len(domain.surfaces)
    assert_allclose((s.area[ledge, None] * s.normal[ledge]).sum(axis=0), 0.0, atol=1e-9 * scale)
    assert not ledge.any() or domain.notches


def check_polygons(t: Tessellation) -> None:
    """Corners describe the very facets whose area, centroid and normal are given."""
    for facets in (t.contacts, t.surface):
        p = facets.polygons
        assert (np.diff(p.facet) >= 0).all()
        assert (np.diff(p.offsets) >= 3).all()
        vector, centroid = areas_and_centroids(p.points, p.offsets)
        size = np.linalg.norm(vector, axis=1)
        area = np.bincount(p.facet, size, len(facets))
        assert_allclose(area, facets.area, rtol=1e-9)
        mean = np.stack([np.bincount(p.facet, size * centroid[:, a], len(facets)) for a in range(3)], axis=1)
        assert_allclose(mean / area[:, None], facets.centroid, atol=1e-12)
        normal = vector / size[:, None]
        large = size > 1e-6 * size.max(initial=0.0)
        along = np.einsum("ka,ka->k", normal, facets.normal[p.facet])
        assert_allclose(along[large], 1.0, atol=1e-6)


def check_owners(t: Tessellation, domain: Domain, l: float) -> None:  # noqa: E741
    """Behind every facet lies the body that it belongs to, found point by point, and before it the other one."""
    c, s = t.contacts, t.surface
    for facets, behind, before in ((c, c.bodies[:, 0], c.bodies[:, 1]), (s, s.body, None)):
        p = facets.polygons
        vector, centroid = areas_and_centroids(p.points, p.offsets)
        rows = np.flatnonzero(np.linalg.norm(vector, axis=1) > 1e-4 * l**2)
        facet = p.facet[rows]
        step = 1e-6 * l * facets.normal[facet]
        for place, body in ((centroid[rows] - step, behind), (centroid[rows] + step, before)):
            if body is None:
                continue
            cell = domain.cell_of(place)
            assert (cell >= 0).all()
            np.testing.assert_array_equal(owners(t, place, cell), body[facet])


def check_notch(t: Tessellation, domain: Domain) -> None:
    """Of a box with one straight notch: behind its tip nothing crosses it and no body reaches around it.

    The ligament is whole, and the notch is straight.
    """
    c, s, (notch,) = t.contacts, t.surface, domain.notches
    tolerance = 1e-9 * domain.complex.extent
    beyond = notch.across(t.x) > 0.0
    crossing = beyond[c.bodies[:, 0]] != beyond[c.bodies[:, 1]]
    for facets, bodies in ((c, c.bodies), (s, s.body[:, None])):
        points = facets.polygons.points
        facet = np.repeat(facets.polygons.facet, np.diff(facets.polygons.offsets))
        behind = notch.ahead(points) < -tolerance
        side = np.where(beyond[bodies[facet]], 1.0, -1.0) * notch.across(points)[:, None]
        assert side[behind].min(initial=0.0) >= -tolerance
        if facets is c:
            assert not crossing[facet[behind]].any()
    sign = np.where(beyond[c.bodies[:, 1]], 1.0, -1.0)
    flux = (c.area * (c.normal @ notch.normal) * sign)[crossing].sum()
    # Coarse bodies may reach from their side of the plane to the end of the other one.
    across = s.normal @ notch.normal
    astray = (np.abs(across) > 0.5) & (s.surface < len(FACES)) & (beyond[s.body] != (across > 0.0))
    size = domain.size
    axis, through = (
        np.abs(notch.direction).argmax(),
        3 - np.abs(notch.normal).argmax() - np.abs(notch.direction).argmax(),
    )
    assert_allclose(flux + s.area[astray].sum(), (size[axis] - notch.depth) * size[through], rtol=1e-9)
    # Walls are where the notch is, and all of them.
    walls = s.surface == domain.surfaces.index("notch")
    upright = walls & (np.abs(across) > 0.5)
    assert_allclose(np.abs(notch.across(s.centroid[upright])), 0.5 * notch.width, atol=tolerance)
    for side in (True, False):
        mine = upright & (beyond[s.body] == side)
        assert_allclose(s.area[mine].sum(), notch.depth * size[through], rtol=1e-9)
        assert ((across[mine] < 0.0) == side).all()
    # Ledges lie at the level of the tip.
    ledge = s.surface == len(domain.surfaces)
    assert_allclose(notch.ahead(s.centroid[ledge]), 0.0, atol=tolerance)


def check_all(t: Tessellation, domain: Domain, l: float, rtol: float = 1e-10) -> None:  # noqa: E741
    check_volumes(t, domain, rtol)
    check_closed(t, l)
    check_patch(t, l)
    check_contacts(t)
    check_surface(t, domain)
    check_polygons(t)
    check_owners(t, domain, l)
