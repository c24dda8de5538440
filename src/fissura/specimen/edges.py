"""Forces near edges of faces and mouths of notches, which may tear out single bodies."""

from collections.abc import Iterator, Sequence

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.case import Patch as PatchPart
from fissura.errors import Notice
from fissura.specimen.domain import Domain
from fissura.specimen.limits import FACING, ROUND_OFF
from fissura.specimen.notches import SURFACE
from fissura.specimen.place import place_from_part
from fissura.specimen.surface import distances


def edge_notices(case: Case, domain: Domain) -> Iterator[Notice]:
    """Supports and loads less than one body from an edge of their face, or from a notch.

    Their forces go into bodies at the edge, which have few neighbours, and may tear these out alone. Gauges exert no
    forces, and whole faces have no edges beside them.
    """
    l_f = case.discretization.l_f
    named: list[tuple[str, PatchPart]] = [(f"supports[{k}]", part) for k, part in enumerate(case.supports)]
    named += [(load.key, load.part) for load in case.named_loads]
    for key, part in named:
        distance = _distance(part, domain, l_f, key)
        if distance < l_f * (1.0 - ROUND_OFF):
            yield Notice(
                f"{key}.{'at' if part.point is None else 'point'}",
                f"its middle is {1e3 * distance:.3g} mm from an edge, less than one body, l_f = {1e3 * l_f:.4g} mm:"
                " its force may tear out bodies at the edge",
                "a place farther inside, or material.elastic there",
            )


def _distance(part: PatchPart, domain: Domain, l_f: float, key: str) -> float:
    """Distance of the middle of a place from edges of its face and mouths of notches [m]; infinite for a whole face."""
    if part.point is None and part.at is None:
        return np.inf
    place = place_from_part(part, domain, l_f, key)
    nearest = int(np.argmin(np.linalg.norm(place.points - place.centroid, axis=1)))
    x, normal = place.points[nearest], place.normals[nearest]
    if part.at is not None:  # the middle of a strip, whose points lie beside it
        axis = int(np.argmax(np.abs(place.along)))
        x = x.copy()
        x[axis] = part.at
    along: FloatArray = place.along - (place.along @ normal) * normal
    if np.linalg.norm(along) < 1e-6:
        return np.inf
    along /= np.linalg.norm(along)
    ways = [along, -along]
    if part.point is not None:
        across = np.cross(normal, along)
        ways += [across, -across]
    return min(_reach(domain, part.surfaces, x, normal, way) for way in ways)


def _reach(domain: Domain, names: Sequence[str], x: FloatArray, normal: FloatArray, way: FloatArray) -> float:
    """How far flat ground goes on from a point of a surface [m]."""
    tolerance = domain.on_surface
    spans = []
    for part in domain.faces(*names):
        if part.normal @ normal < 1.0 - ROUND_OFF or abs((x - part.polygon[0]) @ normal) > tolerance:
            continue
        outwards = np.cross(np.roll(part.polygon, -1, axis=0) - part.polygon, part.normal)
        rate, gap = outwards @ way, np.einsum("ka,ka->k", outwards, part.polygon - x)
        size = np.linalg.norm(outwards, axis=1)
        level = np.abs(rate) <= 1e-9 * size
        if (gap[level] < -tolerance * size[level]).any():
            continue
        low = (gap[(rate < 0.0) & ~level] / rate[(rate < 0.0) & ~level]).max(initial=-np.inf)
        high = (gap[(rate > 0.0) & ~level] / rate[(rate > 0.0) & ~level]).min(initial=np.inf)
        if high > low:
            spans.append((float(low), float(high)))
    reach = 0.0
    for low, high in sorted(spans):
        if low <= reach + tolerance:
            reach = max(reach, high)
    for notch in domain.notches:
        slope = float(notch.normal @ way)
        if notch.width > 0.0 or abs(slope) <= 1e-9:
            continue
        t = -float(notch.across(x)) / slope
        there = x + t * way
        if 0.0 <= t < reach and notch.ahead(there) <= tolerance:
            walls = [p for p in domain.faces(SURFACE) if abs(p.normal @ notch.normal) > FACING]
            if distances(walls, there)[0].min() <= tolerance:
                reach = t
    return reach
