"""Clusters of neighbouring bodies that hold together."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fissura.equilibrium.blocks import LowerBlocks

__all__ = ["bisected", "connected", "intact", "link_stiffness"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
AnyIntArray = NDArray[np.integer[Any]]


@njit(cache=True)
def _select(key, points, begin, end, cut):  # type: ignore[no-untyped-def]
    """Reorder points so that those before `cut` have the smaller keys (Hoare 1961)."""
    low, high = begin, end - 1
    while low < high:
        pivot = key[points[(low + high) // 2]]
        i, j = low, high
        while i <= j:
            while key[points[i]] < pivot:
                i += 1
            while key[points[j]] > pivot:
                j -= 1
            if i <= j:
                points[i], points[j] = points[j], points[i]
                i += 1
                j -= 1
        if cut <= j:
            high = j
        elif cut >= i:
            low = i
        else:
            return


@njit(cache=True)
def _bisected(x, size, label):  # type: ignore[no-untyped-def]
    n = len(x)
    points = np.arange(n)
    columns = np.ascontiguousarray(x.T)
    todo = [(0, n)]
    number = 0
    while len(todo) > 0:
        begin, end = todo.pop()
        parts = -(-(end - begin) // size)
        if parts <= 1:
            for k in range(begin, end):
                label[points[k]] = number
            number += 1
            continue
        along, longest = 0, -1.0
        for a in range(3):
            low, high = np.inf, -np.inf
            for k in range(begin, end):
                value = columns[a, points[k]]
                low, high = min(low, value), max(high, value)
            if high - low > longest:
                along, longest = a, high - low
        cut = begin + (end - begin) * (parts // 2) // parts
        _select(columns[along], points, begin, end, cut)
        todo.append((cut, end))
        todo.append((begin, cut))
    return number


def bisected(x: FloatArray, size: int) -> IntArray:
    """Groups of neighbouring points by recursive bisection across their longest extent.

    Counting points instead of measuring distances gives graded discretizations equal groups.

    Parameters
    ----------
    x : (n, 3) array
        Points.
    size : int
        Points in the largest group.

    Returns
    -------
    (n,) array
        Group of each point, numbered 0, 1, ...; groups that follow each other are neighbours more often than not.
    """
    label = np.empty(len(x), dtype=np.int64)
    if len(x):
        _bisected(np.ascontiguousarray(x), size, label)
    return label


@njit(cache=True)
def _link_stiffness(indptr, start, stride, data, out):  # type: ignore[no-untyped-def]
    link = 0
    for i in range(len(stride)):
        step = stride[i]
        for k in range(indptr[i], indptr[i + 1] - 1):
            s = 0.0
            for a in range(3):
                for d in range(3):
                    s += data[start[k] + a * step + d] ** 2
            out[link] = np.sqrt(s)
            link += 1


def link_stiffness(form: LowerBlocks, data: FloatArray) -> FloatArray:
    """Size of the stiffness against translation between two bodies [N/m], for every block below the diagonal; (m,)."""
    out = np.empty(len(form.indices) - len(form.order))
    _link_stiffness(form.indptr, form.start, form.stride, data, out)
    return out


def intact(
    row: AnyIntArray, column: AnyIntArray, stiffness: FloatArray, sound: FloatArray | None, share: float
) -> BoolArray:
    """Contacts stiff enough to hold bodies together.

    Parameters
    ----------
    row, column : (m,) arrays
        Bodies of each contact.
    stiffness : (m,) array
        Size of each contact's stiffness [N/m].
    sound : (m,) array or None
        The same before any damage; None: compare each contact with the stiffest one of its two bodies.
    share : float
        Smallest share of `sound` to be left.
    """
    if sound is None:
        most = np.zeros(max(row.max(initial=-1), column.max(initial=-1)) + 1)
        np.maximum.at(most, row, stiffness)
        np.maximum.at(most, column, stiffness)
        sound = np.maximum(most[row], most[column])
    return np.asarray(stiffness > share * sound)


def connected(label: IntArray, row: AnyIntArray, column: AnyIntArray) -> IntArray:
    """Split clusters into parts that hold together by the given contacts.

    Parameters
    ----------
    label : (n,) array
        Cluster of each body.
    row, column : (m,) arrays
        Bodies of each contact.

    Returns
    -------
    (n,) array
        Part of each body, numbered 0, 1, ... in the order of their first bodies.
    """
    n = len(label)
    inside = label[row] == label[column]
    links = coo_array((np.ones(int(inside.sum()), dtype=np.int8), (row[inside], column[inside])), shape=(n, n))
    _, part = connected_components(links.tocsr(), directed=False)
    return np.asarray(part, dtype=np.int64)
