"""A tessellation: rigid bodies, contacts between them, facets on the specimen's surface."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from fissura.tessellation.voronoi import Cells

#: Name of the surface to which ledges at the tip of a notch belong.
LEDGE = "ledge"


@dataclass(frozen=True)
class Polygons:
    """Planar convex polygons of different numbers of corners.

    A facet that reaches through several convex cells of the specimen consists of several polygons.

    Attributes
    ----------
    points : (p, 3) array
        Corners [m] of all polygons, one polygon after another, in order around it.
    offsets : (q + 1,) array
        Corners of polygon ``k`` are ``points[offsets[k]:offsets[k + 1]]``.
    facet : (q,) array
        Index of the facet (contact or surface facet) to which each polygon belongs, ascending.
    """

    points: FloatArray
    offsets: IntArray
    facet: IntArray

    def __len__(self) -> int:
        return len(self.offsets) - 1

    @classmethod
    def none(cls) -> Polygons:
        """No polygons."""
        return cls(np.empty((0, 3)), np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int64))


@dataclass(frozen=True)
class Contacts:
    """Contacts: common facets of neighbouring bodies (theory section 1).

    Attributes
    ----------
    bodies : (m, 2) array
        Indices ``i < j`` of the two bodies in the tessellation.
    area : (m,) array
        Area ``A`` of the facet [m^2].
    centroid : (m, 3) array
        Centroid ``c`` of the facet [m].
    normal : (m, 3) array
        Unit normal ``n = (x_j - x_i) / L``.
    length : (m,) array
        Distance ``L`` of the two nuclei [m].
    fine : (m,) bool array
        True where both bodies are fine: the damage law acts there; all others are elastic.
    polygons : Polygons
        Shape of the facets; ``polygons.facet`` indexes contacts.
    """

    bodies: IntArray
    area: FloatArray
    centroid: FloatArray
    normal: FloatArray
    length: FloatArray
    fine: BoolArray
    polygons: Polygons

    def __len__(self) -> int:
        return len(self.area)


@dataclass(frozen=True)
class SurfaceFacets:
    """Facets of bodies on the surface of the specimen, walls of notches included.

    At the level of a notch's tip, the plane of the notch ends and bisectors begin. Where they do not meet, bodies end
    in ledges, small facets at that level that are free like the surface; they belong to a surface of their own,
    `LEDGE`, which is named last.

    Attributes
    ----------
    body : (b,) array
        Index of the body.
    area : (b,) array
        Area [m^2].
    centroid : (b, 3) array
        Centroid [m].
    normal : (b, 3) array
        Outward unit normal.
    surface : (b,) array
        Index into ``names``.
    names : tuple of str
        Names of the surfaces.
    polygons : Polygons
        Shape of the facets; ``polygons.facet`` indexes surface facets.
    """

    body: IntArray
    area: FloatArray
    centroid: FloatArray
    normal: FloatArray
    surface: IntArray
    names: tuple[str, ...]
    polygons: Polygons

    @property
    def ledges(self) -> BoolArray:
        """Which facets are ledges at the tip of a notch, shape (b,)."""
        if not self.names or self.names[-1] != LEDGE:
            return np.zeros(len(self), np.bool_)
        return np.asarray(self.surface == len(self.names) - 1)

    def __len__(self) -> int:
        return len(self.area)


@dataclass(frozen=True)
class Tessellation:
    """Rigid bodies of one discretization of the specimen, with their contacts and surface facets.

    Attributes
    ----------
    nucleus : (n,) array
        Identity of each body's nucleus in the specimen's set of fine nuclei, ascending.
    x : (n, 3) array
        Positions of the nuclei [m].
    fine : (n,) bool array
        True for bodies in the refined region.
    volume : (n,) array
        Volumes [m^3].
    contacts : Contacts
        Contacts between bodies.
    surface : SurfaceFacets
        Facets on the specimen's surface.
    pieces : (p, 2) array, optional
        Body and convex cell of the specimen for every piece of a body; None where all of it is one convex cell.
    cells : Cells, optional
        How bodies were found, so that the next discretization need not repeat all the work.

    Examples
    --------
    >>> bodies = result.last.tessellation
    >>> round(float(bodies.volume.sum()), 12)  # of the specimen [m^3]
    1.92e-05
    """

    nucleus: IntArray
    x: FloatArray
    fine: BoolArray
    volume: FloatArray
    contacts: Contacts
    surface: SurfaceFacets
    pieces: IntArray | None = field(default=None, repr=False)
    cells: Cells | None = field(default=None, repr=False, compare=False)

    @property
    def centroids(self) -> FloatArray:
        """Centroids of the bodies [m], shape (n, 3): each is made of cones from its nucleus to its facets."""
        contacts, skin, x = self.contacts, self.surface, self.x
        moment = np.zeros_like(x)
        cone = (contacts.area * contacts.length / 6.0)[:, None]
        for side in contacts.bodies.T:
            np.add.at(moment, side, cone * (contacts.centroid - x[side]))
        arm = skin.centroid - x[skin.body]
        cone = (skin.area * np.einsum("ba,ba->b", skin.normal, arm) / 3.0)[:, None]
        np.add.at(moment, skin.body, cone * arm)
        return np.asarray(x + 0.75 * moment / self.volume[:, None])

    def inside(self, cell: int) -> IntArray | None:
        """Bodies with a piece in a convex cell of the specimen.

        Parameters
        ----------
        cell : int
            Number of the cell.

        Returns
        -------
        array or None
            Their indices; None where the specimen is one cell.

        Examples
        --------
        >>> fissura.Simulation(case.with_({"notch": []})).tessellation.inside(0) is None
        True
        """
        return None if self.pieces is None else self.pieces[self.pieces[:, 1] == cell, 0]

    def without_shapes(self) -> Tessellation:
        """The same without the polygons of contacts and without cells: all that equations need, in half the memory.

        Returns
        -------
        Tessellation
            Its other arrays are the same objects.

        Examples
        --------
        >>> len(result.last.tessellation.without_shapes().contacts.polygons.points)
        0
        """
        return replace(self, contacts=replace(self.contacts, polygons=Polygons.none()), cells=None)

    def __len__(self) -> int:
        return len(self.x)
