"""How far a notch reaches: the cells that it cuts, and those that get its rule of sides."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.specimen.convex import clipped
from fissura.specimen.limits import ON_SURFACE
from fissura.specimen.notches import Notch, Slot
from fissura.specimen.planes import Face, opposite, unit
from fissura.specimen.solid import Cell, Solid

#: Two cells, and a polygon (k, 3) in which they are open to each other.
Door: TypeAlias = tuple[tuple[int, int], FloatArray]


@dataclass(frozen=True)
class Plan:
    """What a notch will do to a solid.

    Attributes
    ----------
    notch : Notch
        The notch.
    mid : Face
        Its mid-plane.
    level : Face
        The level of its tip; the notch is behind it.
    cut : frozenset of int
        Cells that it cuts.
    ruled : frozenset of int
        Cells that get its rule of sides behind `level`.
    back : Face or None
        Where given, they get it in front of this plane only.
    """

    notch: Notch
    mid: Face
    level: Face
    cut: frozenset[int]
    ruled: frozenset[int]
    back: Face | None


def planned(solid: Solid, doors: Sequence[Door], slot: Slot) -> Plan:
    """Find out how far a notch reaches in a solid that has none yet.

    Parameters
    ----------
    solid : Solid
        The specimen before the first notch.
    doors : sequence of Door
        Where its cells are open to each other.
    slot : Slot
        The notch.

    Raises
    ------
    InputError
        It does not begin on the specimen, or cuts through it.
    """
    direction, along = unit(slot.direction), unit(slot.along)
    normal = unit(np.cross(direction, along))
    ahead = unit(np.cross(along, normal))
    ahead = ahead if ahead @ direction > 0.0 else unit(-ahead)
    tip = slot.at + slot.depth * direction
    mid, level = solid.planes.find(normal, float(normal @ tip)), solid.planes.find(ahead, float(ahead @ tip))
    behind = {k: part for k, cell in enumerate(solid.cells) if (part := solid.divided(cell, level)[0]) is not None}
    half = 0.5 * slot.width
    touched = {k for k, part in behind.items() if _touches(solid, part, mid, half)}
    half_space = (ahead, float(ahead @ tip))
    below = [
        (cells, p) for cells, polygon in doors if (p := clipped(polygon, *half_space, solid.tolerance)) is not None
    ]
    _check_room(solid, slot, direction)
    start = {k for k in touched if _holds(solid, solid.cells[k], slot.at + 0.5 * slot.depth * direction)}
    cut = _connected(start, [cells for cells, polygon in below if _crosses(solid, polygon, mid, half)], touched)
    if not cut:
        problem = f"{slot.depth:g} m does not reach into the specimen, or no farther than round-off"
        raise InputError(
            f"{slot.key}.depth", problem, "a larger depth; round surfaces are polygons, up to 0.1 l_f inside"
        )
    ruled, back = _ruled(solid, mid, level, behind, cut, below)
    front = _front(solid, cut, tip, along)
    axes = (solid.planes.normal(mid), tip, solid.planes.normal(level))
    notch = Notch(*axes, front, slot.depth, slot.width, slot.key, slot.place)
    return Plan(notch, mid, level, frozenset(cut), frozenset(ruled), back)


def heights(solid: Solid, points: FloatArray, face: Face) -> FloatArray:
    """Distances of points (k, 3) in front of a face, shape (k,)."""
    out: FloatArray = points @ solid.planes.normal(face) - solid.planes.offset(face)
    return out


def _touches(solid: Solid, cell: Cell, mid: Face, half: float) -> bool:
    """Whether a notch goes through a cell, or along one of its faces."""
    if half == 0.0 and (mid in cell.shape.faces or opposite(mid) in cell.shape.faces):
        return True
    h = heights(solid, cell.shape.corner.T, mid)
    return bool(h.min() < half - solid.tolerance and h.max() > solid.tolerance - half)


def _crosses(solid: Solid, polygon: FloatArray, mid: Face, half: float) -> bool:
    """Whether a notch goes on through a polygon in which two cells meet."""
    h = heights(solid, polygon, mid)
    if half > 0.0:
        return bool(h.min() < half - solid.tolerance and h.max() > solid.tolerance - half)
    if h.min() < -solid.tolerance and h.max() > solid.tolerance:
        return True
    on = polygon[np.abs(h) <= solid.tolerance]
    return bool(len(on) >= 2 and np.ptp(on, axis=0).max() > solid.tolerance)


def _connected(start: set[int], links: Iterable[tuple[int, int]], among: set[int]) -> set[int]:
    """Cells that links connect with those to start from."""
    near: dict[int, list[int]] = {k: [] for k in among}
    for a, b in links:
        if a in near and b in near:
            near[a].append(b)
            near[b].append(a)
    found, queue = set(start), list(start)
    while queue:
        for k in near[queue.pop()]:
            if k not in found:
                found.add(k)
                queue.append(k)
    return found


def _holds(solid: Solid, cell: Cell, point: FloatArray) -> bool:
    normal, offset = solid.planes.half_spaces(cell.shape.faces)
    return bool((normal @ point - offset).max() <= ON_SURFACE * solid.extent)


def _ruled(
    solid: Solid, mid: Face, level: Face, behind: dict[int, Cell], cut: set[int], below: Sequence[Door]
) -> tuple[set[int], Face | None]:
    """Cells that get the rule of a notch, and the plane behind which they do not.

    They are all that hang together with it behind the level of its tip. Where its plane meets more of the specimen
    there, only what lies in front of its mouth counts; where that is not enough, only the cells that it cuts.
    """
    found = _connected(cut, [cells for cells, _ in below], set(behind))
    if not any(_touches(solid, behind[k], mid, 0.0) for k in found - cut):
        return found, None
    normal = -solid.planes.normal(level)
    offset = max(float((normal @ _section(solid, behind[k], mid).T).max(initial=-np.inf)) for k in cut)
    back = solid.planes.find(normal, offset)
    near = {k: part for k, cell in behind.items() if (part := solid.divided(cell, back)[0]) is not None}
    links = [cells for cells, polygon in below if clipped(polygon, normal, offset, solid.tolerance) is not None]
    found = _connected(cut, links, set(near))
    if not any(_touches(solid, near[k], mid, 0.0) for k in found - cut):
        return found, opposite(back)
    return set(cut), None


def _section(solid: Solid, cell: Cell, mid: Face) -> FloatArray:
    """Points (k, 3) where edges of a cell meet a plane."""
    out = [np.empty((0, 3))]
    for polygon in cell.shape.polygons:
        h = heights(solid, polygon, mid)
        out.append(polygon[np.abs(h) <= solid.tolerance])
        after, h_after = np.roll(polygon, -1, axis=0), np.roll(h, -1)
        crossing = h * h_after < 0.0
        share = (h[crossing] / (h[crossing] - h_after[crossing]))[:, None]
        out.append(polygon[crossing] + share * (after[crossing] - polygon[crossing]))
    return np.concatenate(out)


def _spans(solid: Solid, cells: Iterable[Cell], point: FloatArray, direction: FloatArray) -> list[tuple[float, float]]:
    """Where a line is inside cells: intervals of its length, measured from a point [m]."""
    slack = ON_SURFACE * solid.extent
    out = []
    for cell in cells:
        normal, offset = solid.planes.half_spaces(cell.shape.faces)
        rate, gap = normal @ direction, offset - normal @ point
        level = np.abs(rate) < 1e-12
        if (gap[level] < -slack).any():
            continue
        low = (gap[rate < 0.0] / rate[rate < 0.0])[~level[rate < 0.0]].max(initial=-np.inf)
        high = (gap[rate > 0.0] / rate[rate > 0.0])[~level[rate > 0.0]].min(initial=np.inf)
        if high > low:
            out.append((float(low), float(high)))
    return sorted(out)


def _front(solid: Solid, cut: set[int], tip: FloatArray, along: FloatArray) -> FloatArray:
    """Ends of the front, shape (2, 3): where the cells that are cut begin and end on the line through the tip."""
    spans = _spans(solid, [solid.cells[k] for k in cut], tip, along)
    low, high = min((a for a, _ in spans), default=0.0), max((b for _, b in spans), default=0.0)
    return np.array([tip + low * along, tip + high * along])


def _check_room(solid: Solid, slot: Slot, direction: FloatArray) -> None:
    """The notch must begin on the surface of the specimen and end inside."""
    slack = ON_SURFACE * solid.extent
    room = 0.0
    for low, high in _spans(solid, solid.cells, slot.at, direction):
        if low > room + slack + (slot.slack if room == 0.0 else 0.0):
            break
        room = max(room, high)
    if room <= slack:
        problem, allowed = "the notch is not in the specimen", "a place on its surface, and a direction inwards"
        raise InputError(f"{slot.key}.{slot.place}", problem, allowed)
    if slot.depth >= room - slack:
        problem = f"{slot.depth:g} m cuts through the specimen"
        raise InputError(f"{slot.key}.depth", problem, f"less than {room:g} m, the specimen's size there")
