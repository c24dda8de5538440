"""Which nuclei own material in which convex cells: those whose bodies reach it without a jump.

Where a piece in a convex cell borders on a nucleus that has no piece there which open faces connect with its own cell
(it lies behind a notch, or round a corner), that nucleus is excluded from the cell, and the bodies that it had cut are
clipped again. So every facet stays the bisector of its two nuclei.
"""

import numpy as np

from fissura.arrays import BoolArray, IntArray
from fissura.tessellation.clipped import NONE, Clipped, Setting, clipped
from fissura.tessellation.limits import RETURNS


def _keys(n: int, cell: IntArray, nucleus: IntArray) -> IntArray:
    return cell * n + nucleus


def _known(pieces: IntArray, seen: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Sorted keys of all pieces, and keys of what is seen, row by row."""
    return np.sort(_keys(n, pieces[:, 1], pieces[:, 0])), _keys(n, seen[:, 1], seen[:, 2])


def _in(keys: IntArray, many: IntArray) -> BoolArray:
    """Which keys are among many sorted ones."""
    if not len(many):
        return np.zeros(len(keys), np.bool_)
    out: BoolArray = many[np.minimum(np.searchsorted(many, keys), len(many) - 1)] == keys
    return out


def settled(first: Clipped, setting: Setting) -> Clipped:
    """Bodies with all exclusions, a function of those without any.

    Exclusions are found in rounds. A body that grows may come to reach a cell from which its nucleus had been excluded;
    the nucleus is then admitted again, three times at most, so that the rounds end. After that its body ends in a
    ledge there, as where a rule of the cell does not admit it.

    Parameters
    ----------
    first : Clipped
        All bodies without exclusions.
    setting : Setting
        What they were clipped in.
    """
    n = len(setting.x)
    now, redone = first, np.zeros(n, np.bool_)
    excluded, barred = NONE, NONE
    returns: dict[int, int] = {}
    while True:
        pieces, seen = first.pieces, first.seen
        if redone.any():
            pieces = np.concatenate([pieces[~redone[pieces[:, 0]]], now.pieces])
            seen = np.concatenate([seen[~redone[seen[:, 0]]], now.seen])
        here, key = _known(pieces, seen, n)
        new = np.unique(key[~_in(key, here)])
        back = np.setdiff1d(excluded[_in(excluded, here)], barred)
        if not len(new) and not len(back):
            break
        for returning in back.tolist():
            returns[returning] = returns.get(returning, 0) + 1
        again = np.array([key for key in back.tolist() if returns[key] > RETURNS], np.int64)
        back = np.setdiff1d(back, again)
        barred = np.union1d(barred, again)
        excluded = np.setdiff1d(np.union1d(excluded, new), back)
        affected = np.zeros(n, np.bool_)
        affected[seen[_in(key, new), 0]] = True
        affected[again % n] = True
        reach2 = np.where(redone, now.reach2, first.reach2)
        for nucleus in np.unique(back % n):
            affected |= ((setting.x - setting.x[nucleus]) ** 2).sum(axis=1) <= reach2
        found = clipped(affected, setting, excluded, barred)
        now = now.merged(redone & ~affected, np.arange(n), found) if redone.any() else found
        redone |= affected
    return first.merged(~redone, np.arange(n), now) if redone.any() else first
