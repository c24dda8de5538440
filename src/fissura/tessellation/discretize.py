"""From selected nuclei to bodies, contacts and surface facets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.specimen import Box
from fissura.tessellation.notching import check_not_bridged, cut_facets, notch_walls
from fissura.tessellation.nuclei import Nuclei
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.selection import select
from fissura.tessellation.structure import Contacts, Polygons, SurfaceFacets, Tessellation
from fissura.tessellation.voronoi import Ragged, voronoi_cells

__all__ = ["discretize", "tessellate"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_NEGLIGIBLE = 1e-10  # of the squared spacing: facets that exist by round-off only


def _summed(owner: IntArray, values: FloatArray, count: int) -> FloatArray:
    return np.asarray(np.bincount(owner, values, count), dtype=np.float64)


def _sums(polygons: Ragged, count: int, smallest: float) -> tuple[Ragged, FloatArray, FloatArray, NDArray[np.bool_]]:
    """Area and centroid of every owner, over its polygons; those of negligible size are dropped."""
    vector, centroid = areas_and_centroids(polygons.points, polygons.offsets)
    size = np.linalg.norm(vector, axis=1)
    polygons = polygons.take(np.flatnonzero(size > smallest))
    centroid, size = centroid[size > smallest], size[size > smallest]
    area = _summed(polygons.owner, size, count)
    present = area > 0.0
    centre = np.stack([_summed(polygons.owner, size * centroid[:, a], count) for a in range(3)], axis=1)
    centre[present] /= area[present, None]
    return polygons, area, centre, present


def _renumbered(polygons: Ragged, present: NDArray[np.bool_]) -> Polygons:
    new = np.cumsum(present) - 1
    return Polygons(polygons.points, polygons.offsets, new[polygons.owner])


def tessellate(
    x: FloatArray,
    box: Box,
    spacing: FloatArray,
    nucleus: IntArray | None = None,
    fine: NDArray[np.bool_] | None = None,
) -> Tessellation:
    """Rigid bodies, contacts and surface facets of given nuclei (theory section 1).

    Parameters
    ----------
    x : (n, 3) array
        Nuclei [m], with mirrored twins along notches.
    box : Box
        The specimen.
    spacing : (n,) array
        Local spacing of the nuclei [m].
    nucleus : (n,) array, optional
        Identities of the nuclei; by default their indices.
    fine : (n,) bool array, optional
        Which bodies are fine; by default all.

    Raises
    ------
    InputError
        The nuclei cannot represent a notch.
    """
    n = len(x)
    nucleus = np.arange(n) if nucleus is None else nucleus
    fine = np.ones(n, bool) if fine is None else fine
    cells = voronoi_cells(x, box.size, spacing)
    pairs, facets, surface = cells.pairs, cells.facets, cells.surface
    i, j = pairs.T
    body = cells.surface_body
    face = cells.surface_face
    normal = np.zeros((len(body), 3))
    normal[np.arange(len(body)), face // 2] = 2.0 * (face % 2) - 1.0

    for notch in box.notches:
        facets, severed, touched = cut_facets(facets, notch)
        surface, _, touched_surface = cut_facets(surface, notch)
        if notch.width == 0.0:
            walls = severed.take(np.tile(np.arange(len(severed)), 2))
            wall_body = np.concatenate([i[severed.owner], j[severed.owner]])
            toward = np.sign(notch.position - x[wall_body, notch.normal])
            wall_normal = np.eye(3)[notch.normal] * toward[:, None]
        else:
            near = np.unique(np.concatenate([i[touched], j[touched], body[touched_surface]]))
            walls, wall_body, wall_normal = notch_walls(notch, near, x, pairs)
        owner = len(body) + np.arange(len(walls))
        surface = surface.joined(Ragged(walls.points, walls.offsets, owner))
        body = np.concatenate([body, wall_body])
        face = np.concatenate([face, np.full(len(walls), len(box.surfaces) - 1)])
        normal = np.concatenate([normal, wall_normal])

    smallest = _NEGLIGIBLE * spacing.min() ** 2
    facets, area, centroid, present = _sums(facets, len(pairs), smallest)
    surface, surface_area, surface_centroid, on_surface = _sums(surface, len(body), smallest)
    for notch in box.notches:
        check_not_bridged(
            notch,
            n,
            [(facets, i[facets.owner]), (facets, j[facets.owner]), (surface, body[surface.owner])],
        )

    i, j = i[present], j[present]
    line = x[j] - x[i]
    length = np.linalg.norm(line, axis=1)
    contacts = Contacts(
        bodies=np.stack([i, j], axis=1),
        area=area[present],
        centroid=centroid[present],
        normal=line / length[:, None],
        length=length,
        fine=fine[i] & fine[j],
        polygons=_renumbered(facets, present),
    )
    skin = SurfaceFacets(
        body=body[on_surface],
        area=surface_area[on_surface],
        centroid=surface_centroid[on_surface],
        normal=normal[on_surface],
        surface=face[on_surface],
        names=box.surfaces,
        polygons=_renumbered(surface, on_surface),
    )
    half = contacts.area * length / 6.0
    cone = skin.area * np.einsum("ba,ba->b", skin.normal, skin.centroid - x[skin.body]) / 3.0
    volume = _summed(i, half, n) + _summed(j, half, n) + _summed(skin.body, cone, n)
    return Tessellation(nucleus, x, fine, volume, contacts, skin)


def discretize(nuclei: Nuclei, box: Box, spacing: FloatArray) -> Tessellation:
    """Discretize the specimen with a wanted spacing.

    Parameters
    ----------
    nuclei : Nuclei
        All fine nuclei of the specimen.
    box : Box
        The specimen.
    spacing : (N,) array
        Wanted spacing at every fine nucleus [m], 0 inside the refined region.
    """
    kept, fine = select(nuclei, spacing)
    return tessellate(nuclei.x[kept], box, np.maximum(spacing[kept], nuclei.spacing), kept, fine)
