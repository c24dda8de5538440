"""Places on the surface: points, lines, strips and whole surfaces, sampled by points with weights and normals."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case import Patch as PatchPart
from fissura.errors import InputError
from fissura.specimen.domain import Domain
from fissura.specimen.limits import NO_COMPONENT, SAMPLES
from fissura.specimen.notches import SURFACE, Notch
from fissura.specimen.planes import unit
from fissura.specimen.samples import (
    Sample,
    along_of,
    at_coordinate,
    at_points,
    in_box,
    on_line,
    over,
    strip_facing,
)
from fissura.specimen.surface import distances, surface_parts
from fissura.specimen.surface_part import SurfacePart


@dataclass(frozen=True, eq=False)
class Place:
    """Points sampled over a part of the surface.

    Attributes
    ----------
    points : (k, 3) array
        Sample points [m].
    weights : (k,) array
        Share of the place that each point stands for; they sum to 1.
    normals : (k, 3) array
        Outward unit normals.
    cells : (k,) array
        The convex cell behind each point.
    along : (3,) array
        Unit vector on the surface along which the place is given: across a line, and across the platen that a strip
        stands for.
    parts : tuple of SurfacePart
        What of the surface it is; empty for lines and points.
    """

    points: FloatArray
    weights: FloatArray
    normals: FloatArray
    cells: IntArray
    along: FloatArray
    parts: tuple[SurfacePart, ...] = ()

    @property
    def centroid(self) -> FloatArray:
        """Weighted mean of the points, shape (3,) [m]."""
        out: FloatArray = self.weights @ self.points
        return out

    @property
    def outward(self) -> FloatArray | None:
        """Unit vector of the mean normal, shape (3,); None where normals cancel each other."""
        mean: FloatArray = self.weights @ self.normals
        return unit(mean) if np.linalg.norm(mean) > NO_COMPONENT else None

    @property
    def hinge(self) -> FloatArray | None:
        """Unit vector across `along` on the surface, shape (3,): the direction of a line or platen; None without it."""
        outward = self.outward
        if outward is None:
            return None
        out = np.cross(self.along, outward)
        return unit(out) if np.linalg.norm(out) > NO_COMPONENT else None


def place_from_part(part: PatchPart, domain: Domain, l_f: float, key: str) -> Place:
    """Sample a place on the surface of a specimen, so finely that even fine bodies take their proper share.

    Parameters
    ----------
    part : Patch part of the case
        Surfaces, and a point, a line, a strip, a box or nothing (all of it).
    domain : Domain
        The specimen.
    l_f : float
        Spacing of fine nuclei [m].
    key : str
        Where the part stands in the case file, for messages.

    Raises
    ------
    InputError
        An unknown surface, a place that is not on the surface, in the mouth of a notch or in the plane of an ideal cut.
    """
    spacing = l_f / SAMPLES
    parts = surface_parts(domain, part.surfaces, f"{key}.{part.naming}")
    strip = part.toward is not None and part.width > 0.0 and part.at is None
    if part.toward is not None and not strip:
        parts = _looking(part, parts, f"{key}.toward")
    _check_one_side(part, domain, parts, f"{key}.toward")
    if part.point is not None:
        sample = at_points([part.point], part, domain, parts, spacing, f"{key}.point")
    elif part.line is not None:
        sample = on_line(part, domain, parts, spacing, f"{key}.line")
    elif strip:
        sample = strip_facing(part, domain, parts, spacing, f"{key}.toward")
    elif part.box is not None:
        sample = in_box(part, domain, parts, spacing, f"{key}.box")
    elif part.at is not None:
        sample = at_coordinate(part, domain, parts, spacing, key)
    else:
        along = along_of(part, parts, key)
        sample = over(parts, along, spacing, f"{key}.{part.naming}")
    return _checked(sample, domain)


def _looking(part: PatchPart, parts: Sequence[SurfacePart], key: str) -> tuple[SurfacePart, ...]:
    """Those parts that look a given way, within 60 degrees."""
    found = tuple(p for p in parts if p.normal @ np.asarray(part.toward) > 0.5)
    if not found:
        raise InputError(key, f"nothing of the surface {part.told} looks that way", "a direction out of the specimen")
    return found


def _check_one_side(part: PatchPart, domain: Domain, parts: Sequence[SurfacePart], key: str) -> None:
    """Of an ideal cut, whose sides are at the same place, only one may belong to a place."""
    for notch in domain.notches:
        walls = [p for p in parts if notch.width == 0.0 and _is_wall(p, notch, domain)]
        if len({bool(p.normal @ notch.normal > 0.0) for p in walls}) > 1:
            direction = ", ".join(f"{v + 0.0:.4g}" for v in notch.normal)
            problem = "missing: both sides of an ideal cut are at the same place"
            raise InputError(key, problem, f"[{direction}] or its opposite, the way in which one side looks")


def _is_wall(part: SurfacePart, notch: Notch, domain: Domain) -> bool:
    """Whether a part is a side of an ideal cut."""
    flat = abs(part.normal @ notch.normal) > 1.0 - NO_COMPONENT
    off = float(np.abs(notch.across(part.polygon)).max())
    return bool(flat and off <= domain.on_surface and notch.ahead(part.polygon.mean(axis=0)) < 0.0)


def _checked(sample: Sample, domain: Domain) -> Place:
    """The place without points in the plane of an ideal cut, which neither side owns."""
    clear = np.ones(len(sample.points), bool)
    tolerance = domain.on_surface
    for notch in domain.notches:
        if notch.width > 0.0:
            continue
        near = (np.abs(notch.across(sample.points)) <= tolerance) & (notch.ahead(sample.points) <= tolerance)
        near &= np.abs(sample.normals @ notch.normal) < 1.0 - NO_COMPONENT  # its own sides know their cells
        walls = [p for p in domain.faces(SURFACE) if abs(p.normal @ notch.normal) > 1.0 - NO_COMPONENT]
        for k in np.flatnonzero(near):
            clear[k] &= distances(walls, sample.points[k])[0].min() > tolerance
    if not clear.any():
        problem = "lies in the plane of an ideal cut, in the mouth of a notch: neither side owns it"
        raise InputError(sample.key, problem, "a place on the specimen's surface beside the notch")
    size = sample.size[clear] / sample.size[clear].max()  # equal ones have a sum without round-off
    return Place(
        sample.points[clear], size / size.sum(), sample.normals[clear], sample.cells[clear], sample.along, sample.parts
    )
