"""Assembly of secant stiffness matrices as lower block triangles, without the entries of the whole matrix.

These would take as much memory again as all else that an iterative solution needs.
"""

import numpy as np

from fissura.arrays import FloatArray
from fissura.contact import Kinematics
from fissura.kernels import njit
from fissura.linear.assembly import Pattern
from fissura.linear.blocks import LowerBlocks, constant_part, held_bodies
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


@njit(inline="always")
def _add_product(w0, w1, w2, rows, here, there, out):  # type: ignore[no-untyped-def]
    """``out += B_here^T diag(w) B_there`` of one contact, for the six columns of each body's part of its strains."""
    for p in range(6):
        s0, s1, s2 = w0 * rows[0, here + p], w1 * rows[1, here + p], w2 * rows[2, here + p]
        for q in range(6):
            out[p, q] += s0 * rows[0, there + q] + s1 * rows[1, there + q] + s2 * rows[2, there + q]


@njit(nogil=True, fastmath={"contract"})
def _assemble(  # type: ignore[no-untyped-def]
    begin, end, order, place, indptr, indices, bodies, rows, volume, first, adjacent, moduli, spin, out
):
    """Returns zero, or nan where an entry on the diagonal is not finite."""
    zero = 0.0
    for i in range(begin, end):
        body, last = order[i], indptr[i + 1] - 1
        out[indptr[i] : last + 1] = 0.0
        for k in range(first[body], first[body + 1]):
            c, side = adjacent[k] // 2, adjacent[k] % 2
            here, there = 6 * side, 6 - 6 * side
            w0, w1, w2 = volume[c] * moduli[c, 0], volume[c] * moduli[c, 1], volume[c] * moduli[c, 2]
            _add_product(w0, w1, w2, rows[c], here, here, out[last])
            for p in range(3, 6):
                out[last, p, p] += spin[c]
            j = place[bodies[c, 1 - side]]
            if j > i:
                continue
            m = indptr[i]
            while indices[m] != j:
                m += 1
            _add_product(w0, w1, w2, rows[c], here, there, out[m])
            for p in range(3, 6):
                out[m, p, p] -= spin[c]
        for p in range(6):
            zero += 0.0 * out[last, p, p]
            for q in range(p):
                out[last, q, p] = out[last, p, q]
    return zero


def _add_constant(form: Pattern, lower: LowerBlocks, out: FloatArray) -> None:
    """Add the constant part, which couples held bodies only."""
    held = held_bodies(form, low_rank=False)[lower.order]
    rows = np.flatnonzero(held)
    blocks = np.concatenate([np.arange(lower.indptr[i], lower.indptr[i + 1]) for i in rows] or [np.empty(0, np.int64)])
    blocks = blocks[held[lower.indices[blocks]]]
    out[blocks] += constant_part(form, lower.entries(blocks, 6))


def assemble_lower(
    geometry: Kinematics,
    form: Pattern,
    lower: LowerBlocks,
    moduli: FloatArray,
    out: FloatArray | None = None,
    threads: KernelThreads = SINGLE_THREAD,
) -> FloatArray:
    """Lower blocks of ``sum A L B^T diag(moduli) B`` plus the constant part; shape (k, 6, 6).

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    form : Pattern
        Their pattern.
    lower : LowerBlocks
        Its lower triangle for the order of bodies wanted.
    moduli : (m, 3) array
        Stiffness ``ds/de`` of the strain components of every contact [Pa].
    out : (k, 6, 6) array, optional
        Where to put them.
    threads : KernelThreads
        Threads that share the work.

    Raises
    ------
    ValueError
        A modulus is not finite.
    """
    out = np.empty((len(lower.indices), 6, 6)) if out is None else out
    where = (lower.order, lower.place, lower.indptr, lower.indices)
    contacts = (geometry.bodies, geometry.rows, geometry.volume, geometry.first, geometry.adjacent)
    if any(threads.run(_assemble, lower.pieces, *where, *contacts, moduli, form.spin, out)):  # nan is true
        raise ValueError("the stiffness matrix holds values that are not finite")
    _add_constant(form, lower, out)
    return out
