"""Conjugate gradients with smoothed aggregation of the library PyAMG, the general method that `two_level` must beat.

Near-null space: the six rigid motions. Prolongation by energy minimization (Olson, Schroder & Tuminaro 2011). Supports
enter the hierarchy softened: they are five orders stiffer than contacts and couple bodies across aggregates, which
would double or triple the iterations. Conjugate gradients see the matrix as it is.
"""

import numpy as np
from scipy.sparse import bsr_matrix

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.linear import limits
from fissura.linear.assembly import Pattern
from fissura.linear.krylov import dot
from fissura.linear.protocol import SingularMatrixError

try:
    import pyamg
except ImportError:
    pyamg = None


def rigid_motions(x: FloatArray) -> FloatArray:
    """Translations and rotations of all bodies as one, about their centre; (n, 3) -> (6 n, 6)."""
    arm = x - x.mean(axis=0)
    out = np.tile(np.eye(6), (len(x), 1, 1))
    for p, q, s in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # u = theta x r
        out[:, p, 3 + q], out[:, p, 3 + s] = arm[:, s], -arm[:, q]
    return out.reshape(-1, 6)


class SmoothedAggregation:
    """Iterative solver for symmetric positive definite matrices; errors are measured in energy as in `TwoLevel`.

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

    Attributes
    ----------
    factorizations : int
        Calls of `factor`.
    iterations : int
        Iterations of the latest `solve`, of all its right-hand sides together.

    Raises
    ------
    InputError
        PyAMG is not installed.
    """

    def __init__(
        self,
        form: Pattern,
        x: FloatArray,
        tolerance: float = limits.TOLERANCE,
        max_iterations: int = limits.MOST_ITERATIONS,
    ) -> None:
        if pyamg is None:
            raise InputError(
                "solver.linear",
                "'amg' needs the package pyamg, which is not installed",
                "another solver, or `pip install 'fissura[amg]'`",
            )
        self.form = form
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.factorizations = 0
        self.iterations = 0
        self._motions = rigid_motions(x)

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Set up the hierarchy for the matrix with these entries.

        Raises
        ------
        ValueError
            `symmetric` is False.
        SingularMatrixError
            Values that are not finite, or a hierarchy that cannot be built.
        """
        if not symmetric:
            raise ValueError("conjugate gradients solve symmetric matrices only")
        if not np.isfinite(data).all():
            raise SingularMatrixError("the stiffness matrix holds values that are not finite")
        self.factorizations += 1
        form = self.form
        self._data = data
        own = form.start[:, None] + form.diagonal[:, None] + np.arange(6) * (form.stride[:, None] + 1)
        stiffness = np.median(data[own], axis=0)
        # Rotations as lengths: then entries are of one size.
        length = float(np.sqrt(stiffness[3:].mean() / stiffness[:3].mean()))
        self._scale: FloatArray = np.tile(np.repeat([1.0, 1.0 / length], 3), len(form.start))
        soft = data.copy()
        soft[form.fixed] -= (1.0 - limits.SOFT) * form.fixed_values
        soft[own[form.low_rank.bodies, :3]] += limits.SPRING * stiffness[:3]
        soft *= np.repeat(self._scale, np.diff(form.indptr))
        soft *= self._scale[form.indices]
        matrix = bsr_matrix(form.matrix(soft).tobsr((6, 6)))
        motions = self._motions / self._scale[:, None]
        sweeps = {"sweep": "symmetric"}
        try:
            self._hierarchy = pyamg.smoothed_aggregation_solver(
                matrix,
                B=motions / np.linalg.norm(motions, axis=0),
                symmetry="symmetric",
                smooth="energy",
                presmoother=("block_gauss_seidel", sweeps),
                postsmoother=("block_gauss_seidel", sweeps),
                coarse_solver="splu",
            )
        except (ValueError, RuntimeError, np.linalg.LinAlgError) as error:
            raise SingularMatrixError(str(error)) from error
        self._cycle = self._hierarchy.aspreconditioner(cycle="V")

    def apply(self, right: FloatArray) -> FloatArray:
        """One cycle of the hierarchy; (6 n,) -> (6 n,)."""
        found: FloatArray = self._scale * self._cycle.matvec(self._scale * right)
        return found

    def solve(self, right: FloatArray, tolerance: float | None = None) -> FloatArray:
        """Solve for one right-hand side after another; (6 n,) or (6 n, k).

        Raises
        ------
        SingularMatrixError
            No convergence within the allowed iterations, or the matrix turned out not to be positive definite.
        """
        self.iterations = 0
        columns = right.reshape(self.form.size, -1)
        found = np.stack(
            [self._solved(np.ascontiguousarray(column), tolerance or self.tolerance) for column in columns.T], axis=1
        )
        return found.reshape(right.shape)

    def _solved(self, right: FloatArray, tolerance: float) -> FloatArray:
        u, r = np.zeros_like(right), right.copy()
        z = self.apply(r)
        p, rho = z, dot(r, z)
        for _ in range(self.max_iterations):
            if 0.0 <= rho <= tolerance**2 * dot(u, right):
                return u
            self.iterations += 1
            product = self.form.product(self._data, p)
            curvature = dot(p, product)
            if not (curvature > 0.0 and rho > 0.0):
                if rho == 0.0:
                    return u
                break
            u += rho / curvature * p
            r -= rho / curvature * product
            z = self.apply(r)
            before, rho = rho, dot(r, z)
            p = z + rho / before * p
        raise SingularMatrixError(f"conjugate gradients do not converge after {self.iterations} iterations")
