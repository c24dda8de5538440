"""Plane sections of a domain: the smallest one, and outlines for pictures."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import compiled_when_large, njit
from fissura.specimen.limits import LEAST_SIDE, MOST_LEVELS, SAME
from fissura.specimen.surface_part import SurfacePart


@compiled_when_large(lambda *given: len(given[0]) * len(given[2]), 500_000)
@njit()
def _areas(points, start, levels):  # type: ignore[no-untyped-def]
    """Areas of the sections perpendicular to the last axis at levels where no corner lies."""
    out = np.zeros(len(levels))
    for f in range(len(start) - 1):
        a, b = start[f], start[f + 1]
        low, high = np.inf, -np.inf
        for m in range(a, b):
            low, high = min(low, points[m, 2]), max(high, points[m, 2])
        for q in range(len(levels)):
            t = levels[q]
            if t < low:
                continue
            if t >= high:
                break
            up0, up1, down0, down1 = 0.0, 0.0, 0.0, 0.0
            for m in range(a, b):
                n = m + 1 if m + 1 < b else a
                h, g = points[m, 2] - t, points[n, 2] - t
                if (h < 0.0) == (g < 0.0):
                    continue
                s = h / (h - g)
                x = points[m, 0] + s * (points[n, 0] - points[m, 0])
                y = points[m, 1] + s * (points[n, 1] - points[m, 1])
                if h < 0.0:
                    up0, up1 = x, y
                else:
                    down0, down1 = x, y
            out[q] += 0.5 * (up0 * down1 - up1 * down0)
    for q in range(len(levels)):
        out[q] = abs(out[q])
    return out


def smallest_section_of(parts: Sequence[SurfacePart], tolerance: float) -> float:
    """Area of the smallest section perpendicular to an axis through which the material hangs together [m^2].

    Between two corners the area of a section is quadratic in its place, so its least value there is exact. Where faces
    lie in the section, such as those of a notch, they are taken off. Of more than some hundred corners only some are
    looked at.

    Parameters
    ----------
    parts : sequence of SurfacePart
        The whole surface.
    tolerance : float
        Length that is round-off [m].
    """
    points = np.concatenate([part.polygon for part in parts])
    start = np.concatenate([[0], np.cumsum([len(part.polygon) for part in parts])])
    return min(_smallest_along(axis, parts, points, start, tolerance) for axis in range(3))


def _smallest_along(
    axis: int, parts: Sequence[SurfacePart], points: FloatArray, start: IntArray, tolerance: float
) -> float:
    turned = np.ascontiguousarray(points[:, [(axis + 1) % 3, (axis + 2) % 3, axis]])
    levels = np.unique(turned[:, 2])
    levels = levels[np.concatenate([[True], np.diff(levels) > tolerance])]
    if len(levels) > MOST_LEVELS:
        levels = levels[np.linspace(0, len(levels) - 1, MOST_LEVELS).astype(int)]
    step = np.diff(levels)
    at = levels[:-1, None] + step[:, None] * np.array([0.25, 0.5, 0.75])
    f = _areas(turned, start, at.ravel()).reshape(-1, 3)
    c2 = 8.0 * (f[:, 0] - 2.0 * f[:, 1] + f[:, 2])
    c1 = 2.0 * (f[:, 2] - f[:, 0]) - c2
    c0 = f[:, 1] - 0.5 * c1 - 0.25 * c2
    below = np.concatenate([[0.0], np.cumsum(step * (c0 + c1 / 2.0 + c2 / 3.0))])
    least, most = LEAST_SIDE * below[-1], (1.0 - LEAST_SIDE) * below[-1]
    # Material that ends at a level, seen from below: faces whose outward normal points up.
    ends: defaultdict[int, float] = defaultdict(float)
    for part in parts:
        if part.normal[axis] > 1.0 - SAME:
            ends[int(np.argmin(np.abs(levels - part.polygon[0, axis])))] += part.area
    best = np.inf
    for k in range(len(step)):
        if below[k + 1] < least or below[k] > most:
            continue
        s = np.linspace(0.0, 1.0, 33)
        inside = below[k] + step[k] * (c0[k] * s + c1[k] * s**2 / 2.0 + c2[k] * s**3 / 3.0)
        tried = s[(inside >= least) & (inside <= most)].tolist()
        if c2[k] > 0.0 and tried and tried[0] <= -0.5 * c1[k] / c2[k] <= tried[-1]:
            tried.append(-0.5 * c1[k] / c2[k])
        best = min([best, *(float(c0[k] + c1[k] * s + c2[k] * s**2) for s in tried)])
        if least <= below[k + 1] <= most:
            best = min(best, float(c0[k] + c1[k] + c2[k]) - ends[k + 1])
    return best


def outline_of(
    parts: Sequence[SurfacePart], normal: FloatArray, offset: float, extent: float
) -> tuple[FloatArray, ...]:
    """Outline of the section in a plane, as closed loops (k, 3) with the material on their left [m].

    "Left" is seen from where `normal` points. Of faces that lie in the plane, those in front of it count.

    Parameters
    ----------
    parts : sequence of SurfacePart
        The whole surface.
    normal : (3,) array
        Unit normal of the plane.
    offset : float
        Its product with the points of the plane [m].
    extent : float
        Largest dimension of the whole [m].
    """
    tolerance = SAME * extent
    shift = _clear(np.concatenate([part.polygon @ normal for part in parts]) - offset, tolerance)
    segments = []
    for part in parts:
        h = part.polygon @ normal - offset - shift
        if h.min() > 0.0 or h.max() < 0.0:
            continue
        after, h_after = np.roll(part.polygon, -1, axis=0), np.roll(h, -1)
        up, down = np.flatnonzero((h < 0.0) & (h_after > 0.0))[0], np.flatnonzero((h > 0.0) & (h_after < 0.0))[0]
        ends = [part.polygon[k] + h[k] / (h[k] - h_after[k]) * (after[k] - part.polygon[k]) for k in (down, up)]
        if np.abs(ends[1] - ends[0]).max() > tolerance:
            segments.append(ends)
    return tuple(
        loop - shift * normal + 0.0 for loop in _chained(np.array(segments).reshape(-1, 2, 3), normal, tolerance)
    )


def _clear(heights: FloatArray, tolerance: float) -> float:
    """How far to move a plane that it goes through no corner, given the heights of corners above it; inwards."""
    shift = 0.0
    for k in range(1, 1000):
        if np.abs(heights - shift).min() > tolerance and heights.min() < shift < heights.max():
            return shift
        shift = 10.0 * tolerance * (k // 2 + 1) * (1 if k % 2 else -1)
    return 0.0


def _chained(segments: FloatArray, normal: FloatArray, tolerance: float) -> list[FloatArray]:
    """Closed loops of segments (m, 2, 3) that lead from end to end; where two go on, the one farthest to the left."""
    left = list(range(len(segments)))
    direction = segments[:, 1] - segments[:, 0]

    def turn(a: int, b: int) -> float:
        """Angle by which segment b goes on to the left of a, straight back being the least."""
        sine, cosine = np.cross(direction[a], direction[b]) @ normal, direction[a] @ direction[b]
        angle = float(np.arctan2(sine, cosine))
        return -np.pi if angle > np.pi - 1e-6 else angle

    loops = []
    while left:
        loop = [left.pop(0)]
        while True:
            end = segments[loop[-1], 1]
            ahead = [loop[0], *left]
            near = [q for q in ahead if np.abs(segments[q, 0] - end).max() <= 10.0 * tolerance]
            if not near:
                break
            best = max(near, key=lambda q: turn(loop[-1], q))
            if best == loop[0]:
                break
            left.remove(best)
            loop.append(best)
        loops.append(segments[loop, 0])
    return loops
