"""Identities that hold for every tessellation of a specimen, to round-off."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

from fissura.specimen import Box
from fissura.specimen.notch import FACES
from fissura.tessellation import Polygons, Tessellation
from fissura.tessellation.polygon import areas_and_centroids


def _owners(polygons: Polygons, body):
    """Body of every corner."""
    return np.repeat(body[polygons.facet], np.diff(polygons.offsets))


def check_volumes(t: Tessellation, box: Box) -> None:
    assert (t.volume > 0.0).all()
    assert_allclose(t.volume.sum(), box.volume, rtol=1e-9)


def check_closed(t: Tessellation) -> None:
    """Every body is closed, and its facets enclose its volume: sum A n = 0, sum A n (x) c = V I."""
    c, s = t.contacts, t.surface
    area = np.concatenate([c.area, c.area, s.area])
    normal = np.concatenate([c.normal, -c.normal, s.normal])
    body = np.concatenate([c.bodies[:, 0], c.bodies[:, 1], s.body])
    arm = np.concatenate([c.centroid, c.centroid, s.centroid]) - t.x[body]
    vector, moment, skin = np.zeros((len(t), 3)), np.zeros((len(t), 3, 3)), np.zeros(len(t))
    np.add.at(vector, body, area[:, None] * normal)
    np.add.at(moment, body, area[:, None, None] * normal[:, :, None] * arm[:, None, :])
    np.add.at(skin, body, area)
    assert_allclose(vector / skin[:, None], 0.0, atol=1e-9)
    assert_allclose(moment / t.volume[:, None, None], np.tile(np.eye(3), (len(t), 1, 1)), atol=1e-7)


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


def surface_areas(box: Box) -> np.ndarray:
    """Area of each named surface of a box whose notches do not meet."""
    size = np.asarray(box.size)
    area = np.array([np.prod(np.delete(size, axis)) for axis, _ in FACES.values()] + [0.0])
    for notch in box.notches:
        through = size[notch.through]
        area[2 * notch.axis + notch.side] -= notch.width * through
        area[2 * notch.through : 2 * notch.through + 2] -= notch.width * notch.depth
        area[-1] += (2.0 * notch.depth + notch.width) * through
    return area


def check_surface(t: Tessellation, box: Box) -> None:
    s = t.surface
    assert s.names == (*FACES, "notch")
    areas = np.bincount(s.surface, s.area, len(s.names))
    assert_allclose(areas, surface_areas(box), rtol=1e-9, atol=1e-9 * box.size[0] ** 2)
    for k, (axis, side) in enumerate(FACES.values()):
        on = s.surface == k
        assert_allclose(s.normal[on], np.tile((2.0 * side - 1.0) * np.eye(3)[axis], (on.sum(), 1)), atol=0)
        assert_allclose(s.centroid[on, axis], side * box.size[axis], atol=1e-15)
        assert len(np.unique(s.body[on])) == on.sum()  # one facet of each body on a face


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
        along = np.abs(np.einsum("ka,ka->k", normal, facets.normal[p.facet]))
        assert_allclose(along[large], 1.0, atol=1e-6)


def check_voronoi(t: Tessellation) -> None:
    """Facets lie midway between their nuclei, and no other nucleus is nearer to any of their corners."""
    tree = cKDTree(t.x)
    c, s = t.contacts, t.surface
    places = [
        (c.polygons.points, _owners(c.polygons, c.bodies[:, 0])),
        (c.polygons.points, _owners(c.polygons, c.bodies[:, 1])),
        (c.centroid, c.bodies[:, 0]),
        (c.centroid, c.bodies[:, 1]),
        (s.polygons.points, _owners(s.polygons, s.body)),
        (s.centroid, s.body),
    ]
    for points, body in places:
        nearest, _ = tree.query(points)
        assert_allclose(np.linalg.norm(points - t.x[body], axis=1), nearest, atol=1e-9)


def check_notches(t: Tessellation, box: Box) -> None:
    """No contact joins both sides below the root; above it the ligament is whole; the tip is where it should be."""
    c, s = t.contacts, t.surface
    tolerance = 1e-9 * max(box.size)
    corner_facet = np.repeat(c.polygons.facet, np.diff(c.polygons.offsets))
    for notch in box.notches:
        beyond = t.x[:, notch.normal] > notch.position
        crossing = beyond[c.bodies[:, 0]] != beyond[c.bodies[:, 1]]
        height = notch.height(c.polygons.points)
        assert height[crossing[corner_facet]].min() >= -tolerance
        sides = np.where(beyond[c.bodies[:, 1]], 1.0, -1.0)
        flux = (c.area * c.normal[:, notch.normal] * sides)[crossing].sum()
        cut = sum(n.depth for n in box.notches if (n.normal, n.position) == (notch.normal, notch.position))
        ligament = (box.size[notch.axis] - cut) * box.size[notch.through]
        # Coarse bodies may reach from their side of the plane to the end of the other one.
        astray = (s.surface == 2 * notch.normal) & beyond[s.body]
        astray |= (s.surface == 2 * notch.normal + 1) & ~beyond[s.body]
        assert_allclose(flux + s.area[astray].sum(), ligament, rtol=1e-9)
        # Facets in the mid-plane begin exactly at the tip.
        middle = np.abs(c.polygons.points[:, notch.normal] - notch.position) < tolerance
        if notch.width == 0.0:
            assert_allclose(height[middle & crossing[corner_facet]].min(), 0.0, atol=tolerance)
        # Nothing is left inside a saw cut, walls face it.
        for polygons in (c.polygons, s.polygons):
            depth = np.minimum(
                0.5 * notch.width - np.abs(polygons.points[:, notch.normal] - notch.position),
                -notch.height(polygons.points),
            )
            assert depth.max(initial=0.0) <= tolerance
    walls = s.surface == len(s.names) - 1
    assert walls.any() == bool(box.notches)
    outside = s.centroid[walls] + 1e-7 * s.normal[walls]
    inside = s.centroid[walls] - 1e-7 * s.normal[walls]
    assert box.contains(inside).all()
    open_cut = np.zeros(len(outside), bool)
    for notch in box.notches:
        open_cut |= notch.in_void(outside)
        if notch.width == 0.0:
            middle = np.abs(s.centroid[walls, notch.normal] - notch.position) < tolerance
            open_cut |= middle & (notch.height(s.centroid[walls]) < tolerance)
    assert open_cut.all()


def check_all(t: Tessellation, box: Box) -> None:
    check_volumes(t, box)
    check_closed(t)
    check_contacts(t)
    check_surface(t, box)
    check_polygons(t)
    check_voronoi(t)
    check_notches(t, box)
