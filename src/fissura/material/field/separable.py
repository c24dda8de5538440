"""Expansion optimal linear estimation of a separable covariance: products of one-dimensional eigenpairs.

The covariance matrix of the grid is the Kronecker product of those along its axes, so its eigenvectors are products of
theirs; the eigenproblem costs next to nothing, and modes are evaluated by contraction along the axes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.material.field import limits
from fissura.material.field.covariance import Covariance
from fissura.material.field.grid import Accuracy, counts, sample


@dataclass(frozen=True)
class _Axis:
    """One-dimensional expansion.

    Attributes
    ----------
    nodes : (n,) array
        Coordinates of the grid [m].
    length : float
        Correlation length [m].
    basis : (n, m) array
        ``phi / sqrt(lambda)``, by variance given.
    captured : (m,) array
        Mean variance that each mode gives, descending.
    """

    nodes: FloatArray
    length: float
    basis: FloatArray
    captured: FloatArray

    @classmethod
    def of(cls, covariance: Covariance, length: float, size: float, n: int, negligible: float) -> _Axis:
        nodes = np.linspace(0.0, size, n)
        values, vectors = eigh(covariance.of(np.abs(nodes[:, None] - nodes) / length))
        kept = values > limits.ROUND_OFF * values[-1]
        values, vectors = values[kept][::-1], vectors[:, kept][:, ::-1]
        basis = vectors * (np.where(vectors[0] < 0.0, -1.0, 1.0) / np.sqrt(values))
        # Gauss points: their weighted sum is the mean to round-off.
        points, weights = np.polynomial.legendre.leggauss(min(limits.MEANS_OF_AXIS, 4 * n + 8))
        shares = np.square(covariance.of(np.abs(0.5 * size * (points[:, None] + 1.0) - nodes) / length) @ basis)
        captured = 0.5 * weights @ shares
        order = np.argsort(-captured, kind="stable")
        order = order[captured[order] > negligible]
        return cls(nodes, length, np.ascontiguousarray(basis[:, order]), captured[order])

    def modes(self, covariance: Covariance, x: FloatArray) -> FloatArray:
        """Values of the modes at coordinates x (p,); shape (p, m)."""
        return covariance.of(np.abs(x[:, None] - self.nodes) / self.length) @ self.basis


@njit(fastmath={"reassoc", "contract"})
def _contract(a, b, c, xi, counts, out):  # type: ignore[no-untyped-def]
    """Sum over kept modes at every point, over the square root of its variance."""
    total = np.empty(c.shape[1] + 1)
    for p in range(len(out)):
        total[0] = 0.0
        for k in range(c.shape[1]):
            total[k + 1] = total[k] + c[p, k] * c[p, k]
        value, variance = 0.0, 0.0
        for i in range(counts.shape[0]):
            row, spread = 0.0, 0.0
            for j in range(counts.shape[1]):
                n = counts[i, j]
                if n == 0:
                    break
                inner = 0.0
                for k in range(n):
                    inner += xi[i, j, k] * c[p, k]
                row += b[p, j] * inner
                spread += b[p, j] * b[p, j] * total[n]
            value += a[p, i] * row
            variance += a[p, i] * a[p, i] * spread
        out[p] = value / np.sqrt(variance)


class SeparableExpansion:
    """The same as `DenseExpansion` for a covariance that is a product along the axes.

    Parameters
    ----------
    covariance : Covariance
        Separable.
    size : tuple of float
        The box [m].
    spacing : (3,) array
        Largest spacing of the grid along the axes [m].
    variance_error : float
        Limit on the variance error averaged over the box; may be missed by a grid that is too wide.
    """

    def __init__(
        self, covariance: Covariance, size: tuple[float, float, float], spacing: FloatArray, variance_error: float
    ) -> None:
        assert covariance.model.separable
        self._covariance = covariance
        numbers = counts(size, spacing)
        axes = [
            _Axis.of(covariance, float(length), side, n, limits.NEGLIGIBLE * variance_error)
            for length, side, n in zip(covariance.length, size, numbers, strict=True)
        ]
        # The axis with most modes comes last, where the innermost loop runs.
        self._permutation = sorted(range(3), key=lambda a: (len(axes[a].captured), a))
        self._axes = [axes[a] for a in self._permutation]
        first, second, third = (axis.captured for axis in self._axes)
        captured = first[:, None, None] * second[:, None] * third
        order = np.argsort(-captured.ravel(), kind="stable")
        enough = np.flatnonzero(1.0 - np.cumsum(captured.ravel()[order]) <= variance_error)
        order = order[: enough[0] + 1] if len(enough) else order
        self._order: IntArray = order
        self._shape = captured.shape
        kept = np.zeros(captured.shape, dtype=bool)
        kept.flat[order] = True
        self._counts: IntArray = kept.sum(axis=2)
        looks = sample((self._axes[0].nodes, self._axes[1].nodes, self._axes[2].nodes), limits.LOOKS_OF_AXIS)
        a, b, c = (np.square(axis.modes(covariance, x)) for axis, x in zip(self._axes, looks, strict=True))
        largest = 1.0 - np.einsum("pi,qj,rk,ijk->pqr", a, b, c, kept.astype(float), optimize=True).min()
        steps = [float(axis.nodes[1]) for axis in axes]
        self.accuracy = Accuracy(
            "EOLE, separable",
            int(np.prod(numbers)),
            len(order),
            (steps[0], steps[1], steps[2]),
            float(1.0 - captured.ravel()[order].sum()),
            float(largest),
        )

    def leading(self, count: int) -> IntArray:
        """Which of the numbers of a realisation belong to the modes that vary most."""
        return np.arange(count)

    def realisation(self, xi: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """The field for given standard Gaussian numbers (modes,): from points (n, 3) to standard Gaussian (n,)."""
        core = np.zeros(self._shape)
        core.flat[self._order] = xi

        def at(x: FloatArray) -> FloatArray:
            out = np.empty(len(x))
            for start in range(0, len(x), limits.CHUNK_OF_AXES):
                part = x[start : start + limits.CHUNK_OF_AXES]
                a, b, c = (
                    axis.modes(self._covariance, part[:, column])
                    for axis, column in zip(self._axes, self._permutation, strict=True)
                )
                _contract(a, b, c, core, self._counts, out[start : start + limits.CHUNK_OF_AXES])
            return out

        return at
