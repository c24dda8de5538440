"""Points of a place, before it is known whether all of them may be used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case import Patch as PatchPart
from fissura.errors import InputError
from fissura.specimen.convex import clipped_by
from fissura.specimen.domain import Domain
from fissura.specimen.limits import NO_COMPONENT, SAMPLES
from fissura.specimen.planes import unit
from fissura.specimen.sampling import sampled_interval, sampled_polygon
from fissura.specimen.shapes.prism import AXES, box_half_spaces
from fissura.specimen.surface import as_text, distances, is_curved, slack_of
from fissura.specimen.surface_part import SurfacePart
from fissura.specimen.traces import Trace, traces_at


@dataclass(frozen=True, eq=False)
class Sample:
    """Points of a place.

    Attributes
    ----------
    points : (k, 3) array
        The points [m].
    size : (k,) array
        Length or area for which each stands; 1 for single points.
    normals : (k, 3) array
        Outward unit normals.
    cells : (k,) array
        The convex cell behind each.
    along : (3,) array
        Unit vector along which the place is given.
    key : str
        Key of the case that decides where they are.
    parts : tuple of SurfacePart
        What they are sampled over; empty for lines and points.
    """

    points: FloatArray
    size: FloatArray
    normals: FloatArray
    cells: IntArray
    along: FloatArray
    key: str
    parts: tuple[SurfacePart, ...] = ()

    @classmethod
    def behind(
        cls, points: FloatArray, size: FloatArray, parts: Sequence[SurfacePart], along: FloatArray, key: str
    ) -> Sample:
        """Points with the part of the surface under each."""
        normals = np.array([part.normal for part in parts])
        return cls(points, size, normals, np.array([part.cell for part in parts], dtype=np.int64), along, key)


def along_of(part: PatchPart, parts: Sequence[SurfacePart], key: str) -> FloatArray:
    """Unit vector of the axis along which a place is given; x, or y on what faces along x, unless the case says."""
    areas = np.array([p.area for p in parts])
    facing = int(np.argmax(areas @ np.abs([p.normal for p in parts])))
    axis = ("y" if facing == 0 else "x") if part.along is None else part.along
    along: FloatArray = np.eye(3)[AXES[axis]]
    if all(abs(p.normal @ along) > 1.0 - NO_COMPONENT for p in parts):
        raise InputError(f"{key}.along", f"'{axis}' is perpendicular to the surface {part.told}", "another axis")
    return along


def over(parts: Sequence[SurfacePart], along: FloatArray, spacing: float, key: str) -> Sample:
    """All of some parts."""
    points, size = [], []
    for part in parts:
        first = along - (along @ part.normal) * part.normal
        if np.linalg.norm(first) < 0.1:  # rows of points follow an edge where the axis leads out of the surface
            first = part.polygon[1] - part.polygon[0]
        found, area = sampled_polygon(part.polygon, part.normal, unit(first), spacing)
        points.append(found)
        size.append(area)
    count = [len(area) for area in size]
    normals = np.repeat([part.normal for part in parts], count, axis=0)
    cells = np.repeat(np.array([part.cell for part in parts], dtype=np.int64), count)
    return Sample(np.concatenate(points), np.concatenate(size), normals, cells, along, key, tuple(parts))


def at_coordinate(part: PatchPart, domain: Domain, parts: Sequence[SurfacePart], spacing: float, key: str) -> Sample:
    """A line or a strip at a coordinate along an axis."""
    assert part.at is not None
    along = along_of(part, parts, key)
    axis = int(np.argmax(along))
    tolerance = domain.on_surface
    coordinates = np.concatenate([p.polygon[:, axis] for p in parts])
    least, most = float(coordinates.min()), float(coordinates.max())
    low, high = part.at - 0.5 * part.width, part.at + 0.5 * part.width
    key = f"{key}.at"
    if low < least - tolerance or high > most + tolerance:
        place = f"a strip from {low:g} to {high:g} m" if part.width else f"{part.at:g} m"
        allowed = f"between {least:g} and {most:g} m along {'xyz'[axis]}"
        raise InputError(key, f"{place} is off the surface {part.told}", allowed)
    if part.width > 0.0:
        chosen = _between(parts, along, low, high, tolerance)
        if not chosen:
            raise _nothing(domain, part, axis, key)
        return over(chosen, along, spacing, key)
    traces = traces_at(parts, axis, float(np.clip(part.at, least, most)), tolerance)
    if not traces:
        raise _nothing(domain, part, axis, key)
    points, size, behind = [], [], []
    for trace in traces:
        found, where = _on_trace(trace, spacing)
        points.append(found)
        size.append(np.full(len(found), trace.length / len(found)))
        behind += where
    return Sample.behind(np.concatenate(points), np.concatenate(size), behind, along, key)


def _on_trace(trace: Trace, spacing: float) -> tuple[FloatArray, list[SurfacePart]]:
    """Points on a straight line over one or more parts, and the part below each."""
    share = sampled_interval(0.0, trace.length, spacing)
    along = (trace.end - trace.start) / trace.length
    below = [trace.parts[int(np.searchsorted(trace.ends, s))] for s in share]
    return trace.start + share[:, None] * along, below


def _nothing(domain: Domain, part: PatchPart, axis: int, key: str) -> InputError:
    """Error about a coordinate at which a surface has no place."""
    assert part.at is not None
    for notch in domain.notches:
        if abs(notch.normal[axis]) > 1.0 - NO_COMPONENT:
            off = abs(part.at * notch.normal[axis] - notch.point @ notch.normal)
            if off <= 0.5 * notch.width:
                return InputError(key, "lies in the mouth of a notch", "a place on the surface beside the notch")
    return InputError(
        key, f"the surface {part.told} has no place at {part.at:g} m along {'xyz'[axis]}", "a place on it"
    )


def _clipped(parts: Sequence[SurfacePart], normal: FloatArray, offset: float, tolerance: float) -> list[SurfacePart]:
    """What of some parts lies in a half-space ``normal @ x <= offset``."""
    out = []
    for part in parts:
        left = clipped_by(part.polygon, normal[None, :], np.array([offset]), tolerance)
        if left is not None:
            out.append(SurfacePart(left, part.normal, part.cell))
    return out


def _between(
    parts: Sequence[SurfacePart], along: FloatArray, low: float, high: float, tolerance: float
) -> list[SurfacePart]:
    """What of some parts lies between two coordinates along a direction."""
    return _clipped(_clipped(parts, along, high, tolerance), -along, -low, tolerance)


def at_points(
    given: Sequence[Sequence[float]],
    part: PatchPart,
    domain: Domain,
    parts: Sequence[SurfacePart],
    spacing: float,
    key: str,
) -> Sample:
    """Points on the surface, moved onto it where it is round."""
    slack = slack_of(domain, parts, SAMPLES * spacing)
    points, behind = [], []
    for point in np.asarray(given, float):
        distance, nearest = distances(parts, point)
        best = int(np.argmin(distance))
        if distance[best] > slack:
            _check_mouth(domain, point, key)
            raise InputError(
                key,
                f"{as_text(point)} is not on the surface {part.told}",
                f"a point of it; the nearest is {as_text(nearest[best])}",
            )
        points.append(nearest[best])
        behind.append(parts[best])
    along = along_of(part, behind, key.rpartition(".")[0])
    return Sample.behind(np.array(points), np.ones(len(points)), behind, along, key)


def _check_mouth(domain: Domain, point: FloatArray, key: str) -> None:
    """Say so when a place is where a notch has taken the surface away."""
    tolerance = domain.on_surface
    for notch in domain.notches:
        in_void = abs(notch.across(point)) < 0.5 * notch.width and notch.ahead(point) < 0.0
        if in_void and notch.ahead(point) > -notch.depth - tolerance:
            raise InputError(key, "lies in the mouth of a notch", "a place on the surface beside the notch")


def on_line(part: PatchPart, domain: Domain, parts: Sequence[SurfacePart], spacing: float, key: str) -> Sample:
    """A straight line from point to point, moved onto the surface where it is round."""
    assert part.line is not None
    a, b = np.asarray(part.line, float)
    length = float(np.linalg.norm(b - a))
    if length <= domain.on_surface:
        raise InputError(key, "its ends are the same point", "two points, or point instead of line")
    share = sampled_interval(0.0, 1.0, spacing / length)
    found = at_points((a + share[:, None] * (b - a)).tolist(), part, domain, parts, spacing, key)
    outward = found.normals.mean(axis=0)
    across = np.cross(outward, b - a)
    along = unit(across) if np.linalg.norm(across) > NO_COMPONENT * length else found.along
    return replace(found, along=along)


def strip_facing(part: PatchPart, domain: Domain, parts: Sequence[SurfacePart], spacing: float, key: str) -> Sample:
    """A strip on a round surface where it looks a given way: it runs along the direction in which that is straight."""
    toward = np.asarray(part.toward, float)
    facing = [p for p in parts if p.normal @ toward > 0.0]
    names = part.told
    if not facing:
        raise InputError(key, f"nothing of the surface {names} looks that way", "a direction out of the specimen")
    if not is_curved(facing):
        raise InputError(key, f"what of the surface {names} looks that way is flat", "at, along and width for a strip")
    spread = sum(p.area * np.outer(p.normal, p.normal) for p in facing)
    value, vector = np.linalg.eigh(np.asarray(spread))
    if value[0] > 1e-6 * value[2]:
        raise InputError(key, f"the surface {names} is not straight in any direction", "box, or point")
    straight = vector[:, 0]
    across = np.cross(straight, toward)
    if np.linalg.norm(across) < NO_COMPONENT:
        raise InputError(key, f"the surface {names} is straight that way", "a direction out of the specimen")
    across = unit(across)
    corners = np.concatenate([p.polygon for p in facing])
    middle = _middle(facing, across)
    tolerance = domain.on_surface
    width = float(np.ptp(corners @ across))
    if part.width > width + tolerance:
        raise InputError(
            f"{key.rpartition('.')[0]}.width",
            f"{part.width:g} m is more than the surface is wide",
            f"at most {width:g} m",
        )
    chosen = _between(facing, across, middle - 0.5 * part.width, middle + 0.5 * part.width, tolerance)
    if not chosen:
        problem = f"{part.width:g} m is no more than round-off"
        raise InputError(f"{key.rpartition('.')[0]}.width", problem, "the width of a platen")
    return over(chosen, across, spacing, key)


def _middle(facing: Sequence[SurfacePart], across: FloatArray) -> float:
    """Where on a round surface, measured across, the normal has no component across [m].

    In between two flat parts it changes as their middles do: on a regular polygon that is exact.
    """
    slope = np.array([p.normal @ across for p in facing])
    place = np.array([0.5 * ((p.polygon @ across).min() + (p.polygon @ across).max()) for p in facing])
    before, after = slope <= 0.0, slope >= 0.0
    if not before.any() or not after.any():
        return float(place[np.argmin(np.abs(slope))])
    a, b = float(slope[before].max()), float(slope[after].min())
    low, high = float(place[before][slope[before] == a].mean()), float(place[after][slope[after] == b].mean())
    return low if a == b else low - a * (high - low) / (b - a)


def in_box(part: PatchPart, domain: Domain, parts: Sequence[SurfacePart], spacing: float, key: str) -> Sample:
    """What of the surface lies in a box."""
    assert part.box is not None
    tolerance = domain.on_surface
    chosen = list(parts)
    for normal, offset in box_half_spaces(part.box.lower, part.box.upper):
        # A face in a side of the box is in it, however thin the box is.
        chosen = [
            left
            for p in chosen
            for left in ([p] if np.ptp(p.polygon @ normal) <= tolerance else _clipped([p], normal, offset, tolerance))
            if (left.polygon @ normal).min() <= offset + tolerance
        ]
    if not chosen:
        points = np.concatenate([p.polygon for p in parts])
        extent = f"from {as_text(points.min(axis=0))} to {as_text(points.max(axis=0))}"
        raise InputError(key, f"nothing of the surface {part.told} is in it", f"a box that meets the surface, {extent}")
    return over(chosen, along_of(part, chosen, key.rpartition(".")[0]), spacing, key)
