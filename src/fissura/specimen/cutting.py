"""Cutting notches: closed faces or removed volume, and the sides on which bodies stay below their tips.

A notch is the part of its plane behind the tip that hangs together with its mouth. Behind the level of the tip, a
plane through the front across the notch, a nucleus may own material on its own side of the notch only; ahead of it
nothing changes.
"""

from collections.abc import Sequence
from dataclasses import replace

from fissura.errors import InputError
from fissura.specimen.assemble import parts_of
from fissura.specimen.notches import SURFACE, Notch, Slot
from fissura.specimen.planes import Face, opposite
from fissura.specimen.reach import Plan, heights, planned
from fissura.specimen.solid import Cell, Solid


def cut_notches(solid: Solid, slots: Sequence[Slot]) -> tuple[Notch, ...]:
    """Cut notches into a solid.

    How far each of them reaches is decided before the first is cut, so that notches may cross.

    Raises
    ------
    InputError
        A notch that is not in the specimen, or cuts through it.
    """
    if not slots:
        return ()
    solid.number()
    doors = [
        ((k, part.to), part.polygon)
        for k, cell in enumerate(parts_of(solid))
        for face in cell
        for part in face
        if not isinstance(part.to, str) and k < part.to
    ]
    plans = [planned(solid, doors, slot) for slot in slots]
    if SURFACE not in solid.surfaces:
        solid.surfaces.append(SURFACE)
    for plan, slot in zip(plans, slots, strict=True):
        if not _cut(solid, plan):
            raise InputError(
                f"{slot.key}.{slot.place}", "the notch lies inside another one", "notches apart, or one less"
            )
    return tuple(plan.notch for plan in plans)


def _cut(solid: Solid, plan: Plan) -> bool:
    """Divide, close or remove what a notch reaches, and give rules of sides to what lies behind its tip.

    Returns whether anything was closed or removed.
    """
    half = 0.5 * plan.notch.width
    normal, offset = solid.planes.normal(plan.mid), solid.planes.offset(plan.mid)
    walls = [(solid.planes.find(normal, offset + half), SURFACE), (solid.planes.find(-normal, half - offset), SURFACE)]
    if half > 0.0:
        for face in (plan.level, *(wall for wall, _ in walls)):
            solid.walls.setdefault(opposite(face), SURFACE)
    out: list[Cell] = []
    changed = False
    for cell in solid.cells:
        if cell.origin not in plan.ruled:
            out.append(cell)
            continue
        behind, ahead = solid.divided(cell, plan.level)
        if plan.back is not None and behind is not None:
            beyond, behind = solid.divided(behind, plan.back)
            out += [] if beyond is None else [beyond]
        if ahead is not None:
            out.append(ahead.named(opposite(plan.level), SURFACE) if half > 0.0 else ahead)
        if behind is None:
            continue
        if cell.origin not in plan.cut:
            parts = [behind]
        elif half == 0.0:
            halves = [part for part in solid.divided(behind, plan.mid) if part is not None]
            parts = [_closed(part, plan.mid) for part in halves]
            changed |= any(a.closed != b.closed for a, b in zip(halves, parts, strict=True))
        else:
            parts, removed = solid.without(behind, walls)
            changed |= removed
        out += [_ruled_by(solid, part, plan.mid) for part in parts]
    solid.cells = out
    return changed


def _closed(cell: Cell, mid: Face) -> Cell:
    """The same with its faces in the plane of a cut closed."""
    for face in (mid, opposite(mid)):
        if face in cell.shape.faces:
            cell = replace(cell.named(face, SURFACE), closed=cell.closed | {face})
    return cell


def _ruled_by(solid: Solid, cell: Cell, mid: Face) -> Cell:
    """The same with a rule to lie on its own side of a notch."""
    h = heights(solid, cell.shape.corner.T, mid)
    rule = mid if h.max() + h.min() > 0.0 else opposite(mid)
    return cell if rule in cell.rules else replace(cell, rules=(*cell.rules, rule))
