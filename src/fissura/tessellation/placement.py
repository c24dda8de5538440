"""Sequential random placement of nuclei to true saturation (theory section 1).

Trials fall only into *active voxels*, those not yet covered by the exclusion balls of accepted nuclei. When
trials become rare hits the voxels are divided by eight and the covered ones dropped, until none is left: no point
of the specimen can then take another nucleus.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fissura.specimen import Box
from fissura.tessellation.mirror import MirrorZones

__all__ = ["expected_count", "place"]

FloatArray = NDArray[np.float64]

_MAX_LEVEL = 24
_TRIALS_PER_VOXEL = 2.0


def expected_count(size: tuple[float, float, float], spacing: float) -> float:
    """Expected number of nuclei in a saturated box with free walls, ``0.734 prod(size_k / l + 0.6)``."""
    return float(0.734 * np.prod(np.asarray(size) / spacing + 0.6))


@njit(cache=True)
def _free(p, x, grid, shape, cell, l2):  # type: ignore[no-untyped-def]
    """Whether no accepted nucleus is closer to `p` than the spacing (cells hold at most two nuclei)."""
    c0, c1, c2 = int(p[0] / cell), int(p[1] / cell), int(p[2] / cell)
    for i in range(max(c0 - 2, 0), min(c0 + 3, shape[0])):
        for j in range(max(c1 - 2, 0), min(c1 + 3, shape[1])):
            for k in range(max(c2 - 2, 0), min(c2 + 3, shape[2])):
                q = grid[(i * shape[1] + j) * shape[2] + k]
                if q >= 0:
                    d0, d1, d2 = p[0] - x[q, 0], p[1] - x[q, 1], p[2] - x[q, 2]
                    if d0 * d0 + d1 * d1 + d2 * d2 < l2:
                        return False
    return True


@njit(cache=True)
def _covered(low, high, x, grid, shape, cell, l2):  # type: ignore[no-untyped-def]
    """Whether one accepted nucleus covers all corners of a box no larger than a grid cell."""
    m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
    h0, h1, h2 = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    c0, c1, c2 = int(m0 / cell), int(m1 / cell), int(m2 / cell)
    for i in range(max(c0 - 2, 0), min(c0 + 3, shape[0])):
        for j in range(max(c1 - 2, 0), min(c1 + 3, shape[1])):
            for k in range(max(c2 - 2, 0), min(c2 + 3, shape[2])):
                q = grid[(i * shape[1] + j) * shape[2] + k]
                if q >= 0:
                    d0, d1, d2 = abs(m0 - x[q, 0]) + h0, abs(m1 - x[q, 1]) + h1, abs(m2 - x[q, 2]) + h2
                    if d0 * d0 + d1 * d1 + d2 * d2 < l2:
                        return True
    return False


@njit(cache=True)
def _zone_at(p, lower, upper):  # type: ignore[no-untyped-def]
    for z in range(len(lower)):
        if (
            lower[z, 0] <= p[0] <= upper[z, 0]
            and lower[z, 1] <= p[1] <= upper[z, 1]
            and lower[z, 2] <= p[2] <= upper[z, 2]
        ):
            return z
    return -1


@njit(cache=True)
def _in_void(low, high, void_lower, void_upper):  # type: ignore[no-untyped-def]
    """Whether a box lies wholly in a saw cut."""
    for v in range(len(void_lower)):
        inside = True
        for a in range(3):
            if low[a] < void_lower[v, a] or high[a] > void_upper[v, a]:
                inside = False
        if inside:
            return True
    return False


@njit(cache=True)
def _dead(  # type: ignore[no-untyped-def]
    low, high, zl, zu, za, zp, zc, void_lower, void_upper, x, grid, shape, cell, l2
):
    """Whether no nucleus fits into a box: covered, in a saw cut, or its mirror image covered."""
    if _covered(low, high, x, grid, shape, cell, l2) or _in_void(low, high, void_lower, void_upper):
        return True
    for z in range(len(za)):
        # The part of the box inside the zone, and what is left of the box when one face of the zone cuts it.
        part_low, part_high = np.empty(3), np.empty(3)
        rest_low, rest_high = low.copy(), high.copy()
        cuts = 0
        empty = False
        for a in range(3):
            part_low[a], part_high[a] = max(low[a], zl[z, a]), min(high[a], zu[z, a])
            if part_low[a] >= part_high[a]:
                empty = True
            if low[a] < zl[z, a]:
                cuts += 1
                rest_high[a] = zl[z, a]
            if high[a] > zu[z, a]:
                cuts += 1
                rest_low[a] = zu[z, a]
        if empty:
            continue
        if cuts > 1 or (cuts == 1 and not _covered(rest_low, rest_high, x, grid, shape, cell, l2)):
            return False
        # Pairs keep clear of the plane.
        a = za[z]
        below, above = zp[z] - zc, zp[z] + zc
        if part_low[a] >= below and part_high[a] <= above:
            return True
        if part_low[a] >= below:
            part_low[a] = max(part_low[a], above)
        elif part_high[a] <= above:
            part_high[a] = min(part_high[a], below)
        if _covered(part_low, part_high, x, grid, shape, cell, l2):
            return True
        lower = part_low[a]
        part_low[a] = 2.0 * zp[z] - part_high[a]
        part_high[a] = 2.0 * zp[z] - lower
        return _covered(part_low, part_high, x, grid, shape, cell, l2)
    return False


@njit(cache=True)
def _place(  # type: ignore[no-untyped-def]
    size, spacing, zl, zu, za, zp, zc, void_lower, void_upper, given, rng, max_level, rate
):
    # Nuclei are at least one spacing apart, so a grid cell with that diagonal holds one at most.
    cell = spacing / np.sqrt(3.0) * (1.0 - 1e-12)
    shape = np.empty(3, np.int64)
    for a in range(3):
        shape[a] = int(size[a] / cell) + 1
    grid = np.full(shape[0] * shape[1] * shape[2], -1, np.int64)
    capacity = max(64, int(1.5 * size[0] * size[1] * size[2] / spacing**3) + 4 * len(given) + 64)
    x = np.empty((capacity, 3))
    twin = np.full(capacity, -1, np.int64)
    n = 0
    l2 = spacing * spacing
    side = cell
    active = np.empty((shape[0] * shape[1] * shape[2], 3), np.int64)
    count = 0
    for i in range(shape[0]):
        for j in range(shape[1]):
            for k in range(shape[2]):
                active[count, 0], active[count, 1], active[count, 2] = i, j, k
                count += 1
    p = np.empty(3)
    t = np.empty(3)
    low = np.empty(3)
    high = np.empty(3)
    level = 0
    g = 0
    while count > 0 and level <= max_level:
        trials = int(rate * count) + 1 if g >= len(given) else len(given)
        for _ in range(trials):
            if g < len(given):
                v = -1
                p[:] = given[g]
                g += 1
            else:
                if count == 0:
                    break
                v = int(rng.random() * count)
                for a in range(3):
                    p[a] = (active[v, a] + rng.random()) * side
                if p[0] >= size[0] or p[1] >= size[1] or p[2] >= size[2]:
                    continue
            in_void = False
            for w in range(len(void_lower)):
                if (
                    void_lower[w, 0] <= p[0] <= void_upper[w, 0]
                    and void_lower[w, 1] <= p[1] <= void_upper[w, 1]
                    and void_lower[w, 2] <= p[2] <= void_upper[w, 2]
                ):
                    in_void = True
            if in_void:
                continue
            z = _zone_at(p, zl, zu)
            if z >= 0 and abs(p[za[z]] - zp[z]) < zc:
                continue
            if not _free(p, x[:n], grid, shape, cell, l2):
                continue
            if z >= 0:
                t[:] = p
                t[za[z]] = 2.0 * zp[z] - p[za[z]]
                if not _free(t, x[:n], grid, shape, cell, l2):
                    continue
            if n + 2 > capacity:
                capacity *= 2
                bigger = np.empty((capacity, 3))
                bigger[:n] = x[:n]
                x = bigger
                longer = np.full(capacity, -1, np.int64)
                longer[:n] = twin[:n]
                twin = longer
            x[n] = p
            grid[(int(p[0] / cell) * shape[1] + int(p[1] / cell)) * shape[2] + int(p[2] / cell)] = n
            n += 1
            if z >= 0:
                x[n] = t
                grid[(int(t[0] / cell) * shape[1] + int(t[1] / cell)) * shape[2] + int(t[2] / cell)] = n
                twin[n] = n - 1
                twin[n - 1] = n
                n += 1
            if v >= 0:
                # A voxel no larger than a grid cell is covered by the nucleus inside it.
                active[v] = active[count - 1]
                count -= 1
        # Divide what is left and drop what is covered.
        divide = level > 0 or g >= len(given)
        parts = 2 if divide else 1
        finer = np.empty((count * parts**3, 3), np.int64)
        kept = 0
        new_side = side / parts
        for v in range(count):
            for i in range(parts):
                for j in range(parts):
                    for k in range(parts):
                        finer[kept, 0] = parts * active[v, 0] + i
                        finer[kept, 1] = parts * active[v, 1] + j
                        finer[kept, 2] = parts * active[v, 2] + k
                        for a in range(3):
                            low[a] = finer[kept, a] * new_side
                            high[a] = min(low[a] + new_side, size[a])
                        if low[0] >= size[0] or low[1] >= size[1] or low[2] >= size[2]:
                            continue
                        if _dead(
                            low,
                            high,
                            zl,
                            zu,
                            za,
                            zp,
                            zc,
                            void_lower,
                            void_upper,
                            x[:n],
                            grid,
                            shape,
                            cell,
                            l2,
                        ):
                            continue
                        kept += 1
        active = finer[:kept].copy()
        count = kept
        side = new_side
        level += 1
    return x[:n].copy(), twin[:n].copy(), count


def place(
    box: Box,
    spacing: float,
    zones: MirrorZones,
    rng: np.random.Generator,
    given: FloatArray | None = None,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Place nuclei until the specimen is saturated.

    Parameters
    ----------
    box : Box
        The specimen.
    spacing : float
        Smallest distance ``l_min`` of nuclei [m].
    zones : MirrorZones
        Where nuclei come in mirrored pairs.
    rng : numpy.random.Generator
        Source of randomness.
    given : (k, 3) array, optional
        Nuclei to begin with [m]; those closer than `spacing` to an earlier one are left out.

    Returns
    -------
    x : (n, 3) array
        Nuclei [m].
    twin : (n,) array
        Index of the mirror image of each nucleus, -1 outside the zones.
    """
    voids = [notch.bounds for notch in box.notches if notch.width > 0.0]
    x, twin, _ = _place(
        np.asarray(box.size, float),
        spacing,
        zones.lower,
        zones.upper,
        zones.axis,
        zones.plane,
        zones.clearance,
        np.array([low for low, _ in voids]).reshape(-1, 3),
        np.array([high for _, high in voids]).reshape(-1, 3),
        np.empty((0, 3)) if given is None else np.ascontiguousarray(given, float),
        rng,
        _MAX_LEVEL,
        _TRIALS_PER_VOXEL,
    )
    return x, twin
