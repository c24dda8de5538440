"""Voronoi structures that repeat themselves: a cube whose bodies touch images of each other across its faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation.clipped import Setting, clipped, plane_keys
from fissura.tessellation.limits import LAYER, NEGLIGIBLE
from fissura.tessellation.measures import lines, volumes
from fissura.tessellation.periodic_placement import place_periodic
from fissura.tessellation.tessellation import Contacts, Polygons


@dataclass(frozen=True)
class PeriodicCell:
    """A cube of bodies and contacts, repeated along all three axes.

    Attributes
    ----------
    side : float
        Side of the cube [m].
    x : (n, 3) array
        Nuclei [m].
    volume : (n,) array
        Volumes of the bodies [m^3]; bodies may stick out of the cube, their images fill what is left.
    contacts : Contacts
        Every contact once. Body ``j`` is there with one of its images, so ``x_j + shift - x_i = L n``; centroids are
        those on the side of body ``i``.
    shift : (m, 3) array
        Where that image lies, relative to body ``j`` itself [m].
    """

    side: float
    x: FloatArray
    volume: FloatArray
    contacts: Contacts
    shift: FloatArray

    def __len__(self) -> int:
        return len(self.x)

    @classmethod
    def placed(cls, side: float, spacing: float, rng: np.random.Generator) -> PeriodicCell:
        """Saturate a cube with nuclei at least `spacing` apart [m], and tessellate it."""
        return periodic_cell(place_periodic(side, spacing, rng), side, spacing)


def _images(x: FloatArray, side: float, layer: float) -> tuple[IntArray, IntArray]:
    """Nuclei with an image in a layer around the cube, and the steps to it in sides; (g,), (g, 3)."""
    steps = np.stack(np.meshgrid(*[np.arange(-1, 2)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = steps[np.any(steps != 0, axis=1)]
    place = x[None, :, :] + side * steps[:, None, :]
    step, body = np.nonzero(np.all((place > -layer) & (place < side + layer), axis=2))
    return body.astype(np.int64), steps[step].astype(np.int64)


def periodic_cell(x: FloatArray, side: float, spacing: float, gap: float = 1.0) -> PeriodicCell:
    """Tessellate a periodic cube.

    Parameters
    ----------
    x : (n, 3) array
        Nuclei in the cube [m].
    side : float
        Side of the cube [m].
    spacing : float
        Smallest distance of neighbouring nuclei [m].
    gap : float
        No point is farther than this from a nucleus or an image, in spacings; 1 for saturated nuclei, at most 1.6.

    Raises
    ------
    ValueError
        Nuclei that coincide, or leave larger gaps.
    """
    n, layer = len(x), LAYER * gap * spacing
    assert layer <= side
    body, step = _images(x, side, layer)
    of = np.concatenate([np.arange(n), body])
    steps = np.concatenate([np.zeros((n, 3), np.int64), step])
    everywhere = np.ascontiguousarray(x[of] + side * steps + layer)
    size = (side + 2.0 * layer,) * 3
    complex_, _ = complex_of(box(size))
    home = np.zeros(len(of), np.int64)
    setting = Setting.of(everywhere, home, complex_, plane_keys(complex_), np.full(len(of), spacing), 0)
    found = clipped(np.arange(len(of)) < n, setting)
    if len(found.outer.body) or found.reach2.max() > layer**2:
        raise ValueError("the nuclei leave gaps")
    i, other, area = found.inner.body, found.inner.other, found.inner.area
    # A contact across a face is found from both of its sides: the one whose image lies in positive direction counts.
    ahead = np.sign(steps[other]) @ np.array([9, 3, 1])
    kept = np.flatnonzero((ahead >= 0) & (area > NEGLIGIBLE * spacing**2))
    kept = kept[np.lexsort((ahead[kept], of[other[kept]], i[kept]))]
    polygons, area, centroid = found.inner.polygons.take(kept), area[kept], found.inner.centroid[kept] - layer
    bodies = np.stack([i[kept], other[kept]], axis=1)
    direction, length = lines(everywhere, bodies)
    paired = np.stack([bodies[:, 0], of[bodies[:, 1]]], axis=1)
    none, nothing, no_vector = np.empty(0, np.int64), np.empty(0), np.empty((0, 3))
    return PeriodicCell(
        side,
        x,
        volumes(x, paired, area, length, none, nothing, no_vector, no_vector),
        Contacts(
            bodies=paired,
            area=area,
            centroid=centroid,
            normal=direction,
            length=length,
            fine=np.ones(len(kept), np.bool_),
            polygons=Polygons(polygons.points - layer, polygons.offsets, np.arange(len(kept))),
        ),
        side * steps[bodies[:, 1]].astype(float),
    )
