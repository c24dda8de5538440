"""Assembly of stiffness matrices into a fixed pattern of 6x6 blocks."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from fissura.arrays import FloatArray, IntArray
from fissura.contact import Kinematics
from fissura.kernels import INNER, njit
from fissura.linear.low_rank import LowRank


@dataclass(frozen=True)
class Pattern:
    """Compressed rows of the stiffness matrix, fixed for one discretization.

    The six rows of body ``b`` follow each other; each holds the same blocks of six columns, so that entry ``(a, d)`` of
    block ``k`` lies at ``start[b] + a * stride[b] + 6 k + d``. Compressed sparse rows are made when they are asked for:
    iterative solution needs none.

    Attributes
    ----------
    start, stride : (n,) arrays
        Place of each body's first row, and length of its rows.
    neighbours : (z / 36,) array
        Body of each block's columns: those of body ``b`` are ``neighbours[start[b] // 36:start[b + 1] // 36]``,
        ascending.
    diagonal : (n,) array
        Offset ``6 k`` of the diagonal block.
    opposite : (2 m,) array
        Offset ``6 k`` of the block that couples a body with the other body of a contact, in the order of
        ``Kinematics.adjacent``.
    fixed : (y,) array
        Entries to which `fixed_values`, the constant part, are added.
    fixed_values : (y,) array
        Their values [N/m, N, N m].
    spin : (m,) array
        Constant stiffness of contacts against relative rotation [N m].
    low_rank : LowRank
        Part of the matrix that has no entries here, since it couples too many bodies.
    """

    start: IntArray
    stride: IntArray
    neighbours: NDArray[np.int32]
    diagonal: NDArray[np.int32]
    opposite: NDArray[np.int32]
    fixed: IntArray
    fixed_values: FloatArray
    spin: FloatArray
    low_rank: LowRank = field(default_factory=LowRank.none)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 6 * len(self.start)

    @property
    def entries(self) -> int:
        """Number of entries."""
        return 36 * len(self.neighbours)

    @cached_property
    def _rows(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        indptr, indices = np.empty(self.size + 1, dtype=np.int32), np.empty(self.entries, dtype=np.int32)
        _expanded(np.append(self.start // 36, len(self.neighbours)), self.neighbours, indptr, indices)
        return indptr, indices

    @property
    def indptr(self) -> NDArray[np.int32]:
        """First entry of each row of the matrix; (6 n + 1,)."""
        return self._rows[0]

    @property
    def indices(self) -> NDArray[np.int32]:
        """Column of each entry; (z,)."""
        return self._rows[1]

    def matrix(self, data: FloatArray) -> csr_array:
        """The matrix with the given entries, as scipy knows it, without its part `low_rank`."""
        return csr_array((data, self.indices, self.indptr), shape=(self.size, self.size))

    def product(self, data: FloatArray, u: FloatArray) -> FloatArray:
        """The whole matrix with the given entries times a vector; (6 n,) -> (6 n,)."""
        out: FloatArray = self.matrix(data) @ u
        self.low_rank.add_product(u.reshape(-1, 6), out.reshape(-1, 6))
        return out


@njit()
def _neighbours(bodies, first, adjacent, more_first, more, begin, out):  # type: ignore[no-untyped-def]
    """Bodies in the rows of every body, ascending and without repetitions; returns where each row ends."""
    n = len(first) - 1
    end = np.empty(n, dtype=np.int64)
    for b in range(n):
        last = begin[b]
        for k in range(first[b] - 1, first[b + 1] + more_first[b + 1] - more_first[b]):
            if k < first[b]:
                other = b
            elif k < first[b + 1]:
                other = bodies[adjacent[k] // 2, 1 - adjacent[k] % 2]
            else:
                other = more[more_first[b] + k - first[b + 1]]
            p = last
            while p > begin[b] and out[p - 1] > other:
                p -= 1
            if p > begin[b] and out[p - 1] == other:
                continue
            for q in range(last, p, -1):
                out[q] = out[q - 1]
            out[p] = other
            last += 1
        end[b] = last
    return end


@njit()
def _expanded(first, neighbours, indptr, indices):  # type: ignore[no-untyped-def]
    entry = 0
    for b in range(len(first) - 1):
        for a in range(6):
            indptr[6 * b + a] = entry
            for k in range(first[b], first[b + 1]):
                for d in range(6):
                    indices[entry] = 6 * neighbours[k] + d
                    entry += 1
    indptr[-1] = entry


@njit(**INNER)
def _place(neighbours, begin, end, wanted):  # type: ignore[no-untyped-def]
    """Place in an ascending row of the first neighbour that is not smaller than a number."""
    low, high = begin, end
    while low < high:
        middle = (low + high) >> 1
        if neighbours[middle] < wanted:
            low = middle + 1
        else:
            high = middle
    return low - begin


@njit()
def _offsets(first, neighbours, row, column):  # type: ignore[no-untyped-def]
    """Offset of the block of each row and column in the rows of its body."""
    out = np.empty(len(row), dtype=np.int32)
    for k in range(len(row)):
        out[k] = 6 * _place(neighbours, first[row[k]], first[row[k] + 1], column[k])
    return out


@njit()
def _opposites(bodies, owner_first, adjacent, first, neighbours):  # type: ignore[no-untyped-def]
    out = np.empty(len(adjacent), dtype=np.int32)
    for b in range(len(first) - 1):
        for k in range(owner_first[b], owner_first[b + 1]):
            other = bodies[adjacent[k] // 2, 1 - adjacent[k] % 2]
            out[k] = 6 * _place(neighbours, first[b], first[b + 1], other)
    return out


def pattern(
    geometry: Kinematics, constant: csr_array, spin: FloatArray | None = None, low_rank: LowRank | None = None
) -> Pattern:
    """Pattern for the contacts of a discretization and a constant part.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    constant : (6 n, 6 n) sparse array
        Stiffness that never changes, such as that of supports; symmetric.
    spin : (m,) array, optional
        Stiffness of contacts against relative rotation of their bodies [N m].
    low_rank : LowRank, optional
        Part of the matrix to keep apart.
    """
    n = len(geometry.first) - 1
    extra = constant.tocoo()
    keys = np.unique((extra.row // 6).astype(np.int64) * n + extra.col // 6)
    more_first = np.searchsorted(keys, np.arange(n + 1) * n)
    begin = geometry.first + more_first + np.arange(n + 1)  # each body, its contacts and what is constant
    room = np.empty(begin[-1], dtype=np.int32)
    end = _neighbours(geometry.bodies, geometry.first, geometry.adjacent, more_first, keys % n, begin[:-1], room)
    first = np.concatenate([[0], np.cumsum(end - begin[:-1])])
    if first[-1] < len(room):
        room = room[np.arange(first[-1]) + np.repeat(begin[:-1] - first[:-1], np.diff(first))]
    start, stride = 36 * first[:-1], 6 * np.diff(first)
    r, c = extra.row.astype(np.int64), extra.col.astype(np.int64)
    entry = start[r // 6] + (r % 6) * stride[r // 6] + _offsets(first, room, r // 6, c // 6) + c % 6
    fixed, where = np.unique(entry, return_inverse=True)
    return Pattern(
        start,
        stride,
        room,
        _offsets(first, room, np.arange(n), np.arange(n)),
        _opposites(geometry.bodies, geometry.first, geometry.adjacent, first, room),
        fixed,
        np.asarray(np.bincount(where, extra.data, len(fixed)), dtype=np.float64),
        np.zeros(len(geometry)) if spin is None else spin,
        LowRank.none() if low_rank is None else low_rank,
    )


@njit(fastmath={"contract"})
def _assemble(  # type: ignore[no-untyped-def]
    rows, volume, first, adjacent, tangent, spin, start, stride, diagonal, opposite, data
):
    scaled = np.empty((6, 3))
    for body in range(len(start)):
        own = start[body] + diagonal[body]
        for k in range(first[body], first[body + 1]):
            c, shift = adjacent[k] // 2, 6 * (adjacent[k] % 2)
            for p in range(6):
                for a in range(3):
                    t = 0.0
                    for b in range(3):
                        t += rows[c, b, shift + p] * tangent[c, b, a]
                    scaled[p, a] = t * volume[c]
            other = start[body] + opposite[k]
            for p in range(6):
                here, there = own + p * stride[body], other + p * stride[body]
                for q in range(6):
                    s, o = 0.0, 0.0
                    for a in range(3):
                        s += scaled[p, a] * rows[c, a, shift + q]
                        o += scaled[p, a] * rows[c, a, 6 - shift + q]
                    data[here + q] += s
                    data[there + q] += o
            for p in range(3, 6):
                data[own + p * stride[body] + p] += spin[c]
                data[other + p * stride[body] + p] -= spin[c]


def assemble(geometry: Kinematics, form: Pattern, tangent: FloatArray) -> FloatArray:
    """Entries of the stiffness matrix ``sum A L B^T (ds/de) B`` plus the constant part, in the order of the pattern.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    form : Pattern
        Their pattern.
    tangent : (m, 3, 3) array
        Stiffness ``ds/de`` of every contact [Pa].
    """
    data = np.zeros(form.entries)
    _assemble(
        geometry.rows,
        geometry.volume,
        geometry.first,
        geometry.adjacent,
        tangent,
        form.spin,
        form.start,
        form.stride,
        form.diagonal,
        form.opposite,
        data,
    )
    data[form.fixed] += form.fixed_values
    return data


def assemble_secant(geometry: Kinematics, form: Pattern, moduli: FloatArray) -> FloatArray:
    """Entries as of :func:`assemble` for contacts whose strain components are not coupled; moduli (m, 3) [Pa]."""
    tangent = np.zeros((len(moduli), 3, 3))
    tangent[:, range(3), range(3)] = moduli
    return assemble(geometry, form, tangent)


@njit()
def _add_spin(bodies, spin, u, out):  # type: ignore[no-untyped-def]
    for c in range(len(spin)):
        i, j = bodies[c, 0], bodies[c, 1]
        for a in range(3, 6):
            moment = spin[c] * (u[i, a] - u[j, a])
            out[i, a] += moment
            out[j, a] -= moment


def add_spin(geometry: Kinematics, spin: FloatArray, u: FloatArray, forces: FloatArray) -> None:
    """Add the moments of the constant stiffness of contacts against relative rotation to `forces`; both (n, 6)."""
    _add_spin(geometry.bodies, spin, u, forces)
