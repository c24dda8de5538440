"""Rays through the convex cells of a specimen: how far it is to the surface."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import compiled_when_large, njit
from fissura.specimen.complex import Complex


@compiled_when_large(lambda *given: len(given[0]), 1000)
@njit()
def _marched(x, direction, cell, cx):  # type: ignore[no-untyped-def]
    """Walk from cell to cell through open parts of faces."""
    length, part = np.empty(len(x)), np.full(len(x), -1, np.int64)
    for i in range(len(x)):
        k, t = cell[i], 0.0
        for _ in range(4 * len(cx.low) + 4):
            first, plane = np.inf, -1
            for f in range(cx.plane_start[k], cx.plane_start[k + 1]):
                rate, gap = 0.0, cx.offset[f]
                for a in range(3):
                    rate += cx.normal[f, a] * direction[i, a]
                    gap -= cx.normal[f, a] * x[i, a]
                if rate > 1e-12 and gap < first * rate:
                    first, plane = gap / rate, f
            if plane < 0:
                break
            t = max(t, first)
            least, found = np.inf, -1
            for q in range(cx.part_start[plane], cx.part_start[plane + 1]):
                beyond = -np.inf
                for e in range(cx.edge_start[q], cx.edge_start[q + 1]):
                    h = -cx.edge_offset[e]
                    for a in range(3):
                        h += cx.edge_normal[e, a] * (x[i, a] + t * direction[i, a])
                    beyond = max(beyond, h)
                if beyond < least or found < 0:
                    least, found = beyond, q
            part[i] = found
            if cx.part_to[found] < 0:
                break
            k = cx.part_to[found]
        length[i] = t
    return length, part


def distance_to_surface(
    complex_: Complex, x: FloatArray, direction: FloatArray, cell: IntArray
) -> tuple[FloatArray, IntArray]:
    """How far rays go before they leave the specimen.

    Parameters
    ----------
    complex_ : Complex
        The specimen.
    x : (n, 3) array
        Where rays begin, in cells or on their faces [m].
    direction : (n, 3) array
        Unit vectors, into the cells.
    cell : (n,) array
        The convex cell of each.

    Returns
    -------
    distance : (n,) array
        Length of the ray [m].
    part : (n,) array
        The part of a face where it ends, one that is not open.
    """
    length, part = _marched(np.ascontiguousarray(x), np.ascontiguousarray(direction), cell, complex_)
    return length, part
