"""Points on named surfaces: which part is nearest, and what a name means."""

from collections.abc import Sequence

import numpy as np

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.specimen.domain import Domain
from fissura.specimen.limits import ROUND_OFF
from fissura.specimen.surface_part import SurfacePart


def surface_parts(domain: Domain, names: Sequence[str], key: str) -> tuple[SurfacePart, ...]:
    """Parts of named surfaces.

    Raises
    ------
    InputError
        A name that no surface has.
    """
    for name in names:
        if name not in domain.surfaces:
            raise InputError(key, f"{name!r} is not a surface of the specimen", ", ".join(domain.surfaces))
    return domain.faces(*names)


def as_text(point: FloatArray) -> str:
    """A point as a message shows it."""
    return f"({', '.join(f'{v + 0.0:.6g}' for v in point)}) m"


def mean_normal(parts: Sequence[SurfacePart]) -> FloatArray:
    """Mean of the outward normals by area, shape (3,); short where they cancel each other."""
    areas = np.array([part.area for part in parts])
    out: FloatArray = areas @ np.array([part.normal for part in parts]) / areas.sum()
    return out


def is_curved(parts: Sequence[SurfacePart]) -> bool:
    """Whether parts have more than one normal."""
    normals = np.array([part.normal for part in parts])
    return bool(np.abs(normals - normals[0]).max() > ROUND_OFF)


def slack_of(domain: Domain, parts: Sequence[SurfacePart], l_f: float) -> float:
    """How far from a surface a point may be given [m]: round ones are polygons, flat ones are exact."""
    slack = domain.on_surface
    return max(slack, 0.2 * l_f) if is_curved(parts) else slack


def distances(parts: Sequence[SurfacePart], point: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distance of a point from each part, and the nearest point on it.

    Returns
    -------
    distance : (k,) array
        Distances [m].
    nearest : (k, 3) array
        Points on the parts [m].
    """
    nearest = np.array([_nearest(part, point) for part in parts])
    distance: FloatArray = np.linalg.norm(nearest - point, axis=1)
    return distance, nearest


def _nearest(part: SurfacePart, point: FloatArray) -> FloatArray:
    foot: FloatArray = point - ((point - part.polygon[0]) @ part.normal) * part.normal
    after = np.roll(part.polygon, -1, axis=0)
    edge = after - part.polygon
    if (np.cross(edge, foot - part.polygon) @ part.normal >= 0.0).all():
        return foot
    length2 = np.maximum(np.einsum("ka,ka->k", edge, edge), 1e-300)
    share = np.clip(np.einsum("ka,ka->k", foot - part.polygon, edge) / length2, 0.0, 1.0)
    on_edges = part.polygon + share[:, None] * edge
    best = int(np.argmin(np.linalg.norm(on_edges - foot, axis=1)))
    out: FloatArray = on_edges[best]
    return out
