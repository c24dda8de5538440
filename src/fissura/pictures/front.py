"""Facets of bodies that one sees looking along z, and the lines around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from fissura.tessellation.tessellation import Polygons, SurfaceFacets

_FACING = 0.1
"""Facets whose normal has at least this part against the line of sight are seen."""

_NEAR = 1e-7
"""Of the extent: lines nearer to each other lie on one another."""


def seen(surface: SurfaceFacets) -> IntArray:
    """Polygons of the surface that face the viewer, the farthest first; of a box those on the front."""
    polygons = surface.polygons
    chosen = np.flatnonzero(surface.normal[polygons.facet, 2] < -_FACING)
    depth = surface.centroid[polygons.facet[chosen], 2]
    return np.asarray(chosen[np.argsort(-depth, kind="stable")], dtype=np.int64)


def projected(polygons: Polygons, chosen: IntArray) -> list[FloatArray]:
    """Corners (k, 2) of chosen polygons seen along z [mm]."""
    flat, offsets = polygons.points[:, :2] * 1e3, polygons.offsets
    return [flat[a:b] for a, b in zip(offsets[chosen].tolist(), offsets[chosen + 1].tolist(), strict=True)]


def rims(polygons: Polygons, chosen: IntArray, body: IntArray) -> FloatArray:
    """Lines around what polygons of one body cover together.

    A body's facet on the surface is of several polygons where it reaches through several convex cells of the specimen.

    Parameters
    ----------
    polygons : Polygons
        Polygons of surface facets.
    chosen : (q,) array
        Some of them.
    body : (q,) array
        The body of each of those.

    Returns
    -------
    (s, 2, 3) array
        Ends of the lines [m].
    """
    if not len(chosen):
        return np.empty((0, 2, 3))
    size = np.diff(polygons.offsets)[chosen]
    first = np.repeat(polygons.offsets[chosen], size)
    place = np.arange(len(first)) - np.repeat(np.cumsum(size) - size, size)
    lines = polygons.points[np.stack([first + place, first + (place + 1) % np.repeat(size, size)], axis=1)]
    owner = np.repeat(body, size)
    many = np.bincount(body, minlength=int(body.max()) + 1)[owner] > 1
    order = np.flatnonzero(many)[np.argsort(owner[many], kind="stable")]
    near = _NEAR * float(np.ptp(polygons.points, axis=0).max())
    parts = [lines[~many]]
    for own in np.split(order, np.flatnonzero(np.diff(owner[order])) + 1):
        parts += [_uncovered(lines[own], k, near) for k in range(len(own))]
    return np.concatenate(parts)


def _uncovered(lines: FloatArray, k: int, near: float) -> FloatArray:
    """What of a line no other, which runs the other way, lies on; (s, 2, 3)."""
    start, along = lines[k, 0], lines[k, 1] - lines[k, 0]
    length = float(np.linalg.norm(along))
    if length <= near:
        return np.empty((0, 2, 3))
    along = along / length
    reach = (lines - start) @ along
    off = np.linalg.norm(lines - start - reach[:, :, None] * along, axis=2).max(axis=1)
    back = (off <= near) & (reach[:, 1] < reach[:, 0])
    left, at = [], 0.0
    for high, low in sorted(np.clip(reach[back], 0.0, length).tolist(), key=lambda ends: ends[1]):
        if low > at + near:
            left.append((at, low))
        at = max(at, high)
    if at < length - near:
        left.append((at, length))
    ends: FloatArray = start + np.array(left).reshape(-1, 2)[:, :, None] * along
    return ends
