"""Sequential random placement of nuclei to true saturation (theory section 1).

Trials fall only into *active voxels*, those not yet covered by the exclusion balls of accepted nuclei. When
trials become rare hits the voxels are divided by eight and the covered ones dropped, until none is left: no point
of the specimen can then take another nucleus. Voxels that faces of the specimen cut count by their parts inside.
"""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.specimen.complex import Complex
from fissura.tessellation.limits import MOST_LEVELS, ON_FACE, REGULAR, TRIALS_PER_VOXEL
from fissura.tessellation.roots import holder, roots_of
from fissura.tessellation.search import longer, taller
from fissura.tessellation.voxels import Placed, cell_of, divided, free, surroundings


@njit(**INNER)
def first_voxels(shape, roots):  # type: ignore[no-untyped-def]
    """All roots that meet the specimen, as voxels."""
    active = np.empty((shape[0] * shape[1] * shape[2], 3), np.int32)
    root = np.empty(len(active), np.int32)
    count = 0
    for r in range(len(active)):
        if roots.start[r + 1] > roots.start[r]:
            active[count, 0], active[count, 1], active[count, 2] = (
                r // (shape[1] * shape[2]), r // shape[2] % shape[1], r % shape[2]
            )  # fmt: skip
            root[count] = r
            count += 1
    return active[:count].copy(), root[:count].copy()


@njit()
def _place(spacing, cell, shape, steps, roots, given, rng, max_level, rate):  # type: ignore[no-untyped-def]
    grid = np.full((shape[0] + 4) * (shape[1] + 4) * (shape[2] + 4), -1, np.int32)
    active, root = first_voxels(shape, roots)
    interior, start, cells, begin, end, normal, offset = roots
    capacity = 1024 + len(given) + len(active) // 4
    x, home = np.empty((capacity, 3)), np.empty(capacity, np.int64)
    taken, n = np.zeros(len(given), np.bool_), 0
    side = cell
    p = np.empty(3)
    l2 = spacing * spacing
    l2_given = l2 * (1.0 - REGULAR)  # a regular grid is not thinned out by round-off
    level, g = 0, 0
    count = len(active)
    while count > 0 and level <= max_level:
        placed = Placed(x, grid, steps, shape, cell, l2)
        trials = int(rate * count) + 1 if g >= len(given) else len(given)
        for _ in range(trials):
            least = -ON_FACE * side  # round-off may leave a given nucleus on a face outside of all cells
            if g < len(given):
                v = -1
                for a in range(3):
                    p[a] = given[g, a]
                g += 1
                r = (int(p[0] / cell) * shape[1] + int(p[1] / cell)) * shape[2] + int(p[2] / cell)
            else:
                if count == 0:
                    break
                v = int(rng.random() * count)
                for a in range(3):
                    p[a] = (active[v, a] + rng.random()) * side
                r, least = root[v], 0.0
            # Whichever is more likely to refuse the point is asked first.
            k = -1 if interior[r] else holder(p, r, start, cells, begin, end, normal, offset, least)
            if k < 0 and not interior[r]:
                continue
            if not free(p, x, grid, steps, shape, cell, l2_given if v < 0 else l2):
                continue
            if interior[r]:
                k = holder(p, r, start, cells, begin, end, normal, offset, least)
                if k < 0:
                    continue
            if n == capacity:
                capacity *= 2
                x, home = taller(x), longer(home)
                placed = Placed(x, grid, steps, shape, cell, l2)
            for a in range(3):
                x[n, a] = p[a]
            home[n] = k
            if v < 0:
                taken[g - 1] = True
            grid[cell_of(p[0], p[1], p[2], shape, cell)] = n
            n += 1
            if v >= 0:
                # A voxel no larger than a grid cell is covered by the nucleus inside it.
                count -= 1
                root[v] = root[count]
                for a in range(3):
                    active[v, a] = active[count, a]
        # Divide what is left and drop what is covered.
        active, root = divided(active[:count], root[:count], 2, side, roots, placed)
        count = len(active)
        side /= 2
        level += 1
    return x[:n].copy(), home[:n].copy(), taken, count


def place(
    complex_: Complex, spacing: float, rng: np.random.Generator, given: FloatArray | None = None
) -> tuple[FloatArray, IntArray]:
    """Place nuclei until the specimen is saturated.

    Parameters
    ----------
    complex_ : Complex
        The specimen.
    spacing : float
        Smallest distance ``l_min`` of nuclei [m].
    rng : numpy.random.Generator
        Source of randomness.
    given : (k, 3) array, optional
        Nuclei in the specimen to begin with [m]; those closer than `spacing` to an earlier one are left out.

    Returns
    -------
    x : (n, 3) array
        Nuclei [m].
    home : (n,) array
        The convex cell that holds each of them.
    """
    # Nuclei are at least one spacing apart, so a grid cell with that diagonal holds one at most.
    cell = spacing / np.sqrt(3.0) * (1.0 - (1e-12 if given is None else REGULAR))
    origin = complex_.low.min(axis=0)
    shape, steps = surroundings(complex_.high.max(axis=0) - origin, cell)
    given = np.empty((0, 3)) if given is None else np.ascontiguousarray(given, float)
    roots = roots_of(complex_, origin, shape, cell)
    x, home, taken, _ = _place(spacing, cell, shape, steps, roots, given - origin, rng, MOST_LEVELS, TRIALS_PER_VOXEL)
    x += origin
    x[: taken.sum()] = given[taken]  # where they are, to the last bit
    return x, home
