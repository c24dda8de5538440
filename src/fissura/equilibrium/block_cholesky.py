"""Lower block triangles of symmetric matrices, and their incomplete Cholesky factors without fill."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fissura.equilibrium.assembly import Pattern

__all__ = ["IncompleteCholesky", "LowerBlocks", "block_graph", "lower_blocks", "multiply"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Sums may be taken in any order, always the same one in one build.
_FAST = {"reassoc", "contract", "nsz", "arcp"}

#: Smallest pivot in shares of the diagonal entry it came from. Rotations of loosely held bodies are legitimately 1e-6
#: of their neighbours' stiffness, and next to supports another 1e-5.
_SMALLEST_PIVOT = 1e-14

#: Shares of the diagonal that are added, one after the other, until all pivots are positive definite (Manteuffel 1980).
_SHARES = (0.0, 0.01, 0.05, 0.2, 1.0)


@dataclass(frozen=True)
class LowerBlocks:
    """Where the 6x6 blocks on and below the diagonal lie, for bodies in some order.

    Attributes
    ----------
    order : (n,) array
        Body at each place.
    indptr, indices : (n + 1,), (k,) arrays
        Compressed block rows: places of the columns, ascending, so that the diagonal block ends its row.
    start, stride : (k,) arrays
        First entry of each block among the entries of the pattern, and distance of its rows there.
    """

    order: IntArray
    indptr: IntArray
    indices: IntArray
    start: IntArray
    stride: IntArray

    @property
    def rows(self) -> IntArray:
        """Place of each block's row, shape (k,)."""
        return np.repeat(np.arange(len(self.order)), np.diff(self.indptr))

    def gather(self, data: FloatArray) -> FloatArray:
        """Blocks of the matrix with these entries; (z,) -> (k, 6, 6)."""
        out = np.empty((len(self.indices), 6, 6))
        _gather(self.start, self.stride, data, out)
        return out


def block_graph(form: Pattern) -> tuple[IntArray, IntArray, IntArray]:
    """Row, column and first entry of every block of a pattern; three arrays of shape (k,)."""
    count = form.stride // 6
    row = np.repeat(np.arange(len(count)), count)
    within = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    start = form.start[row] + 6 * within
    return row, form.indices[start].astype(np.int64) // 6, start


def lower_blocks(form: Pattern, order: IntArray) -> LowerBlocks:
    """Lower triangle of a pattern for bodies in the given order, shape (n,)."""
    n = len(order)
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    row, column, start = block_graph(form)
    below = np.flatnonzero(place[column] <= place[row])
    below = below[np.argsort(place[row[below]] * n + place[column[below]], kind="stable")]
    indptr = np.concatenate([[0], np.cumsum(np.bincount(place[row[below]], minlength=n))])
    return LowerBlocks(order, indptr, place[column[below]], start[below], form.stride[row[below]])


@njit(cache=True)
def _gather(start, stride, data, out):  # type: ignore[no-untyped-def]
    for k in range(len(start)):
        for a in range(6):
            for d in range(6):
                out[k, a, d] = data[start[k] + a * stride[k] + d]


@njit(cache=True, fastmath=_FAST)
def _column(blocks, k, d, x):  # type: ignore[no-untyped-def]
    """Column d of block k times x, written out so that it is compiled to vector instructions over d."""
    upper = blocks[k, 0, d] * x[0] + blocks[k, 1, d] * x[1] + blocks[k, 2, d] * x[2]
    return upper + blocks[k, 3, d] * x[3] + blocks[k, 4, d] * x[4] + blocks[k, 5, d] * x[5]


@njit(cache=True, fastmath=_FAST)
def _multiply(indptr, indices, blocks, x, out):  # type: ignore[no-untyped-def]
    for i in range(len(indptr) - 1):
        own = (x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5])
        s0 = s1 = s2 = s3 = s4 = s5 = 0.0
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            for d in range(6):
                other = x[j, d]
                s0 += blocks[k, 0, d] * other
                s1 += blocks[k, 1, d] * other
                s2 += blocks[k, 2, d] * other
                s3 += blocks[k, 3, d] * other
                s4 += blocks[k, 4, d] * other
                s5 += blocks[k, 5, d] * other
                if j != i:
                    out[j, d] += _column(blocks, k, d, own)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4], out[i, 5] = s0, s1, s2, s3, s4, s5


def multiply(form: LowerBlocks, blocks: FloatArray, x: FloatArray) -> FloatArray:
    """Product of the symmetric matrix whose lower blocks these are with a vector; (n, 6) -> (n, 6)."""
    out = np.empty_like(x)
    _multiply(form.indptr, form.indices, blocks, x, out)
    return out


@njit(cache=True)
def _subtract_product(target, a, b):  # type: ignore[no-untyped-def]
    """``target -= a b^T`` for 6x6 blocks."""
    for p in range(6):
        for q in range(6):
            s = 0.0
            for r in range(6):
                s += a[p, r] * b[q, r]
            target[p, q] -= s


@njit(cache=True)
def _cholesky(block, original, smallest, out):  # type: ignore[no-untyped-def]
    """Inverse of the lower Cholesky factor; False when a pivot is too small."""
    low = np.zeros((6, 6))
    for p in range(6):
        for q in range(p + 1):
            s = block[p, q]
            for r in range(q):
                s -= low[p, r] * low[q, r]
            if p == q:
                if not s > smallest * original[p, p]:
                    return False
                low[p, p] = np.sqrt(s)
            else:
                low[p, q] = s / low[q, q]
    out[:] = 0.0
    for q in range(6):
        for p in range(q, 6):
            s = 1.0 if p == q else 0.0
            for r in range(q, p):
                s -= low[p, r] * out[r, q]
            out[p, q] = s / low[p, p]
    return True


@njit(cache=True, fastmath=_FAST)
def _factor(indptr, indices, matrix, added, share, last_try, smallest, out):  # type: ignore[no-untyped-def]
    """Row by row; diagonal blocks are replaced by inverses of their Cholesky factors.

    All diagonal blocks get a share of those in `added`. Returns the number of pivots that fail; in the last try these
    get more and more of their original diagonal block until they pass, or -1 is returned.
    """
    n = len(indptr) - 1
    where = np.full(n, -1)
    own, inverse = np.empty((6, 6)), np.empty((6, 6))
    failed = 0
    for i in range(n):
        begin, last = indptr[i], indptr[i + 1] - 1
        for k in range(begin, last):
            where[indices[k]] = k
        for p in range(6):
            for q in range(6):
                own[p, q] = matrix[last, p, q] + share * added[i, p, q]
        for k in range(begin, last):
            j = indices[k]
            block = out[k]
            block[:] = matrix[k]
            end = indptr[j + 1] - 1
            for m in range(indptr[j], end):
                common = where[indices[m]]
                if common >= 0:
                    _subtract_product(block, out[common], out[m])
            diagonal = out[end]
            for p in range(6):  # block = block inv(L_jj)^T
                for q in range(5, -1, -1):
                    s = 0.0
                    for r in range(q + 1):
                        s += block[p, r] * diagonal[q, r]
                    block[p, q] = s
            _subtract_product(own, block, block)
        for k in range(begin, last):
            where[indices[k]] = -1
        more = 0.05
        fine = _cholesky(own, matrix[last], smallest, inverse)
        if not fine:
            failed += 1
            if not last_try:
                return failed
        while not fine and more < 1e9:
            for p in range(6):
                for q in range(6):
                    own[p, q] += more * matrix[last, p, q]
            more *= 4.0
            fine = _cholesky(own, matrix[last], smallest, inverse)
        if not fine:
            return -1
        out[last] = inverse
    return failed


@njit(cache=True, fastmath=_FAST)
def _solve(indptr, indices, factor, x):  # type: ignore[no-untyped-def]
    n = len(indptr) - 1
    t = np.empty(6)
    for i in range(n):
        last = indptr[i + 1] - 1
        for a in range(6):
            t[a] = x[i, a]
        for k in range(indptr[i], last):
            j = indices[k]
            for a in range(6):
                for d in range(6):
                    t[a] -= factor[k, a, d] * x[j, d]
        for a in range(6):
            s = 0.0
            for d in range(6):
                s += factor[last, a, d] * t[d]
            x[i, a] = s
    for i in range(n - 1, -1, -1):
        last = indptr[i + 1] - 1
        own = (x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5])
        for d in range(6):
            x[i, d] = _column(factor, last, d, own)
        own = (x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5])
        for k in range(indptr[i], last):
            j = indices[k]
            for d in range(6):
                x[j, d] -= _column(factor, k, d, own)


class IncompleteCholesky:
    """Approximate factorization ``L L^T`` whose factor has the pattern of the matrix.

    It does not depend on the units of forces and moments: scaling the unknowns of a body scales its blocks alone.

    Parameters
    ----------
    form : LowerBlocks
        Lower triangle; the order of bodies decides how good the factor is.
    """

    def __init__(self, form: LowerBlocks) -> None:
        self.form = form
        #: Share of the diagonal that was added in the latest factorization, because without it some pivots were not
        #: positive definite.
        self.share = 0.0
        #: Pivot blocks that needed more than the largest share.
        self.shifted = 0
        self._factor: FloatArray | None = None

    def factor(self, blocks: FloatArray, added: FloatArray | None = None) -> None:
        """Factorize a matrix.

        Parameters
        ----------
        blocks : (k, 6, 6) array
            Its lower blocks.
        added : (n, 6, 6) array, optional
            What to add a share of to the diagonal where the factorization breaks down; the diagonal blocks if not
            given. The stiffness of supports is better left out: shares of it would hold much more than they do.

        Raises
        ------
        ValueError
            A diagonal block is not positive definite.
        """
        if self._factor is None:
            self._factor = np.empty_like(blocks)
        form = self.form
        diagonal = blocks[form.indptr[1:] - 1] if added is None else added
        for self.share in _SHARES:
            last_try = self.share == _SHARES[-1]
            self.shifted = _factor(
                form.indptr, form.indices, blocks, diagonal, self.share, last_try, _SMALLEST_PIVOT, self._factor
            )
            if self.shifted == 0:
                return
        if self.shifted < 0:
            raise ValueError("a diagonal block is not positive definite")

    def solve(self, right: FloatArray) -> FloatArray:
        """``(L L^T)^-1`` times a vector; (n, 6) -> (n, 6)."""
        assert self._factor is not None
        out = right.copy()
        _solve(self.form.indptr, self.form.indices, self._factor, out)
        return out
