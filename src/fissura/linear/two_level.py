"""Deflated conjugate gradients for symmetric positive definite stiffness matrices, in two levels.

Incomplete Cholesky smooths what neighbouring bodies do; rigid motions of clusters of bodies, which it leaves slow, are
solved for exactly in every iteration (deflation in its variant A-DEF2: Tang, Nabben, Vuik & Erlangga 2009). Clusters do
not reach across broken contacts, so cracks do not slow it down. Supports that hold many bodies, a part of low rank, are
in the matrix and in the coarse space exactly; only the incomplete factor leaves them out.
"""

from collections.abc import Callable

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.contact import Kinematics
from fissura.linear import limits
from fissura.linear.assembly import Pattern
from fissura.linear.block_cholesky import IncompleteCholesky
from fissura.linear.blocks import (
    LowerBlocks,
    constant_part,
    held_bodies,
    lower_blocks,
    multiply,
    term_sizes,
)
from fissura.linear.clusters import bisected, body_weights, connected, intact, link_stiffness
from fissura.linear.coarse import CoarseSpace
from fissura.linear.coarse_solver import CoarseSolver
from fissura.linear.dissection import dissected_order
from fissura.linear.low_rank import LowRank
from fissura.linear.lower_assembly import assemble_lower
from fissura.linear.protocol import SingularMatrixError
from fissura.linear.vectors import advance, dot, turn
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


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
    threads : KernelThreads
        Threads that share the work.
    domains : int, optional
        Parts into which the work falls; by default what suits the number of bodies.

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
        tolerance: float = limits.TOLERANCE,
        max_iterations: int = limits.MOST_ITERATIONS,
        *,
        reference: FloatArray | None = None,
        threads: KernelThreads = SINGLE_THREAD,
        domains: int | None = None,
    ) -> None:
        self.form = form
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.factorizations = 0
        self.iterations = 0
        self.clusters = 0
        self.shift = 0.0
        held = held_bodies(form)
        # Narrow supports couple all bodies that they hold: at the end these are factorized exactly.
        self._threads = threads
        self._lower: LowerBlocks = lower_blocks(
            form, *dissected_order(form, held_bodies(form, low_rank=False), domains)
        )
        order = self._lower.order
        self._smoother = IncompleteCholesky(self._lower, threads)
        self._x: FloatArray = np.ascontiguousarray(x[order])
        self._group: IntArray = bisected(self._x, limits.CLUSTER, body_weights(self._lower, self._x))
        # A cluster of which only some bodies are held could not move, and would leave the others to the smoother.
        self._group[held[order]] += len(x)
        self._low_rank = LowRank(self._lower.place[form.low_rank.bodies], form.low_rank.rows, form.low_rank.stiffness)
        narrow = held_bodies(form, low_rank=False)[order]
        firm, diagonal = np.flatnonzero(narrow), self._lower.indptr[1:] - 1
        self._left_out: tuple[IntArray, FloatArray] = (
            firm,
            constant_part(form, self._lower.entries(diagonal[firm], 6)),
        )
        below = np.flatnonzero(self._lower.rows != self._lower.indices)
        self._ends = (self._lower.rows[below].astype(np.int32), self._lower.indices[below])
        # The stiffness of a support between bodies that it holds says nothing about their contact.
        self._held_links: IntArray = np.flatnonzero(narrow[self._ends[0]] & narrow[self._ends[1]])
        self._held_blocks: IntArray = below[self._held_links]
        self._held_constant: FloatArray = constant_part(form, self._lower.entries(self._held_blocks, 3))
        self._reference = None if reference is None else self._stiffness(self._lower.gather(reference))
        self._blocks: FloatArray | None = None
        self._storage: FloatArray | None = None
        self._coarse: CoarseSpace
        self._solver = CoarseSolver()

    def _stiffness(self, blocks: FloatArray) -> FloatArray:
        """Size of the contacts' stiffness against translation, without supports [N/m]."""
        out = link_stiffness(self._lower, blocks)
        own = blocks[self._held_blocks, :3, :3] - self._held_constant
        out[self._held_links] = np.sqrt(np.einsum("kad,kad->k", own, own))
        return out

    @property
    def tail(self) -> float:
        """Share of the bodies that belong to no domain."""
        return 1.0 - float(self._lower.bounds[-1]) / len(self._x)

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
        self._prepare(lambda out: self._lower.gather(data, out, self._threads))

    def factor_contacts(self, geometry: Kinematics, moduli: FloatArray) -> None:
        """Prepare the preconditioner for contacts with these moduli [Pa], (m, 3), and the constant part.

        Raises
        ------
        SingularMatrixError
            As `factor`.
        """
        self._prepare(lambda out: assemble_lower(geometry, self.form, self._lower, moduli, out, self._threads))

    def _prepare(self, fill: Callable[[FloatArray | None], FloatArray]) -> None:
        """Prepare for the matrix of which a function gives the lower blocks, in the storage that is there."""
        self.factorizations += 1
        self._blocks = None
        try:
            self._storage = blocks = fill(self._storage)
        except ValueError as error:
            raise SingularMatrixError(str(error)) from error
        row, column = self._ends
        keep = intact(row, column, self._stiffness(blocks), self._reference, limits.INTACT)
        label = connected(self._group, row[keep], column[keep])
        self._coarse = CoarseSpace(self._lower, blocks, self._x, label, self._low_rank, self._threads)
        self.clusters = self._coarse.clusters
        try:
            self._smoother.factor(blocks, self._left_out)
            self._solver.factor(self._coarse.upper())
        except (RuntimeError, ValueError) as error:
            raise SingularMatrixError(str(error)) from error
        self.shift = self._smoother.share
        self._blocks = blocks

    def release(self) -> None:
        """Give back the memory of the latest preparation, until the next one; what follows from the pattern stays."""
        if self._blocks is not None:
            del self._coarse
        self._blocks = self._storage = None
        self._smoother.release()

    def solve(self, right: FloatArray, tolerance: float | None = None) -> FloatArray:
        """Solve for one right-hand side after another, to another tolerance if one is given; (n,) or (n, k).

        Raises
        ------
        SingularMatrixError
            No convergence within the allowed iterations, or the matrix turned out not to be positive definite.
        """
        self.iterations = 0
        columns = right.reshape(self.form.size, -1)
        found = np.empty((self.form.size, columns.shape[1]))
        for k, column in enumerate(columns.T):
            b = self._ordered(np.ascontiguousarray(column, dtype=np.float64))
            found[:, k] = self._given_back(self._solved(b, self.tolerance if tolerance is None else tolerance))
        return found.reshape(right.shape)

    def apply(self, right: FloatArray) -> FloatArray:
        """One cycle of the preconditioner, for iterations with other matrices; (n,) -> (n,)."""
        return self._given_back(self._preconditioned(self._ordered(right)))

    def product(self, u: FloatArray) -> FloatArray:
        """The matrix of the latest `factor` times a vector; (n,) -> (n,)."""
        return self._given_back(self._product(self._ordered(u)))

    def apply_with_product(self, right: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What `apply` gives, and the matrix times that; (n,) -> (n,) each."""
        found = self._preconditioned(self._ordered(right))
        return self._given_back(found), self._given_back(self._product(found))

    def _ordered(self, u: FloatArray) -> FloatArray:
        """A vector in the order of the lower blocks, (n, 6)."""
        return u.reshape(-1, 6).take(self._lower.order, axis=0)

    def _given_back(self, u: FloatArray) -> FloatArray:
        """A vector in the order of the bodies, (6 n,)."""
        return u.take(self._lower.place, axis=0).ravel()

    def _dot(self, a: FloatArray, b: FloatArray) -> float:
        return float(sum(self._threads.run(dot, self._lower.pieces, a, b)))

    def _product(self, u: FloatArray) -> FloatArray:
        assert self._blocks is not None
        out = multiply(self._lower, self._blocks, u, self._threads)
        self._low_rank.add_product(u, out)
        return out

    def _preconditioned(self, r: FloatArray) -> FloatArray:
        """Smoothed residual with its coarse error removed; symmetric where ``P^T r = 0``."""
        z = self._smoother.solve(r)
        rest = self._coarse.restrict(r) - self._coarse.restrict_product(z)
        self._coarse.add_motion(self._solver.solve(rest), z)
        return z

    def _as_good_as_direct(self, r: FloatArray, u: FloatArray, b: FloatArray) -> bool:
        """Whether u solves equations that differ by round-off only."""
        assert self._blocks is not None
        size = term_sizes(self._lower, self._blocks, u) + np.abs(b)
        self._low_rank.add_sizes(u, size)
        return bool(np.all(np.abs(r) <= limits.ROUND_OFF * size))

    def _solved(self, b: FloatArray, tolerance: float) -> FloatArray:
        u = np.zeros_like(b)
        r = b
        limit, error, left = None, np.inf, self.max_iterations
        for starts_left in range(limits.STARTS, -1, -1):
            coarse = np.zeros_like(b)
            self._coarse.add_motion(self._solver.solve(self._coarse.restrict(r)), coarse)
            energy = self._dot(r, coarse)
            u = u + coarse
            r = b - self._product(u)
            z = self._preconditioned(r)
            rho = self._dot(r, z)
            if not np.isfinite(energy + rho):
                break
            if limit is None:
                limit = tolerance**2 * (energy + rho)
            error = tolerance * np.sqrt((abs(energy) + abs(rho)) / limit) if limit > 0.0 else 0.0
            if error <= tolerance or (starts_left == 0 and self._as_good_as_direct(r, u, b)):
                return u
            if starts_left == 0 or left == 0:
                break
            p = z.copy()
            while rho > limits.ENDED * limit and left > 0:
                left -= 1
                self.iterations += 1
                product = self._product(p)
                curvature = self._dot(p, product)
                if not curvature > 0.0:
                    raise SingularMatrixError("the stiffness matrix is not positive definite")
                self._threads.run(advance, self._lower.pieces, rho / curvature, p, product, u, r)
                z = self._preconditioned(r)
                before, rho = rho, self._dot(r, z)
                self._threads.run(turn, self._lower.pieces, rho / before, z, p)
        raise SingularMatrixError(
            f"conjugate gradients do not converge: relative error {error:.1e} after {self.iterations} iterations"
        )
