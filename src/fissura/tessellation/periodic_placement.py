"""Random sequential placement in a periodic cube, to true saturation as in a specimen (theory section 1)."""

import numpy as np

from fissura.arrays import FloatArray
from fissura.kernels import INNER, njit
from fissura.tessellation.limits import MOST_LEVELS, SMALLEST_SIDE, TRIALS_PER_VOXEL
from fissura.tessellation.placement import first_voxels
from fissura.tessellation.roots import free_roots
from fissura.tessellation.voxels import Placed, divided, free, surroundings


@njit(**INNER)
def _enter(p, n, x, grid, shape, side, cell):  # type: ignore[no-untyped-def]
    """Enter a nucleus and those of its images that lie in the margin of the grid; returns the count of all."""
    here = np.empty(3, np.int64)
    for a in range(3):
        here[a] = min(int(p[a] / cell), shape[a] - 1)
    at = np.empty(3, np.int64)
    for image in range(27):
        step = (image // 9 - 1, image // 3 % 3 - 1, image % 3 - 1)
        inside = True
        for a in range(3):
            at[a] = here[a] + step[a] * shape[a] + 2
            inside &= 0 <= at[a] < shape[a] + 4
        if inside:
            for a in range(3):
                x[n, a] = p[a] + step[a] * side
            grid[(at[0] * (shape[1] + 4) + at[1]) * (shape[2] + 4) + at[2]] = n
            n += 1
    return n


@njit()
def _place(side, spacing, cell, shape, steps, roots, rng, max_level, rate):  # type: ignore[no-untyped-def]
    grid = np.full((shape[0] + 4) * (shape[1] + 4) * (shape[2] + 4), -1, np.int32)
    # Balls of half the spacing do not overlap, and all nuclei and images lie in the grid and its margin.
    room = int(1.5 * ((side + 5.0 * cell) / spacing + 1.0) ** 3) + 64
    x = np.empty((room, 3))
    own = np.empty((room, 3))
    total, n = 0, 0
    l2 = spacing * spacing
    placed = Placed(x, grid, steps, shape, cell, l2)
    active, root = first_voxels(shape, roots)
    count = len(active)
    p = np.empty(3)
    width = cell
    level = 0
    while count > 0 and level <= max_level:
        for _ in range(int(rate * count) + 1):
            if count == 0:
                break
            v = int(rng.random() * count)
            for a in range(3):
                p[a] = (active[v, a] + rng.random()) * width
            if p[0] >= side or p[1] >= side or p[2] >= side or not free(p, x, grid, steps, shape, cell, l2):
                continue
            total = _enter(p, total, x, grid, shape, side, cell)
            for a in range(3):
                own[n, a] = p[a]
                # A voxel no larger than a grid cell is covered by the nucleus inside it.
                active[v, a] = active[count - 1, a]
            n += 1
            count -= 1
        parts = 2 if level > 0 else 1
        active, root = divided(active[:count], root[:count], parts, width, roots, placed)
        count = len(active)
        width /= parts
        level += 1
    return own[:n].copy()


def place_periodic(side: float, spacing: float, rng: np.random.Generator) -> FloatArray:
    """Place nuclei in a periodic cube until no point of it can take another one.

    Parameters
    ----------
    side : float
        Side of the cube [m], at least `SMALLEST_SIDE` spacings.
    spacing : float
        Smallest distance ``l_min`` of nuclei and of their images [m].
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    (n, 3) array
        Nuclei [m], each coordinate at least 0 and less than `side`.

    Raises
    ------
    ValueError
        A cube that is too small.
    """
    if not side >= SMALLEST_SIDE * spacing:
        raise ValueError(f"a periodic cube needs a side of at least {SMALLEST_SIDE:g} spacings")
    # Grid cells divide the cube evenly and hold one nucleus at most, so that images fall into cells of their own.
    number = int(np.ceil(side * np.sqrt(3.0) / spacing * (1.0 + 1e-12)))
    cell = side / number
    shape, steps = surroundings(np.full(3, (number - 0.5) * cell), cell)
    roots = free_roots(int(np.prod(shape)))
    x: FloatArray = _place(side, spacing, cell, shape, steps, roots, rng, MOST_LEVELS, TRIALS_PER_VOXEL)
    return x
