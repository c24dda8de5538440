"""What `simd` does, in loops that numba compiles as it finds best, and without hints to load blocks in time.

It stands in where vector instructions cannot be given to the compiler, and tells what they gain (`benchmarks/simd.py`).
"""

from __future__ import annotations

from fissura.kernels import INNER, njit

__all__ = ["prefetch", "prefetch_item", "times", "transposed_times"]

_FAST = {"reassoc", "contract", "nsz"}


@njit(**INNER, fastmath=_FAST)
def _row(blocks, k, a, x):  # type: ignore[no-untyped-def]
    s = blocks[k, a, 0] * x[0] + blocks[k, a, 1] * x[1] + blocks[k, a, 2] * x[2]
    return s + blocks[k, a, 3] * x[3] + blocks[k, a, 4] * x[4] + blocks[k, a, 5] * x[5]


@njit(**INNER, fastmath=_FAST)
def _column(blocks, k, d, x):  # type: ignore[no-untyped-def]
    s = blocks[k, 0, d] * x[0] + blocks[k, 1, d] * x[1] + blocks[k, 2, d] * x[2]
    return s + blocks[k, 3, d] * x[3] + blocks[k, 4, d] * x[4] + blocks[k, 5, d] * x[5]


@njit(**INNER)
def times(blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k] @ x``: (n, 6, 6) array, number, tuple of six -> tuple of six."""
    return (
        _row(blocks, k, 0, x),
        _row(blocks, k, 1, x),
        _row(blocks, k, 2, x),
        _row(blocks, k, 3, x),
        _row(blocks, k, 4, x),
        _row(blocks, k, 5, x),
    )


@njit(**INNER)
def transposed_times(blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k].T @ x``: (n, 6, 6) array, number, tuple of six -> tuple of six."""
    return (
        _column(blocks, k, 0, x),
        _column(blocks, k, 1, x),
        _column(blocks, k, 2, x),
        _column(blocks, k, 3, x),
        _column(blocks, k, 4, x),
        _column(blocks, k, 5, x),
    )


@njit(**INNER)
def prefetch(blocks, k):  # type: ignore[no-untyped-def]
    """Nothing."""


@njit(**INNER)
def prefetch_item(items, k):  # type: ignore[no-untyped-def]
    """Nothing."""
