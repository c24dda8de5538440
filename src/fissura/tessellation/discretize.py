"""From selected nuclei to bodies, contacts and surface facets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fissura.specimen import Box
from fissura.tessellation.measures import facet_sums, lines, volumes
from fissura.tessellation.notching import check_not_bridged, cut_facets, near_notches, notch_walls
from fissura.tessellation.nuclei import Nuclei
from fissura.tessellation.ragged import Ragged
from fissura.tessellation.selection import select
from fissura.tessellation.structure import Contacts, Polygons, SurfaceFacets, Tessellation
from fissura.tessellation.voronoi import Cells, voronoi_cells

__all__ = ["discretize", "tessellate"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
T = TypeVar("T", bound=np.generic)

_NEGLIGIBLE = 1e-10  # of the squared spacing: facets that exist by round-off only


def _compressed(values: NDArray[T], present: BoolArray) -> NDArray[T]:
    return values if present.all() else values.take(np.flatnonzero(present), axis=0)


def _renumbered(polygons: Ragged, present: BoolArray) -> Polygons:
    if present.all():
        return Polygons(polygons.points, polygons.offsets, polygons.owner)
    new = np.cumsum(present) - 1
    return Polygons(polygons.points, polygons.offsets, new[polygons.owner])


@dataclass(frozen=True)
class _Pieces:
    """What notches make of the facets that they reach.

    Attributes
    ----------
    near, near_surface : (m,), (b,) bool array
        Facets of the cells, between them and on the surface, that are replaced.
    facets, surface : Ragged
        What is left of these; owners of walls are counted on from `b`.
    body, face, normal : (b + w,), (b + w,), (b + w, 3) array
        Body, number and outward normal of facets on the surface, then of walls.
    """

    near: BoolArray
    near_surface: BoolArray
    facets: Ragged
    surface: Ragged
    body: IntArray
    face: IntArray
    normal: FloatArray


def _cut_notches(cells: Cells, box: Box) -> _Pieces:
    x, pairs, body, face = cells.x, cells.pairs, cells.surface_body, cells.surface_face
    i, j = pairs.T
    normal = np.zeros((len(body), 3))
    normal[np.arange(len(body)), face // 2] = 2.0 * (face % 2) - 1.0
    radius = 0.5 * np.sqrt(cells.reach2)
    near = near_notches(cells.facets, i, x, radius, box.notches)
    near_surface = near_notches(cells.surface, body, x, radius, box.notches)
    facets, surface = cells.facets.take(np.flatnonzero(near)), cells.surface.take(np.flatnonzero(near_surface))
    for notch in box.notches:
        facets, severed, touched = cut_facets(facets, notch)
        surface, _, touched_surface = cut_facets(surface, notch)
        if notch.width == 0.0:
            walls = severed.take(np.tile(np.arange(len(severed)), 2))
            wall_body = np.concatenate([i[severed.owner], j[severed.owner]])
            toward = np.sign(notch.position - x[wall_body, notch.normal])
            wall_normal = np.eye(3)[notch.normal] * toward[:, None]
        else:
            behind = np.unique(np.concatenate([i[touched], j[touched], body[touched_surface]]))
            walls, wall_body, wall_normal = notch_walls(notch, behind, x, pairs)
        owner = len(body) + np.arange(len(walls))
        surface = surface.joined(Ragged(walls.points, walls.offsets, owner))
        body = np.concatenate([body, wall_body])
        face = np.concatenate([face, np.full(len(walls), len(box.surfaces) - 1)])
        normal = np.concatenate([normal, wall_normal])
    return _Pieces(near, near_surface, facets, surface, body, face, normal)


def tessellate(
    x: FloatArray,
    box: Box,
    spacing: FloatArray,
    nucleus: IntArray | None = None,
    fine: BoolArray | None = None,
    previous: Tessellation | None = None,
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
        Identities of the nuclei, ascending; by default their indices.
    fine : (n,) bool array, optional
        Which bodies are fine; by default all.
    previous : Tessellation, optional
        Another tessellation of the same specimen, nuclei of the same identity being at the same place: what did not
        change is taken from there, and the result is the same without it, bit for bit.

    Raises
    ------
    InputError
        The nuclei cannot represent a notch.
    ValueError
        Two nuclei coincide.
    """
    n = len(x)
    nucleus = np.arange(n) if nucleus is None else nucleus
    fine = np.ones(n, bool) if fine is None else fine
    cells = voronoi_cells(x, box.size, spacing, nucleus, None if previous is None else previous.cells)
    x, pairs = cells.x, cells.pairs
    cut = _cut_notches(cells, box)
    smallest = _NEGLIGIBLE * spacing.min() ** 2
    facets, area, centroid = facet_sums(
        cells.facets, cells.area, cells.centroid, cut.near, cut.facets, len(pairs), smallest
    )
    surface, skin_area, skin_centroid = facet_sums(
        cells.surface,
        cells.surface_area,
        cells.surface_centroid,
        cut.near_surface,
        cut.surface,
        len(cut.body),
        smallest,
    )
    reaching = np.zeros(n, np.bool_)
    reaching[np.concatenate([pairs[cut.near].ravel(), cells.surface_body[cut.near_surface]])] = True
    for notch in box.notches:
        check_not_bridged(notch, reaching, [(facets, pairs[:, 0]), (facets, pairs[:, 1]), (surface, cut.body)])

    present, on_surface = area > 0.0, skin_area > 0.0
    bodies = _compressed(pairs, present)
    direction, length = lines(x, bodies)
    contacts = Contacts(
        bodies=bodies,
        area=_compressed(area, present),
        centroid=_compressed(centroid, present),
        normal=direction,
        length=length,
        fine=fine[bodies[:, 0]] & fine[bodies[:, 1]],
        polygons=_renumbered(facets, present),
    )
    skin = SurfaceFacets(
        body=_compressed(cut.body, on_surface),
        area=_compressed(skin_area, on_surface),
        centroid=_compressed(skin_centroid, on_surface),
        normal=_compressed(cut.normal, on_surface),
        surface=_compressed(cut.face, on_surface),
        names=box.surfaces,
        polygons=_renumbered(surface, on_surface),
    )
    volume = volumes(x, bodies, contacts.area, length, skin.body, skin.area, skin.centroid, skin.normal)
    return Tessellation(nucleus, x, fine, volume, contacts, skin, cells)


def discretize(nuclei: Nuclei, box: Box, spacing: FloatArray, previous: Tessellation | None = None) -> Tessellation:
    """Discretize the specimen with a wanted spacing.

    Parameters
    ----------
    nuclei : Nuclei
        All fine nuclei of the specimen.
    box : Box
        The specimen.
    spacing : (N,) array
        Wanted spacing at every fine nucleus [m], 0 inside the refined region.
    previous : Tessellation, optional
        Another discretization of the same specimen. It saves the work where nothing changed; the result is the same
        without it, bit for bit.
    """
    kept, fine = select(nuclei, spacing)
    return tessellate(nuclei.x[kept], box, np.maximum(spacing[kept], nuclei.spacing), kept, fine, previous)
