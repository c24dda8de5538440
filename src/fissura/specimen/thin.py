"""Parts of a specimen that are thin against the size of its bodies.

Bodies are rigid and act on each other at one point of each facet, so that a facet that spans a part alone is a hinge.
Two bodies across a part leave its bending 12 % too soft and its twist 25 %, three 4 % and 12 %; a ligament of one body
has a third of its stiffness (docs/verification.md, benchmarks/thin_parts.py).
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.errors import InputError, Notice
from fissura.specimen.domain import Domain
from fissura.specimen.limits import FACING, LEAST, ROUND_OFF, SINGLE, USUAL
from fissura.specimen.notches import SURFACE, Notch
from fissura.specimen.rays import distance_to_surface
from fissura.specimen.surface import distances
from fissura.specimen.surface_part import SurfacePart


@dataclass(frozen=True)
class Thickness:
    """How thick a part of the specimen is.

    Attributes
    ----------
    key : str
        Key of the case that decides it.
    name : str
        What is that thick.
    value : float
        Thickness [m].
    """

    key: str
    name: str
    value: float


def thin_parts(case: Case, domain: Domain) -> list[Thickness]:
    """Thickness of the specimen, of what notches leave of it, and between notches.

    A part has a thickness where a ray that goes into it straight from a surface leaves through one that is almost
    parallel: the edge of a wedge is thin, but no part.

    Parameters
    ----------
    case : Case
        Whose keys are named.
    domain : Domain
        Its specimen.
    """
    found: dict[tuple[str, str], float] = {}

    def note(key: str, name: str, value: float) -> None:
        found[key, name] = min(value, found.get((key, name), np.inf))

    keys = _keys_of_surfaces(case, domain)
    c = domain.complex
    parts = domain.faces()
    points = np.concatenate([_inner_points(part.polygon) for part in parts])
    owner = np.repeat(np.arange(len(parts)), [len(part.polygon) + 1 for part in parts])
    inwards, cell = np.array([-part.normal for part in parts])[owner], np.array([part.cell for part in parts])[owner]
    distance, end = distance_to_surface(c, points, inwards, cell)
    plane = np.searchsorted(c.part_start, end, side="right") - 1
    facing = np.einsum("ia,ia->i", inwards, c.normal[plane]) > FACING
    name_of = {part: domain.surfaces[-1 - c.part_to[part]] for part in set(end.tolist())}
    start_name = [domain.surfaces[number] for number in domain.surface_numbers]
    for i in np.flatnonzero(facing):
        here, there = start_name[owner[i]], name_of[int(end[i])]
        notches = [
            notch
            for name, x, normal in (
                (here, points[i], inwards[i]),
                (there, points[i] + distance[i] * inwards[i], inwards[i]),
            )
            if name == SURFACE and (notch := _notch_at(domain, x, normal)) is not None
        ]
        if len(notches) == 2 and notches[0] is notches[1]:
            continue
        if len(notches) == 2:
            first, second = sorted(notches, key=lambda notch: domain.notches.index(notch))
            note(_key(second, inwards[i]), f"what is left between it and {first.key}", float(distance[i]))
        elif notches and abs(inwards[i] @ notches[0].direction) > FACING:
            note(f"{notches[0].key}.depth", "the ligament", float(distance[i]))
        elif notches:
            other = there if here == SURFACE else here
            name = f"what is left between notch and {other!r}"
            note(f"{notches[0].key}.{notches[0].place}", name, float(distance[i]))
        else:
            key = keys.get(here) or keys.get(there) or keys[""]
            note(key, f"the specimen between {min(here, there)!r} and {max(here, there)!r}", float(distance[i]))
    _note_ligaments(domain, note)
    return [Thickness(key, name, value) for (key, name), value in found.items()]


def _keys_of_surfaces(case: Case, domain: Domain) -> dict[str, str]:
    """Key of the case for what voids leave, by its name; that of the shape under the empty name."""
    many = len(case.minus) > 1
    out = {void.name: f"minus[{k}]" if many else "minus" for k, void in enumerate(case.minus)}
    return out | {"": case.specimen.key}


def _inner_points(polygon: FloatArray) -> FloatArray:
    """The middle of a polygon, and points near its corners; shape (k + 1, 3)."""
    middle = polygon.mean(axis=0)
    return np.concatenate([[middle], middle + 0.98 * (polygon - middle)])


def _key(notch: Notch, direction: FloatArray) -> str:
    """Key that decides how far a notch is from what lies in a direction of it."""
    facing = abs(direction @ notch.direction) > abs(direction @ notch.normal)
    return f"{notch.key}.{'depth' if facing else notch.place}"


def _notch_at(domain: Domain, x: FloatArray, normal: FloatArray) -> Notch | None:
    """The notch to whose surface a point belongs, by the normal there."""
    tolerance = domain.on_surface
    for notch in domain.notches:
        across, ahead = abs(notch.across(x)), notch.ahead(x)
        wall = abs(normal @ notch.normal) > FACING and abs(across - 0.5 * notch.width) <= tolerance
        root = abs(normal @ notch.direction) > FACING and abs(ahead) <= tolerance
        if (wall and ahead <= tolerance) or (root and across <= 0.5 * notch.width + tolerance):
            return notch
    return None


def _note_ligaments(domain: Domain, note: Callable[[str, str, float], None]) -> None:
    """What lies ahead of the tips of notches, and between tips and other notches."""
    c = domain.complex
    tolerance = domain.on_surface
    share = np.array([0.02, 0.25, 0.5, 0.75, 0.98])[:, None]
    walls = [
        [p for p in domain.faces(SURFACE) if _notch_at(domain, p.polygon.mean(axis=0), p.normal) is notch]
        for notch in domain.notches
    ]
    for k, notch in enumerate(domain.notches):
        front = notch.front[0] + share * (notch.front[1] - notch.front[0])
        cell = domain.cell_of(front + tolerance * notch.direction)
        inside = cell >= 0
        ahead = np.tile(notch.direction, (int(inside.sum()), 1))
        distance, end = distance_to_surface(c, front[inside], ahead, cell[inside])
        for x, value, part in zip(front[inside], distance, end, strict=True):
            there = domain.surfaces[-1 - c.part_to[part]]
            if there != SURFACE or _notch_at(domain, x + value * notch.direction, notch.direction) is None:
                note(f"{notch.key}.depth", "the ligament", float(value))
        for m, other in enumerate(domain.notches):
            if m == k or not walls[m] or _meet(walls[k], walls[m], tolerance):
                continue  # notches that cross leave nothing between them
            later, first = (notch, other) if k > m else (other, notch)
            for x in front:
                gap, nearest = distances(walls[m], x)
                best = int(np.argmin(gap))
                note(_key(later, nearest[best] - x), f"what is left between it and {first.key}", float(gap[best]))


def _meet(first: Sequence[SurfacePart], second: Sequence[SurfacePart], tolerance: float) -> bool:
    """Whether walls touch walls."""
    corners = np.concatenate([part.polygon for part in first])
    return any(bool(distances(second, x)[0].min() <= tolerance) for x in corners)


def thin_notices(parts: Iterable[Thickness], l_f: float) -> list[Notice]:
    """What to say about thin parts.

    Parameters
    ----------
    parts : iterable of Thickness
        Parts of a specimen.
    l_f : float
        Spacing of its fine nuclei [m].

    Returns
    -------
    list of Notice
        One for each key that leaves a part thinner than three bodies, about the thinnest.

    Raises
    ------
    InputError
        A part is thinner than one body.
    """
    thinnest: dict[str, Thickness] = {}
    largest = math.inf  # without surfaces that face each other there is no part
    for part in sorted(parts, key=lambda part: part.value):
        thinnest.setdefault(part.key, part)
        largest = part.value
    if largest < l_f:
        raise InputError("discretization.l_f", f"{l_f:g} m is larger than the specimen", f"less than {largest:g} m")
    found = []
    for part in thinnest.values():
        thick = f"{part.name} is {1e3 * part.value:.4g} mm thick, "
        if part.value < LEAST * l_f * (1.0 - ROUND_OFF):
            raise InputError(
                part.key,
                f"{thick}less than one body, l_f = {1e3 * l_f:.4g} mm",
                f"at least l_f, better {USUAL:g} l_f, or a smaller discretization.l_f",
            )
        if part.value < USUAL * l_f * (1.0 - ROUND_OFF):
            found.append(
                Notice(
                    part.key,
                    f"{thick}{part.value / l_f:.2g} l_f: {_too_few(part.value / l_f)}",
                    f"discretization.l_f of at most {1e3 * part.value / USUAL:.3g} mm",
                )
            )
    return found


def _too_few(spacings: float) -> str:
    """What is wrong with so few bodies across a part."""
    if spacings < SINGLE:
        return "single facets may span it, which are hinges, so that it has little or no stiffness in bending and twist"
    return "so few bodies across it leave it too soft, by up to a half in twist and at notches"
