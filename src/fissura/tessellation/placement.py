"""Sequential random placement of nuclei to true saturation (theory section 1).

Trials fall only into *active voxels*, those not yet covered by the exclusion balls of accepted nuclei. When
trials become rare hits the voxels are divided by eight and the covered ones dropped, until none is left: no point
of the specimen can then take another nucleus.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.kernels import njit
from fissura.specimen import Box
from fissura.tessellation.mirror import MirrorZones
from fissura.tessellation.voxels import cell_of, divided, free, surroundings

__all__ = ["expected_count", "place"]

FloatArray = NDArray[np.float64]

_MAX_LEVEL = 24

#: Share of a squared spacing by which given nuclei may be closer to each other.
_REGULAR = 1e-9

_TRIALS_PER_VOXEL = 2.0


def expected_count(size: tuple[float, float, float], spacing: float) -> float:
    """Expected number of nuclei in a saturated box with free walls, ``0.734 prod(size_k / l + 0.6)``."""
    return float(0.734 * np.prod(np.asarray(size) / spacing + 0.6))


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
def _place(  # type: ignore[no-untyped-def]
    size, spacing, cell, shape, steps, zones, void_lower, void_upper, given, rng, max_level, rate
):
    grid = np.full((shape[0] + 4) * (shape[1] + 4) * (shape[2] + 4), -1, np.int32)
    zl, zu, za, zp, zc = zones
    capacity = max(64, int(1.5 * size[0] * size[1] * size[2] / spacing**3) + 4 * len(given) + 64)
    x = np.empty((capacity, 3))
    twin = np.full(capacity, -1, np.int64)
    n = 0
    l2 = spacing * spacing
    l2_given = l2 * (1.0 - _REGULAR)  # a regular grid is not thinned out by round-off
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
    level = 0
    g = 0
    while count > 0 and level <= max_level:
        trials = int(rate * count) + 1 if g >= len(given) else len(given)
        for _ in range(trials):
            if g < len(given):
                v = -1
                for a in range(3):
                    p[a] = given[g, a]
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
            if z >= 0 and abs(p[za[z]] - zp[z]) < (zc * (1.0 - _REGULAR) if v < 0 else zc):
                continue
            away2 = l2_given if v < 0 else l2
            if not free(p, x, grid, steps, shape, cell, away2):
                continue
            if z >= 0:
                for a in range(3):
                    t[a] = p[a]
                t[za[z]] = 2.0 * zp[z] - p[za[z]]
                if not free(t, x, grid, steps, shape, cell, away2):
                    continue
            if n + 2 > capacity:
                capacity *= 2
                bigger = np.empty((capacity, 3))
                for k in range(n):
                    for a in range(3):
                        bigger[k, a] = x[k, a]
                x = bigger
                longer = np.full(capacity, -1, np.int64)
                for k in range(n):
                    longer[k] = twin[k]
                twin = longer
            for a in range(3):
                x[n, a] = p[a]
            grid[cell_of(p[0], p[1], p[2], shape, cell)] = n
            n += 1
            if z >= 0:
                for a in range(3):
                    x[n, a] = t[a]
                grid[cell_of(t[0], t[1], t[2], shape, cell)] = n
                twin[n] = n - 1
                twin[n - 1] = n
                n += 1
            if v >= 0:
                # A voxel no larger than a grid cell is covered by the nucleus inside it.
                for a in range(3):
                    active[v, a] = active[count - 1, a]
                count -= 1
        # Divide what is left and drop what is covered.
        divide = level > 0 or g >= len(given)
        parts = 2 if divide else 1
        active = divided(
            active[:count], parts, side, size, zones, void_lower, void_upper, x, grid, steps, shape, cell, l2
        )
        count = len(active)
        side /= parts
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
    size = np.asarray(box.size, float)
    # Nuclei are at least one spacing apart, so a grid cell with that diagonal holds one at most.
    cell = spacing / np.sqrt(3.0) * (1.0 - (1e-12 if given is None else _REGULAR))
    x, twin, _ = _place(
        size,
        spacing,
        cell,
        *surroundings(size, cell),
        (zones.lower, zones.upper, zones.axis, zones.plane, zones.clearance),
        np.array([low for low, _ in voids]).reshape(-1, 3),
        np.array([high for _, high in voids]).reshape(-1, 3),
        np.empty((0, 3)) if given is None else np.ascontiguousarray(given, float),
        rng,
        _MAX_LEVEL,
        _TRIALS_PER_VOXEL,
    )
    return x, twin
