"""What `simd` does, in sums that numba compiles as it finds best, and without hints to load blocks in time."""

from fissura.kernels import njit
from fissura.linear.limits import FAST


@njit(fastmath=FAST, inline="always")
def column(blocks, k, d, x):  # type: ignore[no-untyped-def]
    """Column d of block k times x, written out so that it is compiled to vector instructions over d."""
    upper = blocks[k, 0, d] * x[0] + blocks[k, 1, d] * x[1] + blocks[k, 2, d] * x[2]
    return upper + blocks[k, 3, d] * x[3] + blocks[k, 4, d] * x[4] + blocks[k, 5, d] * x[5]


@njit(fastmath=FAST, inline="always")
def _row(blocks, k, a, x):  # type: ignore[no-untyped-def]
    left = blocks[k, a, 0] * x[0] + blocks[k, a, 1] * x[1] + blocks[k, a, 2] * x[2]
    return left + blocks[k, a, 3] * x[3] + blocks[k, a, 4] * x[4] + blocks[k, a, 5] * x[5]


@njit(inline="always")
def times(blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k] @ x``: (n, 6, 6) array, number, tuple of six -> tuple of six."""
    upper = (_row(blocks, k, 0, x), _row(blocks, k, 1, x), _row(blocks, k, 2, x))
    return (*upper, _row(blocks, k, 3, x), _row(blocks, k, 4, x), _row(blocks, k, 5, x))


@njit(inline="always")
def transposed_times(blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k].T @ x``: (n, 6, 6) array, number, tuple of six -> tuple of six."""
    left = (column(blocks, k, 0, x), column(blocks, k, 1, x), column(blocks, k, 2, x))
    return (*left, column(blocks, k, 3, x), column(blocks, k, 4, x), column(blocks, k, 5, x))


@njit(inline="always")
def prefetch(blocks, k):  # type: ignore[no-untyped-def]
    """Nothing."""


@njit(inline="always")
def prefetch_item(items, k):  # type: ignore[no-untyped-def]
    """Nothing."""
