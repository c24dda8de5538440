"""Exact identities that every complex must have, whatever it was built from."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from fissura.specimen.convex import area_vector, clipped, loops_of


def polygons(cx):
    """Faces of each cell, in the order of its planes."""
    out = []
    for k in range(len(cx.low)):
        a, b = cx.corner_start[k : k + 2]
        count = int(cx.plane_start[k + 1] - cx.plane_start[k])
        start, corner, _ = loops_of(count, cx.twin[4 * a : 4 * b], cx.face[4 * a : 4 * b])
        points = cx.corner[:, a:b].T[corner]
        out.append([points[start[f] : start[f + 1]] for f in range(count)])
    return out


def part_polygons(cx):
    """Polygon of every part of every face, clipped by its edges as a kernel clips it."""
    out = []
    for k, faces in enumerate(polygons(cx)):
        for f, polygon in enumerate(faces, start=int(cx.plane_start[k])):
            for part in range(cx.part_start[f], cx.part_start[f + 1]):
                left = polygon
                for e in range(cx.edge_start[part], cx.edge_start[part + 1]):
                    left = clipped(left, cx.edge_normal[e], cx.edge_offset[e])
                out.append((k, f, int(cx.part_to[part]), left))
    return out


def volume(cx):
    return sum(area_vector(p) @ p[0] for faces in polygons(cx) for p in faces) / 3.0


def check(cx):
    """Cells closed; planes the same on either side, bit for bit; parts divide faces, and match across."""
    tiny = 1e-12 * cx.extent**2
    assert_array_equal(np.diff(cx.plane_start) >= 4, True)
    for k, faces in enumerate(polygons(cx)):
        assert_allclose(sum(area_vector(p) for p in faces), 0.0, atol=tiny)
        for f, polygon in enumerate(faces, start=int(cx.plane_start[k])):
            assert_allclose(polygon @ cx.normal[f], cx.offset[f], atol=1e-13 * cx.extent)
            assert area_vector(polygon) @ cx.normal[f] > 0.0
        corners = np.concatenate(faces)
        assert_array_equal(corners.min(axis=0), cx.low[k])
        assert_array_equal(corners.max(axis=0), cx.high[k])
    assert_allclose(np.linalg.norm(cx.normal, axis=1), 1.0, rtol=1e-15)
    seen = {}
    for plane, normal, offset in zip(cx.plane_id, cx.normal, cx.offset, strict=True):
        bits = (*normal, offset)
        first = seen.setdefault(plane, bits)
        assert bits == first or bits == tuple(-v for v in first)
    parts = part_polygons(cx)
    assert len(parts) == len(cx.part_to)
    assert all(polygon is not None for *_, polygon in parts)
    area = np.zeros((len(cx.normal), 3))
    across = {}
    for k, f, to, polygon in parts:
        area[f] += area_vector(polygon)
        if to >= 0:
            pair = (int(cx.plane_id[f]), min(k, to), max(k, to))
            across.setdefault(pair, {}).setdefault(k, []).append(polygon)
    whole = np.array([area_vector(p) for faces in polygons(cx) for p in faces])
    assert_allclose(area, whole, atol=1e-8 * cx.extent**2)
    for (_, a, b), sides in across.items():
        assert set(sides) == {a, b}
        here, there = ([area_vector(p) for p in sides[k]] for k in (a, b))
        assert len(here) == len(there)
        order = np.lexsort(np.round(np.array([p.mean(axis=0) for p in sides[a]]) / cx.extent, 7).T)
        reverse = np.lexsort(np.round(np.array([p.mean(axis=0) for p in sides[b]]) / cx.extent, 7).T)
        assert_allclose(np.array(here)[order], -np.array(there)[reverse], atol=1e-8 * cx.extent**2)
    opens = np.array([(cx.part_to[a:b] >= 0).any() for a, b in zip(cx.part_start, cx.part_start[1:], strict=False)])
    assert_array_equal(cx.opens, opens)
