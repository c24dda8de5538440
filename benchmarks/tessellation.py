"""Placement, selection and tessellation up to 100 000 bodies, of other shapes, and again after a small change.

Cubes at full resolution with 10 mm between nuclei; only their size changes from row to row. Cells are compared with
those of other codes on identical nuclei: Qhull (scipy), nuclei near the surface being reflected in it, and Voro++
(multivoro) where it is installed; it may be, by `pip install multivoro`, but nothing else needs it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from itertools import chain
from typing import Any

import numpy as np
from scipy.spatial import Voronoi

from common import Check, Report, cpu_time, main, options, say, table
from fissura.case.shape import Corner
from fissura.specimen import Domain, Solid
from fissura.specimen.assemble import complex_of
from fissura.specimen.cutting import cut_notches
from fissura.specimen.notches import Slot
from fissura.specimen.shapes.outline import extruded
from fissura.specimen.shapes.prism import box, cylinder
from fissura.tessellation import Nuclei, Tessellation, clipped, discretize, select, voronoi
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.voronoi import voronoi_cells

try:
    from multivoro import compute_voronoi
except ImportError:
    compute_voronoi = None

#: Edges of cubes with roughly 1000, 10 000, 30 000 and 100 000 bodies at this spacing [m].
SPACING = 0.01
EDGES = {1000: 0.105, 10_000: 0.233, 30_000: 0.338, 100_000: 0.508}
#: Edges of cubes with 6000 and 20 000 bodies, for tessellation again.
EDGES_AGAIN = {6000: 0.195, 20_000: 0.295}
#: Part of the bodies that come, and how often times are taken there.
CHANGE, REPEATS = 0.01, 7
#: Most growth of the time per body from 10 000 bodies to the most, and least gain by reuse with 20 000 bodies.
GROWTH, GAIN = 1.5, 8.0
#: Number of bodies of other shapes, and how often times are taken there, by turns.
BODIES, TURNS = 6000, 7

TEXT = f"""\
Cubes with {1e3 * SPACING:g} mm between nuclei, processor times in seconds, one thread. *Selection* takes every nucleus
(fine), or keeps {{ratio:g}} times the distance (coarse). *Cells*: all facets with their corners, areas and centroids;
of Qhull and Voro++ without the latter, of Voro++ also without fetching them cell by cell. Qhull gets the nuclei and,
reflected, those within 1.25 spacings of a face; Voro++ gets the box. *Tessellation* is all that `discretize` does for
a given case: selection, cells, contacts, facets on the surface, volumes.
"""

EXACT = """\
Exactness on the same nuclei: pairs that only one of the two has (with a facet of more than 1e-10 squared spacings), the
largest difference of an area, relative to the largest area; sum of all volumes less that of the box, relative; and
the largest sum of area vectors of a cell, relative to the largest area.
"""

AGAIN = f"""\
After a change by which {100 * CHANGE:g} % of the bodies come (a ball becomes fine), medians of {REPEATS}; the result is
the same bit for bit, which is checked. Notched: with a saw cut 4 mm wide, a third of the depth deep. *Clipped*: cells
that had to be made anew. Selection is included in both times.
"""

SHAPES_TEXT = f"""\
Shapes with some {BODIES} bodies each, medians of {TURNS} by turns. *Convex cells*: of the specimen. *Pieces*: of a body
in these, on average. *Over a box*: tessellation of a body, relative to one of a box. Outlines and the cylinder have
round sides.
"""

#: Coarse spacing over fine spacing where a selection is timed.
RATIO = 4.0


def produce(found: argparse.Namespace) -> Report:
    seed = found.seeds[0]
    _row(seed, 0.05)  # compiled kernels are not part of what is measured
    rows = [_row(seed, edge) for edge in EDGES.values()]
    shapes = _shapes(seed)
    again = [_again(seed, edge, notched) for edge in EDGES_AGAIN.values() for notched in (False, True)]
    return Report(
        "tessellation", [*rows, *shapes, *again], _markdown(rows, shapes, again), _checks(rows, shapes, again)
    )


def _placed(domain: Domain, seed: int, spacing: float = SPACING) -> Nuclei:
    return Nuclei.placed(domain.complex, spacing, np.random.default_rng(seed))


def _notched(solid: Solid, at: Any, depth: float, width: float = 0.0) -> Domain:
    """A specimen with a notch upwards from a point of its bottom, across z."""
    slot = Slot(np.asarray(at, float), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), depth, width)
    notches = cut_notches(solid, [slot])
    return Domain(*complex_of(solid), notches=notches)


def _dog_bone() -> Domain:
    c = 0.04 * np.sin(np.pi / 3)
    corners = [
        *([-0.05, 0], [0.05, 0], [0.05, 0.06], {"to": [0.03, 0.06 + c], "radius": -0.04}, [0.03, 0.14 - c]),
        *({"to": [0.05, 0.14], "radius": -0.04}, [0.05, 0.2], [-0.05, 0.2], [-0.05, 0.14]),
        *({"to": [-0.03, 0.14 - c], "radius": -0.04}, [-0.03, 0.06 + c], {"to": [-0.05, 0.06], "radius": -0.04}),
    ]
    return _outline(corners, 0.1)


def _outline(points: Any, thickness: float) -> Domain:
    corners = [Corner.model_validate(p if isinstance(p, dict) else {"to": p}) for p in points]
    return Domain(*complex_of(extruded(corners, thickness, None, SPACING)))


#: Other shapes, and the most that a body may cost over one of a box.
SHAPES: dict[str, tuple[Callable[[], Domain], float | None]] = {
    "box": (lambda: Domain(*complex_of(box((0.35, 0.1, 0.05)))), None),
    "notched beam": (lambda: _notched(box((0.35, 0.1, 0.05)), (0.175, 0.0, 0.025), 0.05), 1.5),
    "beam with a saw cut": (lambda: _notched(box((0.35, 0.1, 0.05)), (0.175, 0.0, 0.025), 0.05, 0.004), 1.5),
    "L-panel": (
        lambda: _outline([[0, 0], [0.25, 0], [0.25, 0.25], [0.5, 0.25], [0.5, 0.5], [0, 0.5]], 0.1),
        2.0,
    ),
    "dog-bone": (_dog_bone, 2.0),
    "cylinder": (lambda: Domain(*complex_of(cylinder(0.15, 0.3, 1, SPACING))), 2.0),
}


def _shapes(seed: int) -> list[dict[str, Any]]:
    domains = {name: make() for name, (make, _) in SHAPES.items()}
    nuclei = {
        name: _placed(domain, seed, (0.8 * domain.volume / BODIES) ** (1 / 3)) for name, domain in domains.items()
    }
    times: dict[str, list[float]] = {name: [] for name in SHAPES}
    for _ in range(TURNS):
        for name, domain in domains.items():
            zero = np.zeros(len(nuclei[name]))
            times[name].append(cpu_time(lambda d=domain, n=nuclei[name], z=zero: discretize(n, d, z))[1])
    rows = []
    for name, domain in domains.items():
        found = discretize(nuclei[name], domain, np.zeros(len(nuclei[name])))
        pieces = 1.0 if found.pieces is None else len(found.pieces) / len(found)
        per_body = 1e6 * float(np.median(times[name])) / len(found)
        row = {"shape": name, "bodies": len(found), "cells": len(domain.complex.low), "pieces": pieces}
        rows.append(row | {"per_body_us": per_body, "over_box": per_body / rows[0]["per_body_us"] if rows else 1.0})
    return rows


def _row(seed: int, edge: float) -> dict[str, Any]:
    size = (edge,) * 3
    domain = Domain(*complex_of(box(size)))
    nuclei, placement = cpu_time(lambda: _placed(domain, seed))
    n = len(nuclei)
    say(f"{n} bodies")
    repeats = 3 if n < 50_000 else 1
    _, fine = cpu_time(lambda: select(nuclei, np.zeros(n)), 3)
    _, coarse = cpu_time(lambda: select(nuclei, np.full(n, RATIO * SPACING)), 3)
    spacing = np.full(n, SPACING)
    surfaces = len(domain.surfaces)
    cells, own = cpu_time(lambda: voronoi_cells(nuclei.x, nuclei.home, domain.complex, surfaces, spacing), 3)
    _, whole = cpu_time(lambda: discretize(nuclei, domain, np.zeros(n)), 3)
    row = {"bodies": n, "placement_s": placement, "select_fine_s": fine, "select_coarse_s": coarse, "cells_s": own}
    row |= {"tessellation_s": whole, "per_body_us": 1e6 * whole / n}
    inner = cells.bodies.inner
    pairs = np.stack([inner.body, inner.other], axis=1)
    reference = _Areas(nuclei.x, size, pairs, inner.area, *_sums_of(cells))
    row["exact_own"] = reference.exactness()
    (pairs, offsets, points), row["qhull_s"] = cpu_time(lambda: _qhull(nuclei.x, size), repeats)
    row["exact_qhull"] = _from_polygons(nuclei.x, size, pairs, offsets, points).exactness(reference)
    if compute_voronoi is not None:
        limits = np.array([np.zeros(3), size])
        found, row["multivoro_s"] = cpu_time(
            lambda: compute_voronoi(nuclei.x, limits=limits, radii=np.ones(n)), repeats
        )
        row["exact_multivoro"] = _from_multivoro(nuclei.x, size, found).exactness(reference)
    return row


class _Areas:
    """Areas between cells, and what they should add up to."""

    def __init__(self, x: Any, size: Any, pairs: Any, area: Any, volume: float, closure: Any) -> None:
        large = area > 1e-10 * SPACING**2
        self.key = pairs[large] @ [len(x), 1]
        order = np.argsort(self.key)
        self.key, self.area = self.key[order], area[large][order]
        self.volume = abs(volume / float(np.prod(size)) - 1.0)
        self.closure = float(np.abs(closure).max() / self.area.max())

    def exactness(self, reference: _Areas | None = None) -> dict[str, float]:
        out = {"volume": self.volume, "closure": self.closure}
        if reference is not None:
            _, here, there = np.intersect1d(self.key, reference.key, return_indices=True)
            most = np.abs(self.area[here] - reference.area[there]).max() / reference.area.max()
            out |= {"pairs_of_one": len(self.key) + len(reference.key) - 2 * len(here), "areas": float(most)}
        return out


def _closed(x: Any, pairs: Any, vectors: Any, centroids: Any) -> tuple[float, Any]:
    """Volume of all cells and sum of area vectors of each; a second cell of -1 is the surface."""
    volume = float(np.einsum("ka,ka->", vectors, centroids - x[pairs[:, 0]])) / 3.0
    closure = np.zeros((len(x), 3))
    np.add.at(closure, pairs[:, 0], vectors)
    inner = pairs[:, 1] >= 0
    volume -= float(np.einsum("ka,ka->", vectors[inner], centroids[inner] - x[pairs[inner, 1]])) / 3.0
    np.add.at(closure, pairs[inner, 1], -vectors[inner])
    return volume, closure


def _sums_of(cells: voronoi.Cells) -> tuple[float, Any]:
    inner, outer = cells.bodies.inner, cells.bodies.outer
    pairs = np.stack([inner.body, inner.other], axis=1)
    surface = np.stack([outer.body, np.full(len(outer.body), -1)], axis=1)
    found = [areas_and_centroids(facets.polygons.points, facets.polygons.offsets) for facets in (inner, outer)]
    return _closed(cells.x, np.concatenate([pairs, surface]), *map(np.concatenate, zip(*found, strict=True)))


def _from_polygons(x: Any, size: Any, pairs: Any, offsets: Any, points: Any) -> _Areas:
    """Of polygons in any orientation; pairs ``i < j``, or ``(i, -1)`` on the surface."""
    vectors, centroids = areas_and_centroids(points, offsets)
    outward = np.einsum("ka,ka->k", vectors, centroids - x[pairs[:, 0]])
    vectors *= np.where(outward < 0.0, -1.0, 1.0)[:, None]
    inner = pairs[:, 1] >= 0
    area = np.linalg.norm(vectors[inner], axis=1)
    return _Areas(x, size, pairs[inner], area, *_closed(x, pairs, vectors, centroids))


def _qhull(x: Any, size: tuple[float, float, float]) -> tuple[Any, Any, Any]:
    """Pairs, first corners and corners of all facets; the nuclei have to be saturated."""
    images, sources = [x], [np.arange(len(x))]
    for axis in range(3):
        for face in (0.0, size[axis]):
            near = np.flatnonzero(np.abs(x[:, axis] - face) < 1.25 * SPACING)
            image = x[near].copy()
            image[:, axis] = 2.0 * face - image[:, axis]
            images.append(image)
            sources.append(near)
    source = np.concatenate(sources)
    diagram = Voronoi(np.concatenate(images))
    ends = np.sort(diagram.ridge_points.astype(np.int64), axis=1)
    surface = (ends[:, 0] < len(x)) & (ends[:, 1] >= len(x)) & (source[ends[:, 1]] == ends[:, 0])
    rows = np.flatnonzero((ends[:, 1] < len(x)) | surface)
    corners = [diagram.ridge_vertices[k] for k in rows]
    offsets = np.concatenate([[0], np.cumsum(np.fromiter(map(len, corners), np.int64, len(corners)))])
    points = diagram.vertices[np.fromiter(chain.from_iterable(corners), np.int64, int(offsets[-1]))]
    pairs = ends[rows]
    pairs[surface[rows], 1] = -1
    return pairs, offsets, points


def _from_multivoro(x: Any, size: Any, found: Any) -> _Areas:
    pairs, counts, points = [], [], []
    for i, cell in enumerate(found):
        vertices, corners = np.asarray(cell.get_vertices()).reshape(-1, 3), cell.get_face_vertices()
        place = 0
        for j in cell.get_neighbors():
            first, place = place + 1, place + 1 + corners[place]  # every facet begins with its number of corners
            if j > i or j < 0:
                pairs.append((i, max(j, -1)))
                counts.append(place - first)
                points.append(vertices[corners[first:place]])
    offsets = np.concatenate([[0], np.cumsum(counts)])
    return _from_polygons(x, size, np.array(pairs, np.int64), offsets, np.concatenate(points))


def _again(seed: int, edge: float, notched: bool) -> dict[str, Any]:
    solid, middle = box((edge,) * 3), (0.5 * edge, 0.0, 0.5 * edge)
    domain = _notched(solid, middle, edge / 3.0, 0.004) if notched else Domain(*complex_of(solid))
    nuclei = _placed(domain, seed)
    n = len(nuclei)
    say(f"{n} bodies again")
    # The coarse ball lies clear of the notch.
    nearest = np.argsort(np.linalg.norm(nuclei.x - 0.75 * edge, axis=1))
    spacing, whole = np.zeros(n), np.zeros(n)
    for count in range(int(CHANGE * n), n, 10):
        spacing[nearest[:count]] = 2.0 * SPACING
        came = n - len(select(nuclei, spacing)[0])
        if came >= CHANGE * n:
            break
    previous = discretize(nuclei, domain, spacing)
    done: list[int] = []
    clip = clipped.clip_bodies

    def watched(todo: Any, *rest: Any) -> Any:
        done.append(len(todo))
        return clip(todo, *rest)

    clipped.clip_bodies = watched
    again = discretize(nuclei, domain, whole, previous)
    clipped.clip_bodies = clip
    scratch = discretize(nuclei, domain, whole)
    if not _identical(again, scratch):
        raise AssertionError("tessellating again gives something else")
    times = np.array(
        [
            [
                cpu_time(call)[1]
                for call in (
                    lambda: discretize(nuclei, domain, whole),
                    lambda: discretize(nuclei, domain, whole, previous),
                )
            ]
            for _ in range(REPEATS)
        ]
    )
    anew, reused = map(float, np.median(times, axis=0))
    row = {"bodies": n, "notched": notched, "came": came, "clipped": done[0], "anew_s": anew, "again_s": reused}
    return row | {"gain": anew / reused}


def _identical(one: Tessellation, other: Tessellation) -> bool:
    arrays = [
        [t.volume, t.contacts.bodies, t.contacts.polygons.points, t.surface.body, t.surface.polygons.points]
        + [getattr(part, name) for part in (t.contacts, t.surface) for name in ("area", "centroid", "normal")]
        for t in (one, other)
    ]
    return all(a.tobytes() == b.tobytes() for a, b in zip(*arrays, strict=True))


#: Columns of the first table: key, head, format.
COLUMNS = [
    ("bodies", "bodies", ".0f"),
    ("placement_s", "placement", ".2f"),
    ("select_fine_s", "selection, fine", ".4f"),
    ("select_coarse_s", "coarse", ".4f"),
    ("cells_s", "cells, own", ".3f"),
    ("qhull_s", "Qhull", ".2f"),
    ("multivoro_s", "Voro++", ".2f"),
    ("tessellation_s", "tessellation", ".3f"),
    ("per_body_us", "per body [µs]", ".1f"),
]
#: Columns of the table of shapes.
COLUMNS_SHAPES = [
    ("shape", "shape", "s"),
    ("bodies", "bodies", ".0f"),
    ("cells", "convex cells", ".0f"),
    ("pieces", "pieces", ".2f"),
    ("per_body_us", "per body [µs]", ".1f"),
    ("over_box", "over a box", ".2f"),
]
#: Columns of the table of repeated tessellation.
COLUMNS_AGAIN = [
    ("bodies", "bodies", ".0f"),
    ("notched", "notched", ""),
    ("came", "came", ".0f"),
    ("clipped", "clipped", ".0f"),
    ("anew_s", "from scratch [ms]", ".1f"),
    ("again_s", "again [ms]", ".1f"),
    ("gain", "ratio", ".1f"),
]


def _cells(row: dict[str, Any], columns: list[tuple[str, str, str]]) -> list[str]:
    def text(key: str, form: str) -> str:
        if key not in row:
            return "–"
        if not form:
            return "yes" if row[key] else "no"
        return f"{1e3 * row[key] if columns is COLUMNS_AGAIN and key.endswith('_s') else row[key]:{form}}"

    return [text(key, form) for key, _, form in columns]


def _exactness(rows: list[dict[str, Any]]) -> str:
    lines = []
    for row in rows:
        for key, name in (("exact_own", "own"), ("exact_qhull", "Qhull"), ("exact_multivoro", "Voro++")):
            if key in row:
                e = row[key]
                against = [f"{e['pairs_of_one']}", f"{e['areas']:.0e}"] if "areas" in e else ["–", "–"]
                lines.append([f"{row['bodies']}", name, *against, f"{e['volume']:.0e}", f"{e['closure']:.0e}"])
    return table(["bodies", "code", "pairs of one only", "areas", "volumes", "closure"], lines)


def _markdown(rows: list[dict[str, Any]], shapes: list[dict[str, Any]], again: list[dict[str, Any]]) -> str:
    parts = ["## Placement and tessellation", TEXT.format(ratio=RATIO)]
    parts += [table([head for _, head, _ in COLUMNS], [_cells(row, COLUMNS) for row in rows]), "", EXACT]
    parts += [_exactness(rows), "", SHAPES_TEXT]
    parts += [
        table([head for _, head, _ in COLUMNS_SHAPES], [_cells(row, COLUMNS_SHAPES) for row in shapes]),
        "",
        AGAIN,
    ]
    parts += [table([head for _, head, _ in COLUMNS_AGAIN], [_cells(row, COLUMNS_AGAIN) for row in again])]
    return "\n".join(parts)


def _checks(rows: list[dict[str, Any]], shapes: list[dict[str, Any]], again: list[dict[str, Any]]) -> list[Check]:
    growth = rows[-1]["per_body_us"] / rows[1]["per_body_us"]
    gain = next(row["gain"] for row in again[::-1] if not row["notched"])
    return [
        Check("time per body, most bodies over 10 000", growth, GROWTH),
        *(
            Check(f"time per body, {row['shape']} over box", row["over_box"], limit)
            for row in shapes
            if (limit := SHAPES[row["shape"]][1]) is not None
        ),
        Check("tessellation again over from scratch, 20 000 bodies", gain, GAIN, at_least=True),
    ]


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [1])))
