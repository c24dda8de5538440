"""Incomplete Cholesky factors, without fill, of symmetric matrices of 6x6 blocks."""

import numpy as np
from numpy.typing import NDArray

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.linear import limits
from fissura.linear.blocks import LowerBlocks
from fissura.linear.limits import AHEAD, FAST
from fissura.linear.products import prefetch, times, transposed_times
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


@njit(**INNER, fastmath=FAST)
def _subtract_product(target, a, b):  # type: ignore[no-untyped-def]
    """``target -= a b^T`` for 6x6 blocks."""
    for p in range(6):
        for q in range(6):
            s = 0.0
            for r in range(6):
                s += a[p, r] * b[q, r]
            target[p, q] -= s


@njit(**INNER)
def _copy(source, target):  # type: ignore[no-untyped-def]
    """Entry by entry: array assignment would have to compile what it says when shapes differ."""
    for p in range(6):
        for q in range(6):
            target[p, q] = source[p, q]


@njit(**INNER)
def _cholesky(block, original, smallest, low, out):  # type: ignore[no-untyped-def]
    """Inverse of the lower Cholesky factor; False when a pivot is too small."""
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


@njit(nogil=True, fastmath=FAST)
def _factor(begin_row, end_row, indptr, indices, matrix, added, share, last_try, smallest, out):  # type: ignore[no-untyped-def]
    """Row by row; diagonal blocks are replaced by inverses of their Cholesky factors.

    All diagonal blocks get a share of those in `added`. Returns the number of pivots that fail; in the last try these
    get more and more of their original diagonal block until they pass, or -1 is returned.
    """
    where = np.full(len(indptr) - 1, -1)
    own, inverse, low = np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    block = np.empty((6, 6))
    failed = 0
    for i in range(begin_row, end_row):
        begin, last = indptr[i], indptr[i + 1] - 1
        for k in range(begin, last):
            where[indices[k]] = k
        for p in range(6):
            for q in range(6):
                own[p, q] = matrix[last, p, q]
                if share > 0.0:
                    own[p, q] += share * added[i, p, q]
        for k in range(begin, last):
            j = indices[k]
            _copy(matrix[k], block)
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
            _copy(block, out[k])
            _subtract_product(own, block, block)
        for k in range(begin, last):
            where[indices[k]] = -1
        more = 0.05
        fine = _cholesky(own, matrix[last], smallest, low, inverse)
        if not fine:
            failed += 1
            if not last_try:
                return failed
        while not fine and more < 1e9:
            for p in range(6):
                for q in range(6):
                    own[p, q] += more * matrix[last, p, q]
            more *= 4.0
            fine = _cholesky(own, matrix[last], smallest, low, inverse)
        if not fine:
            return -1
        _copy(inverse, out[last])
    return failed


@njit(nogil=True, fastmath=FAST)
def _forward(begin, end, indptr, indices, factor, right, x):  # type: ignore[no-untyped-def]
    """``x = L^-1 right`` in some rows."""
    for i in range(begin, end):
        last = indptr[i + 1] - 1
        s0, s1, s2, s3, s4, s5 = right[i, 0], right[i, 1], right[i, 2], right[i, 3], right[i, 4], right[i, 5]
        prefetch(factor, last + AHEAD)
        for k in range(indptr[i], last):
            prefetch(factor, k + AHEAD)
            j = indices[k]
            t = times(factor, k, (x[j, 0], x[j, 1], x[j, 2], x[j, 3], x[j, 4], x[j, 5]))
            s0, s1, s2, s3, s4, s5 = s0 - t[0], s1 - t[1], s2 - t[2], s3 - t[3], s4 - t[4], s5 - t[5]
        own = times(factor, last, (s0, s1, s2, s3, s4, s5))
        x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5] = own


@njit(nogil=True, fastmath=FAST)
def _backward(begin, end, indptr, indices, factor, x):  # type: ignore[no-untyped-def]
    """``x = L^-T x`` in some columns, from the last one on."""
    for i in range(end - 1, begin - 1, -1):
        last = indptr[i + 1] - 1
        prefetch(factor, last - AHEAD)
        own = transposed_times(factor, last, (x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5]))
        x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5] = own
        for k in range(indptr[i], last):
            prefetch(factor, k - AHEAD)
            j = indices[k]
            t = transposed_times(factor, k, own)
            for d in range(6):
                x[j, d] -= t[d]


class IncompleteCholesky:
    """Approximate factorization ``L L^T`` whose factor has the pattern of the matrix.

    It does not depend on the units of forces and moments: scaling the unknowns of a body scales its blocks alone. The
    factor is kept in single precision: it is a preconditioner, and the time to apply it is that of reading it.

    Parameters
    ----------
    form : LowerBlocks
        Lower triangle; the order of bodies decides how good the factor is.
    threads : KernelThreads
        Threads that share the work on domains.
    """

    def __init__(self, form: LowerBlocks, threads: KernelThreads = SINGLE_THREAD) -> None:
        self.form, self._threads = form, threads
        #: Share of the diagonal that was added in the latest factorization, because without it some pivots were not
        #: positive definite.
        self.share = 0.0
        #: Pivot blocks that needed more than the largest share.
        self.shifted = 0
        self._factor: NDArray[np.float32] | None = None

    def factor(self, blocks: FloatArray, left_out: tuple[IntArray, FloatArray] | None = None) -> None:
        """Factorize a matrix.

        Parameters
        ----------
        blocks : (k, 6, 6) array
            Its lower blocks.
        left_out : ((h,) array, (h, 6, 6) array), optional
            Bodies, and the part of their diagonal blocks that counts for nothing where a share of the diagonal is
            added: the stiffness of supports, shares of which would hold much more than they do.

        Raises
        ------
        ValueError
            A diagonal block is not positive definite.
        """
        if self._factor is None:
            self._factor = np.empty(blocks.shape, dtype=np.float32)
        form, added = self.form, np.empty((0, 6, 6))
        for self.share in limits.SHARES:
            if self.share > 0.0 and not len(added):
                added = blocks[form.indptr[1:] - 1]
                if left_out is not None:
                    added[left_out[0]] -= left_out[1]
            last_try = self.share == limits.SHARES[-1]
            rest = (form.indptr, form.indices, blocks, added, self.share, last_try, limits.SMALLEST_PIVOT, self._factor)
            failed = self._threads.run(_factor, form.bounds, *rest)
            if last_try or not any(failed):
                failed += SINGLE_THREAD.run(_factor, form.tail, *rest)
            self.shifted = -1 if min(failed) < 0 else sum(failed)
            if self.shifted == 0:
                return
        if self.shifted < 0:
            raise ValueError("a diagonal block is not positive definite")

    def release(self) -> None:
        """Give back the memory of the factor, until the next one."""
        self._factor = None

    def solve(self, right: FloatArray) -> FloatArray:
        """``(L L^T)^-1`` times a vector; (n, 6) -> (n, 6)."""
        assert self._factor is not None
        form, out = self.form, np.empty_like(right)
        rest = (form.indptr, form.indices, self._factor)
        self._threads.run(_forward, form.bounds, *rest, right, out)
        if form.has_tail:
            SINGLE_THREAD.run(_forward, form.tail, *rest, right, out)
            SINGLE_THREAD.run(_backward, form.tail, *rest, out)
        self._threads.run(_backward, form.bounds, *rest, out)
        return out
