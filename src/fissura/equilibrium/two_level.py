"""Deflated conjugate gradients for symmetric positive definite stiffness matrices, in two levels.

Incomplete Cholesky smooths what neighbouring bodies do; rigid motions of clusters of bodies, which it leaves slow, are
solved for exactly in every iteration (deflation in its variant A-DEF2: Tang, Nabben, Vuik & Erlangga 2009). Clusters do
not reach across broken contacts, so cracks do not slow it down.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import csr_array, triu
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from fissura.equilibrium.assembly import Pattern
from fissura.equilibrium.block_cholesky import IncompleteCholesky, LowerBlocks, block_graph, lower_blocks, multiply
from fissura.equilibrium.clusters import CoarseSpace, bisected, connected, intact
from fissura.equilibrium.direct import SingularMatrixError

try:  # its wheels exist for x86 only
    import pymklpardiso
except ImportError:
    pymklpardiso = None

__all__ = ["TwoLevel", "held_bodies"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Bodies in the largest cluster: with more of them iterations grow, with fewer the coarse matrix.
_CLUSTER = 30

#: Share of its stiffness that a contact must keep to hold a cluster together.
_INTACT = 0.05

#: Residuals, relative to the sizes of all terms of their equations, that are round-off if restarts do not reduce them.
_ROUND_OFF = 1e-11

#: Starts from the true residual; more than one when the residual carried along has drifted from it.
_STARTS = 4


@njit(cache=True, fastmath={"reassoc", "contract"})
def _dot(a, b):  # type: ignore[no-untyped-def]
    s = 0.0
    for k in range(len(a)):
        for d in range(6):
            s += a[k, d] * b[k, d]
    return s


@njit(cache=True)
def _advance(step, p, product, u, r):  # type: ignore[no-untyped-def]
    for k in range(len(u)):
        for d in range(6):
            u[k, d] += step * p[k, d]
            r[k, d] -= step * product[k, d]


@njit(cache=True)
def _turn(ratio, z, p):  # type: ignore[no-untyped-def]
    for k in range(len(p)):
        for d in range(6):
            p[k, d] = z[k, d] + ratio * p[k, d]


def held_bodies(form: Pattern) -> NDArray[np.bool_]:
    """Bodies held by supports: those whose translations have a constant stiffness; shape (n,)."""
    row = np.searchsorted(form.indptr, form.fixed, side="right") - 1
    strong = (row % 6 < 3) & (form.fixed_values != 0.0)
    held = np.zeros(len(form.start), dtype=bool)
    held[row[strong] // 6] = True
    return held


def _ordered(form: Pattern) -> IntArray:
    """Bodies by reverse Cuthill-McKee, those held by supports last.

    The stiff blocks of supports couple all of their bodies with each other, so at the end they are factorized exactly.
    """
    n = len(form.start)
    row, column, _ = block_graph(form)
    held = held_bodies(form)
    free = ~(held[row] & held[column])
    graph = csr_array((np.ones(int(free.sum()), dtype=np.int8), (row[free], column[free])), shape=(n, n))
    order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int64)
    return np.concatenate([order[~held[order]], order[held[order]]])


class _CoarseSolver:
    """Direct solver for the coarse matrix, whose pattern changes with the clusters."""

    def __init__(self, matrix: csr_array) -> None:
        self._pardiso: Any = None
        if pymklpardiso is not None:
            upper = csr_array(triu(matrix, format="csr"))
            upper.sort_indices()
            self._pardiso = pymklpardiso.PardisoSolver(upper, pymklpardiso.MTYPE_REAL_SYM_POSDEF, {1: 3})
        else:
            self._lu = splu(
                matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for a vector per cluster; (clusters, 6) -> (clusters, 6)."""
        flat = right.ravel()
        found = self._lu.solve(flat) if self._pardiso is None else self._pardiso.solve(flat)
        return np.asarray(found, dtype=np.float64).reshape(-1, 6)


class TwoLevel:
    """Iterative solver with the interface of the direct ones, for symmetric positive definite matrices only.

    Errors are measured in energy: an iteration ends when the energy of the error, estimated by the preconditioner, is
    `tolerance` squared times that of the solution. This does not depend on the units of forces and moments. Where
    round-off forbids that, as with pieces that hardly hold together, a solution of equations that differ by round-off
    is accepted, which is what direct solvers give.

    Parameters
    ----------
    form : Pattern
        Pattern of all matrices to come.
    x : (n, 3) array
        Nuclei [m].
    tolerance : float
        Error relative to the solution, in the energy norm.
    max_iterations : int
        Iterations after which a solution is given up.
    reference : (z,) array, optional
        Entries of the undamaged matrix, to tell broken contacts by; without it they are told by comparison with their
        neighbours.

    Attributes
    ----------
    factorizations : int
        Calls of `factor`.
    iterations : int
        Iterations of the latest `solve`, of all its right-hand sides together.
    clusters : int
        Clusters of the latest `factor`.
    shift : float
        Share of the diagonal that the latest incomplete factorization needed to be positive definite.
    """

    def __init__(
        self,
        form: Pattern,
        x: FloatArray,
        tolerance: float = 1e-8,
        max_iterations: int = 500,
        *,
        reference: FloatArray | None = None,
    ) -> None:
        self.form = form
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.factorizations = 0
        self.iterations = 0
        self.clusters = 0
        self.shift = 0.0
        self._lower: LowerBlocks = lower_blocks(form, _ordered(form))
        self._smoother = IncompleteCholesky(self._lower)
        self._x: FloatArray = np.ascontiguousarray(x[self._lower.order])
        self._group: IntArray = np.empty(len(x), dtype=np.int64)
        for number, bodies in enumerate(bisected(self._x, _CLUSTER)):
            self._group[bodies] = number
        # A cluster of which only some bodies are held could not move, and would leave the others to the smoother.
        self._group[held_bodies(form)[self._lower.order]] += len(x)
        constant = np.zeros(len(form.indices))
        constant[form.fixed] = form.fixed_values
        rows = self._lower.rows
        self._links: IntArray = np.flatnonzero(rows != self._lower.indices)
        self._ends: tuple[IntArray, IntArray] = (rows[self._links], self._lower.indices[self._links])
        fixed = self._lower.gather(constant)
        self._constant: FloatArray = fixed[self._links, :3, :3]
        self._diagonal: IntArray = self._lower.indptr[1:] - 1
        self._constant_diagonal: FloatArray = fixed[self._diagonal]
        self._reference = None if reference is None else self._stiffness(self._lower.gather(reference))
        self._blocks: FloatArray | None = None
        self._coarse: CoarseSpace
        self._solver: _CoarseSolver

    def _stiffness(self, blocks: FloatArray) -> FloatArray:
        """Size of the contacts' stiffness against translation, without supports [N/m]."""
        own = blocks[self._links, :3, :3] - self._constant
        return np.asarray(np.sqrt(np.einsum("kad,kad->k", own, own)), dtype=np.float64)

    @property
    def cluster_of(self) -> IntArray:
        """Cluster of each body, shape (n,)."""
        out = np.empty(len(self._x), dtype=np.int64)
        out[self._lower.order] = self._coarse.label
        return out

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Prepare the preconditioner for the matrix with these entries.

        Raises
        ------
        ValueError
            `symmetric` is False.
        SingularMatrixError
            The matrix is not positive definite, as far as this can be told without solving.
        """
        if not symmetric:
            raise ValueError("conjugate gradients solve symmetric matrices only")
        if not np.isfinite(data).all():
            raise SingularMatrixError("the stiffness matrix holds values that are not finite")
        self.factorizations += 1
        self._blocks = None
        blocks = self._lower.gather(data)
        row, column = self._ends
        keep = intact(row, column, self._stiffness(blocks), self._reference, _INTACT)
        label = connected(self._group, row[keep], column[keep])
        self._coarse = CoarseSpace(self._lower, blocks, self._x, label)
        self.clusters = self._coarse.clusters
        try:
            self._smoother.factor(blocks, blocks[self._diagonal] - self._constant_diagonal)
            self._solver = _CoarseSolver(self._coarse.matrix())
        except (RuntimeError, ValueError) as error:
            raise SingularMatrixError(str(error)) from error
        self.shift = self._smoother.share
        self._blocks = blocks

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one right-hand side after another; (n,) or (n, k).

        Raises
        ------
        SingularMatrixError
            No convergence within the allowed iterations, or the matrix turned out not to be positive definite.
        """
        self.iterations = 0
        columns = right.reshape(self.form.size, -1)
        found = np.empty((self.form.size, columns.shape[1]))
        order = self._lower.order
        for k, column in enumerate(columns.T):
            b = np.ascontiguousarray(column, dtype=np.float64).reshape(-1, 6)
            solution = np.empty_like(b)
            solution[order] = self._solved(b[order])
            found[:, k] = solution.ravel()
        return found.reshape(right.shape)

    def apply(self, right: FloatArray) -> FloatArray:
        """One cycle of the preconditioner, for iterations with other matrices; (n,) -> (n,)."""
        order = self._lower.order
        out = np.empty((len(order), 6))
        out[order] = self._preconditioned(right.reshape(-1, 6)[order])
        return out.ravel()

    def product(self, u: FloatArray) -> FloatArray:
        """The matrix of the latest `factor` times a vector; (n,) -> (n,)."""
        order = self._lower.order
        out = np.empty((len(order), 6))
        out[order] = self._product(u.reshape(-1, 6)[order])
        return out.ravel()

    def _product(self, u: FloatArray) -> FloatArray:
        assert self._blocks is not None
        return multiply(self._lower, self._blocks, u)

    def _preconditioned(self, r: FloatArray) -> FloatArray:
        """Smoothed residual with its coarse error removed; symmetric where ``P^T r = 0``."""
        z = self._smoother.solve(r)
        rest = self._coarse.restrict(r) - self._coarse.restrict_product(z)
        self._coarse.add_motion(self._solver.solve(rest), z)
        return z

    def _as_good_as_direct(self, r: FloatArray, u: FloatArray, b: FloatArray) -> bool:
        """Whether u solves equations that differ by round-off only."""
        assert self._blocks is not None
        size = multiply(self._lower, np.abs(self._blocks), np.abs(u)) + np.abs(b)
        return bool(np.all(np.abs(r) <= _ROUND_OFF * size))

    def _solved(self, b: FloatArray) -> FloatArray:
        u = np.zeros_like(b)
        r = b
        limit, error, left = None, np.inf, self.max_iterations
        for starts_left in range(_STARTS, -1, -1):
            coarse = np.zeros_like(b)
            self._coarse.add_motion(self._solver.solve(self._coarse.restrict(r)), coarse)
            energy = _dot(r, coarse)
            u = u + coarse
            r = b - self._product(u)
            z = self._preconditioned(r)
            rho = _dot(r, z)
            if not np.isfinite(energy + rho):
                break
            if limit is None:
                limit = self.tolerance**2 * (energy + rho)
            error = self.tolerance * np.sqrt((abs(energy) + abs(rho)) / limit) if limit > 0.0 else 0.0
            if error <= self.tolerance or (starts_left == 0 and self._as_good_as_direct(r, u, b)):
                return u
            if starts_left == 0 or left == 0:
                break
            p = z.copy()
            while rho > 0.5 * limit and left > 0:
                left -= 1
                self.iterations += 1
                product = self._product(p)
                curvature = _dot(p, product)
                if not curvature > 0.0:
                    raise SingularMatrixError("the stiffness matrix is not positive definite")
                _advance(rho / curvature, p, product, u, r)
                z = self._preconditioned(r)
                before, rho = rho, _dot(r, z)
                _turn(rho / before, z, p)
        raise SingularMatrixError(
            f"conjugate gradients do not converge: relative error {error:.1e} after {self.iterations} iterations"
        )
