"""Notches of a case: where they begin on a specimen, and where they go."""

from collections.abc import Sequence

import numpy as np

from fissura.case import Notch as NotchPart
from fissura.errors import InputError
from fissura.specimen.domain import Domain
from fissura.specimen.limits import NO_COMPONENT
from fissura.specimen.notches import Slot
from fissura.specimen.shapes.prism import AXES
from fissura.specimen.surface import as_text, distances, is_curved, mean_normal, slack_of, surface_parts
from fissura.specimen.surface_part import SurfacePart
from fissura.specimen.traces import traces_at


def slot_from_part(part: NotchPart, domain: Domain, l_f: float, key: str) -> Slot:
    """Find where a notch begins and where it goes.

    Parameters
    ----------
    part : Notch part of the case
        A face and a position on it, or a point of any surface.
    domain : Domain
        The specimen without notches.
    l_f : float
        Spacing of fine nuclei, to which round surfaces are approximated [m].
    key : str
        Where the part stands in the case file.

    Raises
    ------
    InputError
        An unknown surface, a place that is not on it, a direction that does not lead into the specimen.
    """
    parts = surface_parts(domain, [part.surface], f"{key}.{part.naming}")
    if part.at is None:
        return _across(part, domain, parts, key)
    return _anywhere(part, domain, parts, l_f, key)


def _across(part: NotchPart, domain: Domain, parts: Sequence[SurfacePart], key: str) -> Slot:
    """A notch straight across a flat face, perpendicular to an axis."""
    assert part.position is not None
    assert part.normal is not None
    outward = mean_normal(parts)
    face = int(np.argmax(np.abs(outward)))
    if is_curved(parts) or abs(outward[face]) < 1.0 - NO_COMPONENT:
        raise InputError(
            f"{key}.{part.naming}",
            f"{part.surface!r} is not flat and perpendicular to an axis",
            "such a face with position and normal, or any surface with at, direction and along",
        )
    normal = AXES[part.normal]
    if normal == face:
        raise InputError(
            f"{key}.normal", f"'{part.normal}' is perpendicular to the face {part.surface!r}", "another axis"
        )
    points = np.concatenate([p.polygon for p in parts])
    least, most = float(points[:, normal].min()), float(points[:, normal].max())
    low, high = part.position - 0.5 * part.width, part.position + 0.5 * part.width
    if not least < low <= high < most:
        raise InputError(
            f"{key}.position",
            f"a notch from {low:g} to {high:g} m is not inside the face {part.surface!r}",
            f"between {least:g} and {most:g} m",
        )
    traces = traces_at(parts, normal, part.position, domain.on_surface)
    if not traces:
        problem = f"the face {part.surface!r} has no place at {part.position:g} m along {part.normal}"
        raise InputError(f"{key}.position", problem, "a place on the face")
    longest = max(traces, key=lambda trace: trace.length)
    through = 3 - face - normal
    at = 0.5 * (longest.start + longest.end)
    direction = -np.eye(3)[face] * np.sign(outward[face])
    return Slot(at, direction, np.eye(3)[through], part.depth, part.width, key=key, place="position")


def _anywhere(part: NotchPart, domain: Domain, parts: Sequence[SurfacePart], l_f: float, key: str) -> Slot:
    """A notch from a point of a surface."""
    at = np.asarray(part.at, float)
    distance, nearest = distances(parts, at)
    slack = slack_of(domain, parts, l_f)
    best = int(np.argmin(distance))
    if distance[best] > slack:
        raise InputError(
            f"{key}.at",
            f"{as_text(at)} is not on the surface {part.surface!r}",
            f"a point of it; the nearest is {as_text(nearest[best])}",
        )
    # Between two flat parts of a round surface the notch goes in between their normals.
    beside = [p for p, d in zip(parts, distance, strict=True) if d <= distance[best] + 1e-3 * slack]
    outward = np.mean([p.normal for p in beside], axis=0)
    outward /= np.linalg.norm(outward)
    direction = -outward if part.direction is None else np.asarray(part.direction, float)
    if direction @ outward >= -NO_COMPONENT:
        raise InputError(
            f"{key}.direction",
            f"[{', '.join(f'{v:.4g}' for v in direction)}] does not lead into the specimen",
            f"a direction against the surface's normal [{', '.join(f'{v + 0.0:.4g}' for v in outward)}]",
        )
    along = np.array([0.0, 0.0, 1.0]) if part.along is None else np.asarray(part.along, float)
    if np.linalg.norm(np.cross(direction, along)) < NO_COMPONENT:
        problem = "missing" if part.along is None else "is the direction in which the notch is deep"
        raise InputError(f"{key}.along", problem, "three numbers, the direction of the front across the notch's depth")
    return Slot(at, direction, along, part.depth, part.width, slack, key, "at")
