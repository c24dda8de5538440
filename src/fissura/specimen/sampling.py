"""Points with weights on lines and flat convex polygons, with which linear functions are integrated exactly."""

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.kernels import compiled_when_large, njit
from fissura.specimen.limits import MOST_ROWS, ROUND_OFF
from fissura.specimen.planar import Flat


def _count(length: float, spacing: float) -> int:
    return max(1, int(np.ceil(min(length / spacing, MOST_ROWS) - ROUND_OFF)))


def sampled_interval(low: float, high: float, spacing: float) -> FloatArray:
    """Points that stand for equal shares of [low, high], no farther apart than `spacing`.

    Centres of equal intervals; of a single one its two Gauss points, so that narrow strips have their turns.
    """
    count = _count(high - low, spacing)
    share = (np.arange(count) + 0.5) / count if count > 1 else 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
    return low + (high - low) * share


def sampled_polygon(
    polygon: FloatArray, normal: FloatArray, along: FloatArray, spacing: float
) -> tuple[FloatArray, FloatArray]:
    """Points on a convex polygon, and the area for which each of them stands.

    Parameters
    ----------
    polygon : (k, 3) array
        Corners, counterclockwise around the normal [m].
    normal : (3,) array
        Its unit normal.
    along : (3,) array
        A direction in its plane with which rows of points are aligned.
    spacing : float
        Largest dimension of what a point stands for [m].

    Returns
    -------
    points : (n, 3) array
        Centroids of rectangles and, at the edges, of what of them lies in the polygon [m].
    area : (n,) array
        Their areas [m^2].
    """
    flat = Flat(polygon[0], np.array([along, np.cross(normal, along)]))
    corners = flat.inside(polygon)
    low, high = corners.min(axis=0), corners.max(axis=0)
    near = ROUND_OFF * float((high - low).max())
    box = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    if all(np.abs(corners - corner).max(axis=1).min() <= near for corner in box):  # a rectangle
        u, v = (sampled_interval(low[a], high[a], spacing) for a in range(2))
        grid = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        return flat.outside(grid), np.full(len(grid), float(np.prod(high - low)) / len(grid))
    counts = [max(2, _count(high[a] - low[a], spacing)) for a in range(2)]
    lines = [np.linspace(low[a], high[a], counts[a] + 1) for a in range(2)]
    inside = _inside(corners, np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1))
    whole = inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]
    middle = [0.5 * (line[1:] + line[:-1]) for line in lines]
    centres = np.stack(np.meshgrid(*middle, indexing="ij"), axis=-1)[whole]
    cell = float(np.prod([line[1] - line[0] for line in lines]))
    i, j = np.nonzero(~whole)
    area, centroid = _in_rectangles(corners, lines[0], lines[1], i, j)
    kept = area > ROUND_OFF * cell
    points = np.concatenate([centres, centroid[kept]])
    return flat.outside(points), np.concatenate([np.full(len(centres), cell), area[kept]])


def _inside(corners: FloatArray, points: FloatArray) -> BoolArray:
    """Whether points (..., 2) lie in a convex polygon (k, 2), counterclockwise."""
    out = np.ones(points.shape[:-1], bool)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        out &= (b[0] - a[0]) * (points[..., 1] - a[1]) - (b[1] - a[1]) * (points[..., 0] - a[0]) >= 0.0
    return out


@compiled_when_large(lambda *given: len(given[3]), 5000)
@njit()
def _in_rectangles(corners, u, v, i, j):  # type: ignore[no-untyped-def]
    """Areas and centroids of what of a convex polygon (k, 2) lies in rectangles of a grid."""
    area, centroid = np.zeros(len(i)), np.zeros((len(i), 2))
    most = len(corners) + 8
    a, b = np.empty((most, 2)), np.empty((most, 2))
    for q in range(len(i)):
        n = len(corners)
        for m in range(n):
            a[m, 0], a[m, 1] = corners[m, 0], corners[m, 1]
        for side in range(4):
            axis, sign = side // 2, 1.0 if side % 2 else -1.0
            line = (u[i[q] + side % 2]) if axis == 0 else v[j[q] + side % 2]
            kept = 0
            for m in range(n):
                k = m + 1 if m + 1 < n else 0
                h, g = sign * (a[m, axis] - line), sign * (a[k, axis] - line)
                if h <= 0.0:
                    b[kept, 0], b[kept, 1] = a[m, 0], a[m, 1]
                    kept += 1
                if (h < 0.0 < g) or (g < 0.0 < h):
                    t = h / (h - g)
                    for c in range(2):
                        b[kept, c] = a[m, c] + t * (a[k, c] - a[m, c])
                    kept += 1
            a, b, n = b, a, kept
        x0, y0 = a[0, 0], a[0, 1]
        twice, first, second = 0.0, 0.0, 0.0
        for m in range(1, n - 1):
            x, y, xx, yy = a[m, 0] - x0, a[m, 1] - y0, a[m + 1, 0] - x0, a[m + 1, 1] - y0
            w = x * yy - xx * y
            twice += w
            first += w * (x + xx) / 3.0
            second += w * (y + yy) / 3.0
        if twice > 0.0:
            area[q] = 0.5 * twice
            centroid[q, 0], centroid[q, 1] = x0 + first / twice, y0 + second / twice
    return area, centroid
