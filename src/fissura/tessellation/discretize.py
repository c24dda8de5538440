"""From selected nuclei to bodies, contacts and surface facets."""

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.errors import InputError
from fissura.specimen.complex import Complex
from fissura.specimen.domain import Domain
from fissura.tessellation.limits import LOST, LOST_IN_SLIVERS, NEGLIGIBLE, SLIVER
from fissura.tessellation.measures import Joined, joined, lines, volume_of, volumes
from fissura.tessellation.nuclei import Nuclei
from fissura.tessellation.selection import select
from fissura.tessellation.tessellation import LEDGE, Contacts, Polygons, SurfaceFacets, Tessellation
from fissura.tessellation.voronoi import Cells, voronoi_cells


def _polygons(facets: Joined) -> Polygons:
    return Polygons(facets.polygons.points, facets.polygons.offsets, facets.facet)


def _contacts(cells: Cells, fine: BoolArray, smallest: float) -> Contacts:
    inner = cells.bodies.inner
    facets = joined(inner, smallest)
    bodies = np.stack([inner.body[facets.first], inner.other[facets.first]], axis=1)
    direction, length = lines(cells.x, bodies)
    return Contacts(
        bodies=bodies,
        area=facets.area,
        centroid=facets.centroid,
        normal=direction,
        length=length,
        fine=fine[bodies[:, 0]] & fine[bodies[:, 1]],
        polygons=_polygons(facets),
    )


def _surface(cells: Cells, names: tuple[str, ...], smallest: float) -> SurfaceFacets:
    outer = cells.bodies.outer
    facets = joined(outer, smallest)
    surface = -1 - outer.other[facets.first]
    keys, row = np.unique(cells.keys, return_index=True)
    return SurfaceFacets(
        body=outer.body[facets.first],
        area=facets.area,
        centroid=facets.centroid,
        normal=cells.complex.normal[row[np.searchsorted(keys, outer.plane[facets.first])]],
        surface=surface,
        names=(*names, LEDGE) if (surface == len(names)).any() else names,
        polygons=_polygons(facets),
    )


def _check_volume(found: float, complex_: Complex) -> None:
    """No volume may be lost in silence.

    Raises
    ------
    InputError
        A part of the specimen has no nucleus.
    """
    whole = volume_of(complex_)
    lost = abs(found - whole) / whole
    if lost > LOST and (lost > LOST_IN_SLIVERS or _flattest(complex_) > SLIVER):
        raise InputError(
            "discretization",
            f"bodies fill {found / whole:.9f} of the specimen's volume",
            "finer l_f and l_c, so that every part of the specimen has nuclei on its own side of all notches",
        )


def _flattest(complex_: Complex) -> float:
    """Least height of a convex cell over its longest diagonal."""
    corner, start = complex_.corner, complex_.corner_start
    height = np.full(len(complex_.offset), -np.inf)
    cell = np.repeat(np.arange(len(complex_.low)), np.diff(complex_.plane_start))
    for v in range(int(np.diff(start).max())):
        at = np.minimum(start[cell] + v, start[cell + 1] - 1)
        away = complex_.offset - np.einsum("pa,ap->p", complex_.normal, corner[:, at])
        height = np.maximum(height, away)
    diagonal = np.linalg.norm(complex_.high - complex_.low, axis=1)
    return float((height / diagonal[cell]).min())


def tessellate(
    x: FloatArray,
    home: IntArray,
    complex_: Complex,
    surfaces: tuple[str, ...],
    spacing: FloatArray,
    nucleus: IntArray | None = None,
    fine: BoolArray | None = None,
    previous: Tessellation | None = None,
) -> Tessellation:
    """Rigid bodies, contacts and surface facets of given nuclei (theory section 1).

    Parameters
    ----------
    x : (n, 3) array
        Nuclei [m].
    home : (n,) array
        The convex cell that holds each of them.
    complex_ : Complex
        The specimen.
    surfaces : tuple of str
        Names of its surfaces.
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
        Bodies do not fill the specimen: a part of it has no nucleus.
    ValueError
        Two nuclei coincide, or one lies in no convex cell.
    """
    n = len(x)
    fine = np.ones(n, bool) if fine is None else fine
    before = None if previous is None else previous.cells
    cells = voronoi_cells(x, home, complex_, len(surfaces), spacing, nucleus, before)
    smallest = NEGLIGIBLE * spacing.min() ** 2
    contacts, skin = _contacts(cells, fine, smallest), _surface(cells, surfaces, smallest)
    volume = volumes(
        cells.x, contacts.bodies, contacts.area, contacts.length, skin.body, skin.area, skin.centroid, skin.normal
    )
    _check_volume(float(volume.sum()), complex_)
    pieces = cells.bodies.pieces if len(complex_.low) > 1 else None
    return Tessellation(cells.nucleus, cells.x, fine, volume, contacts, skin, pieces, cells)


def discretize(
    nuclei: Nuclei, domain: Domain, spacing: FloatArray, previous: Tessellation | None = None
) -> Tessellation:
    """Discretize the specimen with a wanted spacing.

    Parameters
    ----------
    nuclei : Nuclei
        All fine nuclei of the specimen that may be used with this spacing.
    domain : Domain
        The specimen.
    spacing : (N,) array
        Wanted spacing at every one of them [m], 0 inside the refined region.
    previous : Tessellation, optional
        Another discretization of the same specimen. It saves the work where nothing changed; the result is the same
        without it, bit for bit.
    """
    kept, fine = select(nuclei, spacing)
    return tessellate(
        nuclei.x[kept],
        nuclei.home[kept],
        domain.complex,
        domain.surfaces,
        np.maximum(spacing[kept], nuclei.spacing),
        nuclei.identity[kept],
        fine,
        previous,
    )
