"""Direct solution of matrices with a part of low rank that is not factorized (Woodbury 1950)."""

from collections.abc import Callable

import numpy as np
from scipy.linalg import lu_factor, lu_solve, qr

from fissura.arrays import FloatArray, IntArray
from fissura.linear.assembly import Pattern

Solve = Callable[[FloatArray], FloatArray]


class LowRankCorrection:
    """Corrects solutions for the part `low_rank` of a pattern.

    The structure may float without it. So what is factorized has a few springs instead, on as many unknowns as the
    part of low rank has rows; the correction takes them off again. Solutions are refined once.

    Parameters
    ----------
    form : Pattern
        Pattern with a part of low rank.
    """

    def __init__(self, form: Pattern) -> None:
        self._form, low_rank = form, form.low_rank
        dofs = (6 * low_rank.bodies[:, None] + np.arange(6)).ravel()
        # The unknowns that tell the rows apart best: to hold these holds what the rows hold.
        _, _, pivots = qr(low_rank.rows.reshape(len(low_rank), -1), mode="economic", pivoting=True)
        self._dofs: IntArray = np.sort(dofs[pivots[: len(low_rank)]])
        body, a = self._dofs // 6, self._dofs % 6
        self._entries: IntArray = form.start[body] + a * form.stride[body] + form.diagonal[body] + a
        columns = np.zeros((form.size, 2 * len(low_rank)))
        columns[dofs, : len(low_rank)] = low_rank.rows.reshape(len(low_rank), -1).T
        columns[self._dofs, np.arange(len(low_rank), 2 * len(low_rank))] = 1.0
        self._columns: FloatArray = columns
        self._data: FloatArray
        self._spring = 0.0

    def anchored(self, data: FloatArray) -> FloatArray:
        """Entries of the matrix that has springs in place of the part of low rank."""
        every = self._form.start + self._form.diagonal
        self._spring = float(np.median(np.abs(data[every])))
        out = data.copy()
        out[self._entries] += self._spring
        return out

    def prepare(self, data: FloatArray, solve: Solve) -> None:
        """Set up for the matrix with these entries, for which `solve` solves once it is anchored."""
        rank = len(self._form.low_rank)
        self._data = data
        self._moved: FloatArray = solve(self._columns)
        weights = np.repeat([1.0 / self._form.low_rank.stiffness, -1.0 / self._spring], rank)
        self._capacitance = lu_factor(np.diag(weights) + self._columns.T @ self._moved)

    def solve(self, right: FloatArray, solve: Solve) -> FloatArray:
        """Solve with the whole matrix; (6 n,) or (6 n, k)."""
        columns = right.reshape(self._form.size, -1)
        found = self._corrected(columns, solve)
        rest = columns - np.stack([self._form.product(self._data, u) for u in found.T.copy()], axis=1)
        found += self._corrected(rest, solve)
        return found.reshape(right.shape)

    def _corrected(self, right: FloatArray, solve: Solve) -> FloatArray:
        first = solve(right).reshape(right.shape)
        return first - self._moved @ lu_solve(self._capacitance, self._columns.T @ first)
