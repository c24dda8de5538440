"""Clusters of neighbouring bodies that hold together."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.linear import limits
from fissura.linear.blocks import LowerBlocks

AnyIntArray = NDArray[np.integer[Any]]


@njit(**INNER)
def _cut(key, weight, points, begin, end, share):  # type: ignore[no-untyped-def]
    """Reorder points so that those before the returned place have the smaller keys, and `share` of the weight or less.

    Selection by halves (Hoare 1961). Neither side is empty.
    """
    low, high, before = begin, end - 1, 0.0
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
        left = middle = 0.0
        for k in range(low, j + 1):
            left += weight[points[k]]
        for k in range(j + 1, i):
            middle += weight[points[k]]
        if before + left >= share:
            high = j
        elif before + left + middle < share:
            low, before = i, before + left + middle
        else:
            low, high, before = j + 1, i - 1, before + left
            break
    while low <= high and before + weight[points[low]] <= share * (1.0 + 1e-12):
        before += weight[points[low]]
        low += 1
    return min(max(low, begin + 1), end - 1)


@njit()
def _bisected(columns, weight, most, points, todo, label):  # type: ignore[no-untyped-def]
    """Number groups of points, which are reordered; `todo` (n, 2) is room for those that are not yet small enough."""
    todo[0, 0], todo[0, 1] = 0, len(points)
    number, left = 0, 1
    while left > 0:
        left -= 1
        begin, end = todo[left, 0], todo[left, 1]
        total = 0.0
        for k in range(begin, end):
            total += weight[points[k]]
        parts = int(np.ceil(total / most * (1.0 - 1e-12)))
        if parts <= 1 or end - begin <= 1:
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
        cut = _cut(columns[along], weight, points, begin, end, total * (parts // 2) / parts)
        todo[left, 0], todo[left, 1] = cut, end
        todo[left + 1, 0], todo[left + 1, 1] = begin, cut
        left += 2
    return number


def bisected(x: FloatArray, most: float, weight: FloatArray | None = None) -> IntArray:
    """Groups of neighbouring points by recursive bisection across their longest extent.

    Parameters
    ----------
    x : (n, 3) array
        Points.
    most : float
        Weight of the largest group, as long as no single point weighs more.
    weight : (n,) array, optional
        Weight of each point, 1 by default.

    Returns
    -------
    (n,) array
        Group of each point, numbered 0, 1, ...; groups that follow each other are neighbours more often than not.
    """
    label = np.empty(len(x), dtype=np.int64)
    if len(x):
        weight = np.ones(len(x)) if weight is None else np.ascontiguousarray(weight, dtype=np.float64)
        columns, room = np.ascontiguousarray(x.T), np.empty((len(x) + 1, 2), dtype=np.int64)
        _bisected(columns, weight, float(most), np.arange(len(x)), room, label)
    return label


@njit()
def _reach(indptr, indices, x):  # type: ignore[no-untyped-def]
    """Mean distance of each point from those that it touches; zero where it touches none."""
    n = len(x)
    out, count = np.zeros(n), np.zeros(n)
    for i in range(n):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            if j != i:
                d = np.sqrt((x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2)
                out[i] += d
                out[j] += d
                count[i] += 1.0
                count[j] += 1.0
    for i in range(n):
        out[i] /= max(count[i], 1.0)
    return out


def body_weights(form: LowerBlocks, x: FloatArray) -> FloatArray:
    """Weights of bodies for bisection: the square root of their volume, 1 for the fine ones; (n,).

    Clusters of equal numbers of bodies would be very large where bodies are coarse, and slow to come to rest; clusters
    of equal volume would be single bodies there, and very many.

    Parameters
    ----------
    form : LowerBlocks
        Which bodies touch.
    x : (n, 3) array
        Nuclei in the order of `form` [m].
    """
    reach = _reach(form.indptr, form.indices, x)
    fine = float(np.quantile(reach, limits.FINE)) if len(reach) else 0.0
    return np.maximum(reach / fine, 1.0) ** 1.5 if fine > 0.0 else np.ones(len(x))


@njit()
def _link_stiffness(indptr, blocks, out):  # type: ignore[no-untyped-def]
    link = 0
    for i in range(len(indptr) - 1):
        for k in range(indptr[i], indptr[i + 1] - 1):
            s = 0.0
            for a in range(3):
                for d in range(3):
                    s += blocks[k, a, d] ** 2
            out[link] = np.sqrt(s)
            link += 1


def link_stiffness(form: LowerBlocks, blocks: FloatArray) -> FloatArray:
    """Size of the stiffness against translation between two bodies [N/m], for every block below the diagonal; (m,)."""
    out = np.empty(len(form.indices) - len(form.order))
    _link_stiffness(form.indptr, blocks, out)
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
