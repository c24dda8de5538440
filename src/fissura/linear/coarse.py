"""Rigid motions of clusters of bodies: the coarse unknowns of the two-level solver."""

import numpy as np
from scipy.sparse import csr_array

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.linear.blocks import LowerBlocks
from fissura.linear.low_rank import LowRank
from fissura.linear.motions import prolong, restrict, restrict_product
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


@njit(inline="always")
def _expand(block, arm, unit, out):  # type: ignore[no-untyped-def]
    """``out += block P`` for the rigid motion P of a body with this arm."""
    for a in range(6):
        f0, f1, f2 = block[a, 0], block[a, 1], block[a, 2]
        out[a, 0] += f0
        out[a, 1] += f1
        out[a, 2] += f2
        # u = theta x r, so that f . u = theta . (r x f)
        out[a, 3] += (block[a, 3] + arm[1] * f2 - arm[2] * f1) * unit
        out[a, 4] += (block[a, 4] + arm[2] * f0 - arm[0] * f2) * unit
        out[a, 5] += (block[a, 5] + arm[0] * f1 - arm[1] * f0) * unit


@njit(inline="always")
def _insert(row, count, wanted):  # type: ignore[no-untyped-def]
    """Put a number among the first `count`, ascending, of a row; returns how many there are then."""
    p = count
    while p > 0 and row[p - 1] > wanted:
        p -= 1
    if p > 0 and row[p - 1] == wanted:
        return count
    for q in range(count, p, -1):
        row[q] = row[q - 1]
    row[p] = wanted
    return count + 1


@njit()
def _touched(indptr, indices, label):  # type: ignore[no-untyped-def]
    """Clusters in the block rows of K P, compressed: first, cluster."""
    n = len(label)
    begin = np.zeros(n + 1, dtype=np.int64)
    for i in range(n):
        for k in range(indptr[i], indptr[i + 1]):
            begin[i + 1] += 1
            if indices[k] != i:
                begin[indices[k] + 1] += 1
    for i in range(n):
        begin[i + 1] += begin[i]
    room, count = np.empty(begin[n], dtype=np.int32), np.zeros(n, dtype=np.int64)
    for i in range(n):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            count[i] = _insert(room[begin[i] :], count[i], label[j])
            if j != i:
                count[j] = _insert(room[begin[j] :], count[j], label[i])
    first = np.zeros(n + 1, dtype=np.int64)
    for i in range(n):
        first[i + 1] = first[i] + count[i]
    cluster = np.empty(first[n], dtype=np.int32)
    for i in range(n):
        for k in range(count[i]):
            cluster[first[i] + k] = room[begin[i] + k]
    return first, cluster


@njit(inline="always")
def _find(first, cluster, body, wanted):  # type: ignore[no-untyped-def]
    k = first[body]
    while cluster[k] != wanted:
        k += 1
    return k


@njit(nogil=True)
def _condense(begin, end, indptr, indices, blocks, label, arm, unit, first, cluster, out):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            _expand(blocks[k], arm[j], unit, out[_find(first, cluster, i, label[j])])
            if j != i:
                _expand(blocks[k].T, arm[i], unit, out[_find(first, cluster, j, label[i])])


@njit()
def _coarse_pattern(bodies, of_cluster, first, cluster, coupled):  # type: ignore[no-untyped-def]
    """Block columns on and right of the diagonal of ``P^T K P``, compressed; `coupled` clusters all see each other."""
    clusters = len(of_cluster) - 1
    seen = np.full(clusters, -1)
    is_coupled = np.zeros(clusters, dtype=np.bool_)
    is_coupled[coupled] = True
    indptr = np.zeros(clusters + 1, dtype=np.int64)
    columns = np.empty(len(cluster) + len(coupled) * len(coupled), dtype=np.int32)
    total = 0
    for c in range(clusters):
        begin = total
        for m in range(of_cluster[c], of_cluster[c + 1]):
            i = bodies[m]
            for k in range(first[i], first[i + 1]):
                d = cluster[k]
                if d >= c and seen[d] != c:
                    seen[d] = c
                    columns[total] = d
                    total += 1
        if is_coupled[c]:
            for d in coupled:
                if d >= c and seen[d] != c:
                    seen[d] = c
                    columns[total] = d
                    total += 1
        for k in range(begin + 1, total):  # by insertion: there are few
            d, m = columns[k], k
            while m > begin and columns[m - 1] > d:
                columns[m] = columns[m - 1]
                m -= 1
            columns[m] = d
        indptr[c + 1] = total
    return indptr, columns[:total].copy()


@njit()
def _coarse_blocks(bodies, of_cluster, first, cluster, product, arm, unit, indptr, columns, out):  # type: ignore[no-untyped-def]
    where = np.empty(len(indptr) - 1, dtype=np.int64)
    for c in range(len(indptr) - 1):
        for k in range(indptr[c], indptr[c + 1]):
            where[columns[k]] = k
        for m in range(of_cluster[c], of_cluster[c + 1]):
            i = bodies[m]
            r0, r1, r2 = arm[i]
            for k in range(first[i], first[i + 1]):
                if cluster[k] < c:
                    continue
                block = out[where[cluster[k]]]
                for d in range(6):
                    f0, f1, f2 = product[k, 0, d], product[k, 1, d], product[k, 2, d]
                    block[0, d] += f0
                    block[1, d] += f1
                    block[2, d] += f2
                    block[3, d] += (product[k, 3, d] + r1 * f2 - r2 * f1) * unit
                    block[4, d] += (product[k, 4, d] + r2 * f0 - r0 * f2) * unit
                    block[5, d] += (product[k, 5, d] + r0 * f1 - r1 * f0) * unit


@njit()
def _upper_entries(block_indptr, columns, blocks, indptr, indices, data):  # type: ignore[no-untyped-def]
    entry = 0
    for c in range(len(block_indptr) - 1):
        for p in range(6):
            indptr[6 * c + p] = entry
            for k in range(block_indptr[c], block_indptr[c + 1]):
                for q in range(p if columns[k] == c else 0, 6):
                    indices[entry] = 6 * columns[k] + q
                    data[entry] = blocks[k, p, q]
                    entry += 1
    indptr[-1] = entry


def _sum(parts: list[FloatArray]) -> FloatArray:
    """Sum of parts in their order, in the first one."""
    for part in parts[1:]:
        parts[0] += part
    return parts[0]


class CoarseSpace:
    """Rigid motions of clusters, ``u_i = u_c + theta_c x (x_i - x_c)`` and ``theta_i = theta_c``, as a matrix P.

    The unknowns of a cluster are ``u_c`` and ``theta_c`` times the typical size of a cluster, lengths both.

    Parameters
    ----------
    form : LowerBlocks
        Lower triangle of the stiffness matrix K.
    blocks : (k, 6, 6) array
        Its blocks.
    x : (n, 3) array
        Nuclei in the order of `form`.
    label : (n,) array
        Cluster of each body, 0, 1, ... without gaps.
    low_rank : LowRank
        Part of K that has no blocks, in the order of `form`.
    threads : KernelThreads
        Threads that share the work on domains.
    """

    def __init__(
        self,
        form: LowerBlocks,
        blocks: FloatArray,
        x: FloatArray,
        label: IntArray,
        low_rank: LowRank | None = None,
        threads: KernelThreads = SINGLE_THREAD,
    ) -> None:
        self._threads, self._pieces = threads, form.pieces
        count = np.bincount(label)
        centre = np.stack([np.bincount(label, x[:, a]) for a in range(3)], axis=1) / count[:, None]
        self.clusters = len(count)
        self.label = label
        self.arm: FloatArray = x - centre[label]
        # Bodies of one cluster each have no arm; then any length will do.
        self.unit = 1.0 / (float(np.sqrt((self.arm**2).sum(axis=1).mean())) or 1.0)
        self._first, self._cluster = _touched(form.indptr, form.indices, label)
        self._product: FloatArray = np.zeros((len(self._cluster), 6, 6))  # K P, without its part of low rank
        rest = (blocks, label, self.arm, self.unit, self._first, self._cluster, self._product)
        threads.run(_condense, form.bounds, form.indptr, form.indices, *rest)
        SINGLE_THREAD.run(_condense, form.tail, form.indptr, form.indices, *rest)
        self._low_rank = LowRank.none() if low_rank is None else low_rank
        self._coupled: IntArray = np.unique(label[self._low_rank.bodies])
        self._low_rank_rows: FloatArray = self._restricted_rows()

    def _restricted_rows(self) -> FloatArray:
        """``R P`` on the clusters that rows of the part of low rank touch, (k, t, 6)."""
        bodies = self._low_rank.bodies
        label = np.searchsorted(self._coupled, self.label[bodies])
        out = np.zeros((len(self._low_rank), len(self._coupled), 6))
        for row, part in zip(self._low_rank.rows, out, strict=True):
            part[:] = restrict(0, len(label), len(part), label, self.arm[bodies], self.unit, row)
        return out

    def upper(self) -> csr_array:
        """Entries on and above the diagonal of the coarse matrix ``P^T K P``."""
        bodies = np.argsort(self.label, kind="stable")
        of_cluster = np.searchsorted(self.label[bodies], np.arange(self.clusters + 1))
        coupled = self._coupled
        block_indptr, columns = _coarse_pattern(bodies, of_cluster, self._first, self._cluster, coupled)
        blocks = np.zeros((len(columns), 6, 6))
        _coarse_blocks(
            bodies,
            of_cluster,
            self._first,
            self._cluster,
            self._product,
            self.arm,
            self.unit,
            block_indptr,
            columns,
            blocks,
        )
        for k, c in enumerate(coupled):
            row = slice(block_indptr[c], block_indptr[c + 1])
            places = block_indptr[c] + np.searchsorted(columns[row], coupled[k:])
            more = np.einsum("ra,rtb->tab", self._low_rank_rows[:, k], self._low_rank_rows[:, k:])
            blocks[places] += self._low_rank.stiffness * more
        size = 36 * len(columns) - 15 * self.clusters
        indptr, indices = np.empty(6 * self.clusters + 1, dtype=np.int32), np.empty(size, dtype=np.int32)
        data = np.empty(size)
        _upper_entries(block_indptr, columns, blocks, indptr, indices, data)
        return csr_array((data, indices, indptr), shape=(6 * self.clusters,) * 2)

    def restrict(self, r: FloatArray) -> FloatArray:
        """``P^T r``; (n, 6) -> (clusters, 6)."""
        return _sum(self._threads.run(restrict, self._pieces, self.clusters, self.label, self.arm, self.unit, r))

    def restrict_product(self, z: FloatArray) -> FloatArray:
        """``P^T K z``; (n, 6) -> (clusters, 6)."""
        rest = (self.clusters, self._first, self._cluster, self._product, z)
        out = _sum(self._threads.run(restrict_product, self._pieces, *rest))
        if len(self._low_rank):
            forces = self._low_rank.stiffness * self._low_rank.values(z)
            out[self._coupled] += np.einsum("r,rtd->td", forces, self._low_rank_rows)
        return out

    def add_motion(self, coarse: FloatArray, u: FloatArray) -> None:
        """Add ``P coarse`` to u; shapes (clusters, 6) and (n, 6)."""
        self._threads.run(prolong, self._pieces, self.label, self.arm, self.unit, coarse, u)
