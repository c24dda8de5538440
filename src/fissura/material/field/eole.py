"""Expansion optimal linear estimation with the eigenpairs of the whole grid (theory section 8).

Source: C.-C. Li, A. Der Kiureghian, *Optimal discretization of random fields*, J. Eng. Mech. 119 (1993) 1136-1154.
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh

from fissura.arrays import FloatArray, IntArray
from fissura.material.field import limits
from fissura.material.field.covariance import Covariance
from fissura.material.field.grid import Accuracy, Axes, counts, sample


class DenseExpansion:
    """``sum_k xi_k a_k(x)`` with ``a_k = psi_k . C(x, grid) / sqrt(lambda_k)``, divided by its own deviation.

    Modes are sorted by the variance ``a_k^2`` that they give to the specimen on average, and kept until the rest is
    below a limit.

    Parameters
    ----------
    covariance : Covariance
        Correlation of any kind.
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
        self._covariance = covariance
        axes: Axes = tuple(  # type: ignore[assignment]
            np.linspace(0.0, length, n) for length, n in zip(size, counts(size, spacing), strict=True)
        )
        self._nodes = _points(axes)
        values, vectors = eigh(covariance.between(self._nodes, self._nodes))
        kept = values > limits.ROUND_OFF * values[-1]
        values, vectors = values[kept][::-1], vectors[:, kept][:, ::-1]
        first = np.argmax(np.abs(vectors) > 1e-8, axis=0)  # signs must not be left to the library
        basis = vectors * (np.sign(vectors[first, np.arange(len(first))]) / np.sqrt(values))
        points, weights = _gauss(size, [len(nodes) for nodes in axes])
        captured = weights @ np.square(covariance.tabulated(points, self._nodes) @ basis)
        order = np.argsort(-np.round(captured, limits.DECIMALS), kind="stable")
        enough = np.flatnonzero(1.0 - np.cumsum(captured[order]) <= variance_error)
        order = order[: enough[0] + 1] if len(enough) else order
        self._basis = np.ascontiguousarray(basis[:, order])
        looks = covariance.tabulated(_points(sample(axes, limits.LOOKS)), self._nodes) @ self._basis
        steps = [float(nodes[1]) for nodes in axes]
        self.accuracy = Accuracy(
            "EOLE",
            len(self._nodes),
            len(order),
            (steps[0], steps[1], steps[2]),
            float(1.0 - captured[order].sum()),
            float(1.0 - np.square(looks).sum(axis=1).min()),
        )

    def leading(self, count: int) -> IntArray:
        """Which of the numbers of a realisation belong to the modes that vary most."""
        return np.arange(count)

    def realisation(self, xi: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """The field for given standard Gaussian numbers (modes,): from points (n, 3) to standard Gaussian (n,)."""
        rows = max(limits.CHUNK // len(self._nodes), 1)

        def at(x: FloatArray) -> FloatArray:
            out = np.empty(len(x))
            for start in range(0, len(x), rows):
                part = x[start : start + rows]
                modes = self._covariance.tabulated(part, self._nodes) @ self._basis
                out[start : start + rows] = (modes @ xi) / np.sqrt(np.einsum("pk,pk->p", modes, modes))
            return out

        return at


def _points(axes: Axes) -> FloatArray:
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _gauss(size: tuple[float, float, float], numbers: list[int]) -> tuple[FloatArray, FloatArray]:
    """Points in the box and weights, sum 1, for mean values."""
    rules = [np.polynomial.legendre.leggauss(min(2 * n, limits.MEANS)) for n in numbers]
    axes = [0.5 * side * (points + 1.0) for side, (points, _) in zip(size, rules, strict=True)]
    a, b, c = (0.5 * weights for _, weights in rules)
    return _points((axes[0], axes[1], axes[2])), np.einsum("i,j,k->ijk", a, b, c).ravel()
