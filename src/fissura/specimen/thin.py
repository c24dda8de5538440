"""Parts of a specimen that are thin against the size of its bodies, and forces at its edges.

Bodies are rigid and act on each other at one point of each facet, so that a facet that spans a part alone is a hinge.
Two bodies across a part leave its bending 12 % too soft and its twist 25 %, three 4 % and 12 %; a ligament of one body
has a third of its stiffness (docs/verification.md, benchmarks/thin_parts.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from fissura.errors import InputError, Notice
from fissura.specimen.notch import AXES, FACES

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.case import Patch as PatchPart
    from fissura.specimen.box import Box

__all__ = ["LEAST", "USUAL", "Thickness", "edge_notices", "thin_notices", "thin_parts"]

#: Thickness of a part in spacings below which it is refused, and below which it is warned of.
LEAST, USUAL = 1.0, 3.0

#: Thickness in spacings below which some facets span a part alone.
SINGLE = 1.5

_ROUND_OFF = 1e-9


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


def thin_parts(box: Box) -> list[Thickness]:
    """Thickness of the specimen, of what notches leave of it, and between notches."""
    parts = [Thickness("specimen.size", f"the specimen in {'xyz'[axis]}", box.size[axis]) for axis in range(3)]
    keys = ["notch"] if len(box.notches) == 1 else [f"notch[{k}]" for k in range(len(box.notches))]
    for key, notch in zip(keys, box.notches, strict=True):
        low, high = notch.bounds
        end = min(low[notch.normal], box.size[notch.normal] - high[notch.normal])
        ligament = box.size[notch.axis] - notch.depth
        parts.append(Thickness(f"{key}.depth", "the ligament", ligament))
        parts.append(Thickness(f"{key}.position", "what is left between notch and end of the specimen", float(end)))
    for (first, one), (second, other) in combinations(zip(keys, box.notches, strict=True), 2):
        (low, high), (lowest, highest) = one.bounds, other.bounds
        gaps = np.maximum(np.maximum(low - highest, lowest - high), 0.0)
        facing = gaps[other.normal] == 0.0
        name = f"what is left between it and {first}"
        parts.append(Thickness(f"{second}.{'depth' if facing else 'position'}", name, float(np.linalg.norm(gaps))))
    return parts


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
    for part in sorted(parts, key=lambda part: part.value):
        thinnest.setdefault(part.key, part)
        largest = part.value
    if largest < l_f:
        raise InputError("discretization.l_f", f"{l_f:g} m is larger than the specimen", f"less than {largest:g} m")
    found = []
    for part in thinnest.values():
        thick = f"{part.name} is {1e3 * part.value:.4g} mm thick, "
        if part.value < LEAST * l_f * (1.0 - _ROUND_OFF):
            raise InputError(
                part.key,
                f"{thick}less than one body, l_f = {1e3 * l_f:.4g} mm",
                f"at least l_f, better {USUAL:g} l_f, or a smaller discretization.l_f",
            )
        if part.value < USUAL * l_f * (1.0 - _ROUND_OFF):
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


def edge_notices(case: Case, box: Box) -> Iterator[Notice]:
    """Supports and loads less than one body from an edge of their face, or from a notch.

    Their forces go into bodies at the edge, which have few neighbours, and may tear these out alone. Gauges exert no
    forces, and whole faces have no edges beside them.
    """
    l_f = case.discretization.l_f
    named: list[tuple[str, PatchPart]] = [(f"supports[{k}]", part) for k, part in enumerate(case.supports)]
    for key, part in [*named, ("load", case.load)]:
        distance = _distance(part, box)
        if distance < l_f * (1.0 - _ROUND_OFF):
            yield Notice(
                f"{key}.{'at' if part.point is None else 'point'}",
                f"its middle is {1e3 * distance:.3g} mm from an edge, less than one body, l_f = {1e3 * l_f:.4g} mm:"
                " its force may tear out bodies at the edge",
                "a place farther inside, or material.elastic there",
            )


def _distance(part: PatchPart, box: Box) -> float:
    """Distance of the middle of a place from edges of its face and mouths of notches [m]; infinite for a whole face."""
    axis, side = FACES[part.face]
    if part.point is not None:
        place = {a: part.point[a] for a in range(3) if a != axis}
    elif part.at is not None:
        place = {AXES[part.along]: part.at}
    else:
        return np.inf
    nearest = min(min(value, box.size[a] - value) for a, value in place.items())
    for notch in box.notches:
        if (notch.axis, notch.side) == (axis, side) and notch.normal in place:
            nearest = min(nearest, abs(place[notch.normal] - notch.position) - 0.5 * notch.width)
    return max(nearest, 0.0)
