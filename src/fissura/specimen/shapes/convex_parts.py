"""Polygons divided into few convex ones."""

import numpy as np
import shapely

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.specimen.limits import ROUND_OFF, TRIES


def check_simple(points: FloatArray, key: str) -> None:
    """Refuse an outline that crosses or touches itself.

    Parameters
    ----------
    points : (n, 2) array
        Corners [m].
    key : str
        Where the outline stands in the case file.

    Raises
    ------
    InputError
        It does.
    """
    polygon = shapely.Polygon(points)
    if polygon.is_valid:
        return
    reason, _, place = shapely.is_valid_reason(polygon).partition("[")
    where = ", ".join(f"{float(v):.6g}" for v in place.rstrip("]").split()[:2])
    verb = "touches" if "Ring" in reason else "crosses"
    near = f" at ({where}) m" if where else ""
    raise InputError(key, f"it {verb} itself{near}", "corners in order around the specimen")


def convex_parts(points: FloatArray) -> list[list[int]]:
    """Divide a polygon into convex parts without new corners.

    Triangles of a constrained Delaunay triangulation are joined across common sides while they stay convex (Hertel and
    Mehlhorn 1983), which makes at most four times as many parts as necessary; of some orders the best is taken.

    Parameters
    ----------
    points : (n, 2) array
        Corners of a simple polygon, counterclockwise.

    Returns
    -------
    list of list of int
        Corners of each part, counterclockwise; straight ones among them stay.
    """
    whole = list(range(len(points)))
    if all(_turns_left(points, whole, k) for k in whole):
        return [whole]
    number = {tuple(point): k for k, point in enumerate(points.tolist())}
    triangles: list[list[int]] = []
    for triangle in shapely.constrained_delaunay_triangles(shapely.Polygon(points)).geoms:
        loop = [number[tuple(corner)] for corner in np.asarray(triangle.exterior.coords)[:3].tolist()]
        u, v = points[loop[1]] - points[loop[0]], points[loop[2]] - points[loop[0]]
        triangles.append(loop if u[0] * v[1] - u[1] * v[0] > 0.0 else loop[::-1])
    owner = {edge for triangle in triangles for edge in _edges(triangle)}
    inner = sorted({(min(e), max(e)) for e in owner if (e[1], e[0]) in owner}, key=lambda e: (-_length(points, e), e))
    rng = np.random.default_rng(0)
    orders = [inner, inner[::-1], *(rng.permutation(inner).tolist() for _ in range(TRIES if len(inner) > 1 else 0))]
    return min((_joined(points, triangles, order) for order in orders), key=len)


def _joined(points: FloatArray, triangles: list[list[int]], order: list[tuple[int, int]]) -> list[list[int]]:
    """Join triangles across inner sides in a given order, while what they become is convex."""
    parts: list[list[int] | None] = list(triangles)
    owner = {edge: k for k, part in enumerate(parts) for edge in _edges(part or [])}
    for u, w in order:
        k, m = owner[u, w], owner[w, u]
        a, b = parts[k], parts[m]
        if k == m or a is None or b is None:
            continue
        a = a[a.index(w) :] + a[: a.index(w)]  # from w round to u
        b = b[b.index(u) :] + b[: b.index(u)]  # from u round to w
        both = a + b[1:-1]
        if all(_turns_left(points, both, both.index(v)) for v in (u, w)):
            parts[k], parts[m] = both, None
            owner.update(dict.fromkeys(_edges(both), k))
    return [part for part in parts if part is not None]


def _edges(part: list[int]) -> list[tuple[int, int]]:
    return list(zip(part, part[1:] + part[:1], strict=True))


def _length(points: FloatArray, edge: tuple[int, int]) -> float:
    return float(np.linalg.norm(points[edge[0]] - points[edge[1]]))


def _turns_left(points: FloatArray, loop: list[int], k: int) -> bool:
    """Whether the corner of a loop is convex, or straight."""
    before, here, after = (points[loop[(k + d) % len(loop)]] for d in (-1, 0, 1))
    u, v = here - before, after - here
    return bool(u[0] * v[1] - u[1] * v[0] >= -ROUND_OFF * np.linalg.norm(u) * np.linalg.norm(v))
