"""From cells to a complex: how the faces in each plane meet, and all of it in arrays."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fissura.arrays import FloatArray, IntArray
from fissura.specimen.complex import Complex
from fissura.specimen.planar import Flat, Lines, Piece
from fissura.specimen.planes import Face
from fissura.specimen.solid import Solid

#: Surface of whatever has no name.
UNNAMED = "surface"


@dataclass(frozen=True, eq=False)
class Part:
    """A convex part of a face.

    Attributes
    ----------
    to : int or str
        The cell to which it is open, or the surface to which it belongs.
    polygon : (k, 3) array
        Its corners, counterclockwise from outside of the cell [m].
    edges : tuple of (normal, offset)
        Where ``normal @ x <= offset`` for all of them; the edges of the whole face are left out.
    """

    to: int | str
    polygon: FloatArray
    edges: tuple[tuple[FloatArray, float], ...] = ()


@dataclass(frozen=True, eq=False)
class _Sheet:
    """A face of a cell, as one of those in a plane."""

    cell: int
    place: int
    face: Face
    polygon: FloatArray
    name: str
    closed: bool


def parts_of(solid: Solid) -> list[list[list[Part]]]:
    """Parts of every face of every cell."""
    planes: dict[int, tuple[list[_Sheet], list[_Sheet]]] = defaultdict(lambda: ([], []))
    out: list[list[list[Part]]] = []
    for k, cell in enumerate(solid.cells):
        polygons = cell.shape.polygons
        out.append([[] for _ in polygons])
        for f, face in enumerate(cell.shape.faces):
            name = cell.names.get(face) or solid.walls.get(face) or UNNAMED
            sheet = _Sheet(k, f, face, polygons[f], name, face in cell.closed)
            planes[face[0]][0 if face[1] > 0 else 1].append(sheet)
    for plane, (plus, minus) in planes.items():
        whole = not any((plane, sign) in solid.regions for sign in (1, -1))
        if whole and plus and minus:
            plus, minus = _unmatched(plus, minus, solid.tolerance, out)
        if (plus and minus) or not whole:
            _overlay(solid, plane, plus, minus, out)
            continue
        for sheet in (*plus, *minus):
            out[sheet.cell][sheet.place] = [Part(sheet.name, sheet.polygon)]
    return out


def _unmatched(
    plus: list[_Sheet], minus: list[_Sheet], tolerance: float, out: list[list[list[Part]]]
) -> tuple[list[_Sheet], list[_Sheet]]:
    """Join faces that are the same polygon from either side; return the others."""
    if len(plus) == len(minus) == 1:
        nearest = [0]
    else:
        bounds = [np.array([[*s.polygon.min(axis=0), *s.polygon.max(axis=0)] for s in side]) for side in (plus, minus)]
        _, found = cKDTree(bounds[1]).query(bounds[0], p=np.inf)
        nearest = np.asarray(found).tolist()
    rest, taken = [], set()
    for sheet, k in zip(plus, nearest, strict=True):
        if k not in taken and _same(sheet.polygon, minus[k].polygon, tolerance):
            _pair(sheet, minus[k], out)
            taken.add(k)
        else:
            rest.append(sheet)
    return rest, [sheet for k, sheet in enumerate(minus) if k not in taken]


def _same(a: FloatArray, b: FloatArray, tolerance: float) -> bool:
    """Whether two convex polygons in one plane have the same corners."""
    apart = np.abs(a[:, None] - b).max(axis=2)
    return bool(apart.min(axis=1).max() <= tolerance and apart.min(axis=0).max() <= tolerance)


def _pair(a: _Sheet, b: _Sheet, out: list[list[list[Part]]]) -> None:
    """Two faces that are open to each other, all of them, unless they are closed."""
    closed = a.closed or b.closed
    out[a.cell][a.place] = [Part(a.name if closed else b.cell, a.polygon)]
    out[b.cell][b.place] = [Part(b.name if closed else a.cell, b.polygon)]


def _overlay(solid: Solid, plane: int, plus: list[_Sheet], minus: list[_Sheet], out: list[list[list[Part]]]) -> None:
    """Divide the faces in one plane by each other and by named regions.

    Lines have identities like planes, so that the edges of parts are the same on both sides, bit for bit. A face is
    open where it meets one of the other side, unless either is closed.
    """
    sheets = (*plus, *minus)
    regions = [solid.regions.get((plane, sign), []) for sign in (1, -1)]
    outlines = [sheet.polygon for sheet in sheets] + [corners for corners, _ in (*regions[0], *regions[1])]
    flat = Flat.of(solid.planes.normal((plane, 1)), np.concatenate(outlines))
    lines = Lines(solid.tolerance)
    pieces = iter(lines.pieces([flat.inside(outline) for outline in outlines]))
    plus_pieces, minus_pieces = ([(sheet, next(pieces)) for sheet in side] for side in (plus, minus))
    named = [[(next(pieces), name) for _, name in side] for side in regions]
    for mine, theirs, sign, own in (
        (plus_pieces, minus_pieces, 1, named[0]),
        (minus_pieces, plus_pieces, -1, named[1]),
    ):
        bounds = np.array([piece.bounds for _, piece in theirs]).reshape(-1, 4)
        for sheet, whole in mine:
            out[sheet.cell][sheet.place] = [
                Part(to, flat.outside(piece.corners[::sign]), tuple(_edge(flat, lines, e) for e in edges))
                for to, piece, edges in _divided(sheet, whole, theirs, bounds, own, lines)
            ]


def _edge(flat: Flat, lines: Lines, edge: tuple[int, int]) -> tuple[FloatArray, float]:
    """A half-space of space that a line bounds in its plane."""
    normal, offset = flat.half_space(*lines.line(edge[0]))
    return edge[1] * normal, edge[1] * offset


def _divided(
    sheet: _Sheet,
    whole: Piece,
    theirs: Sequence[tuple[_Sheet, Piece]],
    bounds: FloatArray,
    regions: Sequence[tuple[Piece, str]],
    lines: Lines,
) -> list[tuple[int | str, Piece, tuple[tuple[int, int], ...]]]:
    """Parts of a face: where each leads, its polygon, and the lines that part it from the others."""
    found: list[tuple[int | str, Piece]] = []
    bare = [whole]
    for k in whole.among(bounds, lines.tolerance):
        other, there = theirs[k]
        inside, bare = lines.divided(bare, there)
        if inside:
            # All of the overlap at once: `bare` may have been divided by others already, from this side only.
            both = lines.common(whole, there)
            if both is not None:
                found.append((sheet.name if sheet.closed or other.closed else other.cell, both))
    for region, name in regions:
        inside, bare = lines.divided(bare, region)
        found += [(name, piece) for piece in inside]
    found += [(sheet.name, piece) for piece in bare]
    if len({to for to, _ in found}) == 1 and isinstance(found[0][0], str):
        return [(found[0][0], whole, ())]
    own = {line for line, _ in whole.edges}
    return [(to, piece, tuple(e for e in piece.edges if e[0] not in own)) for to, piece in found]


def complex_of(solid: Solid) -> tuple[Complex, tuple[str, ...]]:
    """The complex of a solid, and the names of its surfaces."""
    parts = parts_of(solid)
    used = {part.to for cell in parts for face in cell for part in face if isinstance(part.to, str)}
    surfaces = [name for name in solid.surfaces if name in used]
    surfaces += sorted(used.difference(surfaces))
    number = {name: k for k, name in enumerate(surfaces)}
    shapes = [cell.shape for cell in solid.cells]
    half_spaces = [solid.planes.half_spaces(shape.faces) for shape in shapes]
    faces = [face for cell in parts for face in cell]
    flat = [part for face in faces for part in face]
    edges = [edge for part in flat for edge in part.edges]
    rules = [rule for cell in solid.cells for rule in cell.rules]
    rule_normal, rule_offset = solid.planes.half_spaces(tuple(rules))
    low = np.array([shape.corner.min(axis=1) for shape in shapes])
    high = np.array([shape.corner.max(axis=1) for shape in shapes])
    built = Complex(
        corner_start=_starts([shape.corner.shape[1] for shape in shapes]),
        corner=np.concatenate([shape.corner for shape in shapes], axis=1),
        twin=np.concatenate([shape.twin for shape in shapes]),
        face=np.concatenate([shape.face for shape in shapes]),
        plane_start=_starts([len(shape.faces) for shape in shapes]),
        normal=np.concatenate([normal for normal, _ in half_spaces]),
        offset=np.concatenate([offset for _, offset in half_spaces]),
        plane_id=np.array([face[0] for shape in shapes for face in shape.faces], dtype=np.int64),
        opens=np.array([any(not isinstance(part.to, str) for part in face) for face in faces]),
        part_start=_starts([len(face) for face in faces]),
        part_to=np.array([-1 - number[p.to] if isinstance(p.to, str) else p.to for p in flat], dtype=np.int64),
        edge_start=_starts([len(part.edges) for part in flat]),
        edge_normal=np.array([normal for normal, _ in edges], dtype=float).reshape(-1, 3),
        edge_offset=np.array([offset for _, offset in edges], dtype=float),
        rule_start=_starts([len(cell.rules) for cell in solid.cells]),
        rule_normal=np.ascontiguousarray(rule_normal),
        rule_offset=np.ascontiguousarray(rule_offset),
        low=low,
        high=high,
        extent=float((high.max(axis=0) - low.min(axis=0)).max()),
    )
    return built, tuple(surfaces)


def _starts(counts: Sequence[int]) -> IntArray:
    return np.concatenate([[0], np.cumsum(np.asarray(counts, dtype=np.int64))]).astype(np.int64)
