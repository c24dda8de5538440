"""Compiled operations on the contacts with damage among all contacts."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit


@njit()
def put_rows(values, rows, out):  # type: ignore[no-untyped-def]
    """``out[rows] = values``; (k, 3), (k,) and (m, 3)."""
    for k in range(len(rows)):
        for a in range(3):
            out[rows[k], a] = values[k, a]


@njit()
def _changes(tangent, intact, moduli, damageable, least, chosen, change):  # type: ignore[no-untyped-def]
    count = 0
    for k in range(len(damageable)):
        size = 0.0
        for a in range(3):
            for b in range(3):
                entry = tangent[k, a, b]
                if a == b:
                    entry -= intact[k, a] * moduli[damageable[k], a]
                change[count, a, b] = entry
                size = max(size, abs(entry))
        if size > least:
            chosen[count] = damageable[k]
            count += 1
    return count


def changes(
    tangent: FloatArray, intact: FloatArray, moduli: FloatArray, damageable: IntArray, least: float
) -> tuple[IntArray, FloatArray]:
    """Where a tangent stiffness differs from a secant stiffness.

    Parameters
    ----------
    tangent : (k, 3, 3) array
        Tangent ``ds/de`` of the contacts with damage [Pa].
    intact : (k, 3) array
        Shares of the elastic moduli that the secant stiffness has.
    moduli : (m, 3) array
        Elastic stiffness of all contacts [Pa].
    damageable : (k,) array
        Contacts with damage.
    least : float
        Differences up to which entries are the same [Pa].

    Returns
    -------
    contacts : (c,) array
        Those of `damageable` where they differ.
    change : (c, 3, 3) array
        By how much [Pa].
    """
    chosen, change = np.empty(len(tangent), dtype=np.int64), np.empty_like(tangent)
    count = _changes(tangent, intact, moduli, damageable, least, chosen, change)
    return chosen[:count], change[:count]
