"""Lower block triangles of symmetric matrices."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import njit
from fissura.linear.assembly import Pattern
from fissura.linear.limits import AHEAD, FAST
from fissura.linear.plain import column
from fissura.linear.products import prefetch, prefetch_item
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


@dataclass(frozen=True)
class LowerBlocks:
    """Where the 6x6 blocks on and below the diagonal lie, for bodies in some order.

    Attributes
    ----------
    order : (n,) array
        Body at each place.
    indptr, indices : (n + 1,), (k,) arrays
        Compressed block rows: places of the columns, ascending, so that the diagonal block ends its row.
    start : (k,) array
        First entry of each block among the entries of the pattern.
    stride : (n,) array
        Distance of the rows of a body's blocks there.
    bounds : (domains + 1,) array
        Where domains that do not touch each other begin, and where the last one ends; the tail follows.
    """

    order: IntArray
    indptr: IntArray
    indices: NDArray[np.int32]
    start: IntArray
    stride: IntArray
    bounds: IntArray

    @cached_property
    def tail(self) -> IntArray:
        """Begin and end of the bodies that come after all domains, shape (2,)."""
        return np.array([self.bounds[-1], len(self.order)])

    @cached_property
    def has_tail(self) -> bool:
        """Whether there are such bodies; what has nothing to do takes as long to start as small structures to solve."""
        return bool(self.bounds[-1] < len(self.order))

    @cached_property
    def pieces(self) -> IntArray:
        """Bounds of domains and tail, shape (domains + 2,), or (2,) where there is one domain and no tail."""
        return self.bounds if self.bounds[-1] == len(self.order) else np.append(self.bounds, len(self.order))

    @property
    def rows(self) -> IntArray:
        """Place of each block's row, shape (k,)."""
        return np.repeat(np.arange(len(self.order)), np.diff(self.indptr))

    @cached_property
    def place(self) -> IntArray:
        """Place of each body, shape (n,)."""
        out = np.empty(len(self.order), dtype=np.int64)
        out[self.order] = np.arange(len(self.order))
        return out

    def entries(self, blocks: IntArray, size: int) -> IntArray:
        """Where the leading `size` rows and columns of some blocks lie among the entries of the pattern; (q, s, s)."""
        stride = self.stride[np.searchsorted(self.indptr, blocks, side="right") - 1]
        return self.start[blocks, None, None] + np.arange(size)[:, None] * stride[:, None, None] + np.arange(size)

    def gather(
        self, data: FloatArray, out: FloatArray | None = None, threads: KernelThreads = SINGLE_THREAD
    ) -> FloatArray:
        """Blocks of the matrix with these entries, in `out` if given; (z,) -> (k, 6, 6).

        Raises
        ------
        ValueError
            An entry is not finite.
        """
        out = np.empty((len(self.indices), 6, 6)) if out is None else out
        if any(threads.run(_gather, self.pieces, self.indptr, self.start, self.stride, data, out)):  # nan is true
            raise ValueError("the stiffness matrix holds values that are not finite")
        return out


def held_bodies(form: Pattern, *, low_rank: bool = True) -> BoolArray:
    """Bodies held by supports, those with entries in the pattern and those of low rank; shape (n,)."""
    held = np.zeros(len(form.start), dtype=bool)
    strong = form.fixed[form.fixed_values != 0.0]
    held[np.searchsorted(form.start, strong, side="right") - 1] = True
    if low_rank:
        held[form.low_rank.bodies] = True
    return held


def constant_part(form: Pattern, entry: IntArray) -> FloatArray:
    """Constant part of some entries of a matrix, any shape."""
    if not len(form.fixed):
        return np.zeros(entry.shape)
    found = np.minimum(np.searchsorted(form.fixed, entry), len(form.fixed) - 1)
    return np.where(form.fixed[found] == entry, form.fixed_values[found], 0.0)


@njit()
def _graph(start, neighbours, last, indptr, indices):  # type: ignore[no-untyped-def]
    """Neighbours of every body; those in `last` do not see each other."""
    n, k = len(start), 0
    for b in range(n):
        indptr[b] = k
        end = start[b + 1] // 36 if b + 1 < n else len(neighbours)
        for p in range(start[b] // 36, end):
            other = neighbours[p]
            if other != b and not (last[b] and last[other]):
                indices[k] = other
                k += 1
    indptr[n] = k
    return k


def bandwidth_order(form: Pattern, last: BoolArray) -> IntArray:
    """Bodies by reverse Cuthill-McKee, some of them at the end; shape (n,).

    Parameters
    ----------
    form : Pattern
        Pattern.
    last : (n,) array
        Bodies to put at the end. What couples them with each other does not count.
    """
    n = len(form.start)
    indptr, indices = np.empty(n + 1, dtype=np.int32), np.empty(len(form.neighbours), dtype=np.int32)
    count = _graph(form.start, form.neighbours, last, indptr, indices)
    graph = csr_array((np.ones(count, dtype=np.int8), indices[:count], indptr), shape=(n, n))
    order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int64)
    return np.concatenate([order[~last[order]], order[last[order]]])


@njit()
def _lower(order, place, first, stride, neighbours, indptr, indices, start):  # type: ignore[no-untyped-def]
    k = 0
    for i in range(len(order)):
        b = order[i]
        indptr[i] = k
        for p in range(stride[b] // 6):
            j = place[neighbours[first[b] // 36 + p]]
            if j > i:
                continue
            q = k
            while q > indptr[i] and indices[q - 1] > j:
                indices[q], start[q] = indices[q - 1], start[q - 1]
                q -= 1
            indices[q], start[q] = j, first[b] + 6 * p
            k += 1
    indptr[-1] = k


def lower_blocks(form: Pattern, order: IntArray, bounds: IntArray | None = None) -> LowerBlocks:
    """Lower triangle of a pattern for bodies in the given order, shape (n,), which may fall into domains."""
    n = len(order)
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    count = (len(form.neighbours) + n) // 2  # the pattern is symmetric
    indptr, indices, start = np.empty(n + 1, dtype=np.int64), np.empty(count, dtype=np.int32), np.empty(count, np.int64)
    _lower(order, place, form.start, form.stride, form.neighbours, indptr, indices, start)
    bounds = np.array([0, n]) if bounds is None else bounds
    return LowerBlocks(order, indptr, indices, start, form.stride[order], bounds)


@njit(nogil=True, fastmath={"reassoc"})
def _gather(begin, end, indptr, start, stride, data, out):  # type: ignore[no-untyped-def]
    """Returns zero, or nan where an entry is not finite."""
    zero = 0.0
    for i in range(begin, end):
        # Bodies that follow each other lie far apart in `data`: ask for the next one's rows in time.
        following = min(i + 1, end - 1)
        step = stride[following]
        for k in range(indptr[following], indptr[following + 1]):
            for a in range(6):
                prefetch_item(data, start[k] + a * step)
                prefetch_item(data, start[k] + a * step + 5)
        step = stride[i]
        for k in range(indptr[i], indptr[i + 1]):
            for a in range(6):
                for d in range(6):
                    entry = data[start[k] + a * step + d]
                    out[k, a, d] = entry
                    zero += 0.0 * entry
    return zero


@njit(nogil=True, fastmath=FAST)
def _multiply(begin, end, indptr, indices, blocks, x, out):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        own = (x[i, 0], x[i, 1], x[i, 2], x[i, 3], x[i, 4], x[i, 5])
        s0 = s1 = s2 = s3 = s4 = s5 = 0.0
        for k in range(indptr[i], indptr[i + 1]):
            prefetch(blocks, k + AHEAD)
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
                    out[j, d] += column(blocks, k, d, own)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4], out[i, 5] = s0, s1, s2, s3, s4, s5


@njit()
def _sizes(indptr, indices, blocks, x, out):  # type: ignore[no-untyped-def]
    for i in range(len(indptr) - 1):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            for a in range(6):
                for d in range(6):
                    size = abs(blocks[k, a, d])
                    out[i, a] += size * abs(x[j, d])
                    if j != i:
                        out[j, d] += size * abs(x[i, a])


def multiply(
    form: LowerBlocks, blocks: FloatArray, x: FloatArray, threads: KernelThreads = SINGLE_THREAD
) -> FloatArray:
    """Product of the symmetric matrix whose lower blocks these are with a vector; (n, 6) -> (n, 6)."""
    out = np.empty_like(x)
    threads.run(_multiply, form.bounds, form.indptr, form.indices, blocks, x, out)
    if form.has_tail:
        SINGLE_THREAD.run(_multiply, form.tail, form.indptr, form.indices, blocks, x, out)
    return out


def term_sizes(form: LowerBlocks, blocks: FloatArray, x: FloatArray) -> FloatArray:
    """Sum of the sizes of all terms of each component of :func:`multiply`; (n, 6) -> (n, 6)."""
    out = np.zeros_like(x)
    _sizes(form.indptr, form.indices, blocks, x, out)
    return out
