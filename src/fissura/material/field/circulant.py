"""Fields on large grids: circulant embedding on the grid, linear estimation from its nearest nodes between them.

The covariance matrix of a regular grid on a torus is circulant: the Fourier transform gives its eigenvalues, and a
realisation, at the cost of sorting. The torus is wider than the specimen by the distance at which the correlation has
died out. Between nodes the field is the best linear estimate from the 4 x 4 x 4 nearest ones, which is the expansion of
`DenseExpansion` on those nodes with all their modes.

Source: C. R. Dietrich, G. N. Newsam, *Fast and exact simulation of stationary Gaussian processes through circulant
embedding of the covariance matrix*, SIAM J. Sci. Comput. 18 (1997) 1088-1107.
"""

from collections.abc import Callable

import numpy as np
import scipy.fft

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.material.field import limits
from fissura.material.field.covariance import Covariance
from fissura.material.field.grid import Accuracy


def _stencil(spacing: FloatArray) -> FloatArray:
    offsets = np.arange(limits.STENCIL) - (limits.STENCIL // 2 - 1)
    return np.stack(np.meshgrid(*(offsets * step for step in spacing), indexing="ij"), axis=-1).reshape(-1, 3)


def _estimator(covariance: Covariance, spacing: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Nodes around a cell at the origin (s, 3) [m], and the inverse of their correlation matrix."""
    nodes = _stencil(spacing)
    inverse = np.asarray(np.linalg.inv(covariance.between(nodes, nodes)), dtype=np.float64)
    return nodes, inverse


def _axis_estimator(covariance: Covariance, step: float) -> FloatArray:
    """Inverse of the correlation matrix of the nodes along an axis, of scaled spacing."""
    offsets = np.arange(limits.STENCIL) * step
    inverse = np.linalg.inv(covariance.of(np.abs(offsets[:, None] - offsets)))
    return np.asarray(inverse, dtype=np.float64)


def local_error(covariance: Covariance, spacing: FloatArray) -> tuple[float, float]:
    """Variance error of the estimate between nodes, mean and largest over a cell."""
    looks = np.linspace(0.0, 1.0, limits.LOOKS_IN_CELL)
    weights = np.ones(limits.LOOKS_IN_CELL)
    weights[[0, -1]] = 0.5
    weights /= weights.sum()
    if covariance.model.separable:
        kept = []
        for step in spacing / covariance.length:
            offsets = np.arange(limits.STENCIL) - (limits.STENCIL // 2 - 1.0)
            c = covariance.of(np.abs(looks[:, None] - offsets) * step)
            kept.append(np.einsum("ps,st,pt->p", c, _axis_estimator(covariance, step), c))
        variance = np.einsum("i,j,k->ijk", *kept)
    else:
        nodes, inverse = _estimator(covariance, spacing)
        points = np.stack(np.meshgrid(looks, looks, looks, indexing="ij"), axis=-1).reshape(-1, 3) * spacing
        c = covariance.between(points, nodes)
        variance = np.einsum("ps,ps->p", c @ inverse, c).reshape((limits.LOOKS_IN_CELL,) * 3)
    mean = np.einsum("ijk,i,j,k->", variance, weights, weights, weights)
    return float(1.0 - mean), float(1.0 - variance.min())


def torus(covariance: Covariance, size: tuple[float, float, float], spacing: FloatArray, closes: float) -> list[int]:
    """Nodes along each axis of a torus whose images are correlated by at most ``closes``; fast to transform."""
    apart = covariance.reach(closes) * covariance.length
    return [
        scipy.fft.next_fast_len(int(np.ceil((side + gap) / step)) + limits.STENCIL)
        for side, gap, step in zip(size, apart, spacing, strict=True)
    ]


@njit()
def _cells(x, inverse, cells, place, within):  # type: ignore[no-untyped-def]
    """First node of the stencil of each point, and position in the cell [cells]."""
    for p in range(len(x)):
        for a in range(3):
            s = x[p, a] * inverse[a]
            i = min(max(int(np.floor(s)), 0), cells[a] - 1)
            place[p, a] = i
            within[p, a] = s - i


@njit(fastmath={"reassoc", "contract"})
def _estimate_separable(place, weights, scale, values, out):  # type: ignore[no-untyped-def]
    """Estimate from weights (3, n, 4) along the axes; scale (3, n) are their variances."""
    for p in range(len(out)):
        i, j, k = place[p]
        total = 0.0
        for a in range(weights.shape[2]):
            row = 0.0
            for b in range(weights.shape[2]):
                inner = 0.0
                for c in range(weights.shape[2]):
                    inner += values[i + a, j + b, k + c] * weights[2, p, c]
                row += weights[1, p, b] * inner
            total += weights[0, p, a] * row
        out[p] = total / np.sqrt(scale[0, p] * scale[1, p] * scale[2, p])


@njit(fastmath={"reassoc", "contract"})
def _estimate(place, correlation, inverse, values, stencil, out):  # type: ignore[no-untyped-def]
    """Estimate from correlations (n, s) with the nodes around."""
    near = np.empty(len(inverse))
    for p in range(len(out)):
        i, j, k = place[p]
        s = 0
        for a in range(stencil):
            for b in range(stencil):
                for c in range(stencil):
                    near[s] = values[i + a, j + b, k + c]
                    s += 1
        value, variance = 0.0, 0.0
        for s in range(len(inverse)):
            w = 0.0
            for t in range(len(inverse)):
                w += inverse[s, t] * correlation[p, t]
            value += w * near[s]
            variance += w * correlation[p, s]
        out[p] = value / np.sqrt(variance)


class CirculantExpansion:
    """A stationary field on a torus of grid nodes, estimated between them, divided by its own deviation.

    Parameters
    ----------
    covariance : Covariance
        Correlation of any kind.
    size : tuple of float
        The box [m].
    spacing : (3,) array
        Spacing of the grid along the axes [m].
    """

    def __init__(self, covariance: Covariance, size: tuple[float, float, float], spacing: FloatArray) -> None:
        self._covariance = covariance
        self._spacing = np.asarray(spacing, dtype=np.float64)
        self._cells = np.array([max(int(np.ceil(side / step)), 1) for side, step in zip(size, spacing, strict=True)])
        closes = limits.CLOSES
        while True:
            spectrum = self._spectrum_of(torus(covariance, size, spacing, closes))
            negative = -float(spectrum[spectrum < 0.0].sum())
            if negative <= limits.NEGATIVE * float(spectrum.sum()) or closes <= limits.CLOSED:
                break
            closes *= 0.1
        np.maximum(spectrum, 0.0, out=spectrum)
        spectrum /= spectrum.mean()  # variance 1 at nodes
        self._spectrum = spectrum
        self._nodes, self._inverse = _estimator(covariance, spacing)
        self._axes = [_axis_estimator(covariance, step) for step in spacing / covariance.length]
        mean, largest = local_error(covariance, self._spacing)
        steps = self._spacing.tolist()
        self.accuracy = Accuracy(
            "circulant embedding", spectrum.size, spectrum.size, (steps[0], steps[1], steps[2]), mean, largest
        )

    def _spectrum_of(self, shape: list[int]) -> FloatArray:
        """Eigenvalues of the covariance matrix on a torus."""
        a, b, c = (
            np.minimum(np.arange(n), n - np.arange(n)) * step / length
            for n, step, length in zip(shape, self._spacing, self._covariance.length, strict=True)
        )
        d = np.sqrt(np.square(a)[:, None, None] + np.square(b)[:, None] + np.square(c))
        # The correlation is even, so that half of it, and half of the eigenvalues, tell everything.
        half = scipy.fft.rfftn(self._covariance.of(d), overwrite_x=True).real
        mirrored = half[:, :, (shape[2] - 1) // 2 : 0 : -1]
        return np.concatenate([half, mirrored], axis=2)

    def leading(self, count: int) -> IntArray:
        """Which of the numbers of a realisation belong to the modes that vary most."""
        spectrum = self._spectrum.ravel()
        order: IntArray = np.argsort(-np.round(spectrum / spectrum.max(), 9), kind="stable")
        return order[:count]

    def realisation(self, xi: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """The field for given standard Gaussian numbers (modes,): from points (n, 3) to standard Gaussian (n,).

        Eigenvectors are ``cos + sin``, real and orthogonal.
        """
        shape = self._spectrum.shape
        waves = np.sqrt(self._spectrum / self._spectrum.size) * xi.reshape(shape)
        top = self._cells + limits.STENCIL - 1
        transformed = scipy.fft.fftn(waves, overwrite_x=True)[: top[0], : top[1], : top[2]]
        values = np.ascontiguousarray(transformed.real - transformed.imag)
        inverse = 1.0 / self._spacing

        def at(x: FloatArray) -> FloatArray:
            out = np.empty(len(x))
            for start in range(0, len(x), limits.CHUNK_OF_CELLS):
                part = np.ascontiguousarray(x[start : start + limits.CHUNK_OF_CELLS])
                place, within = np.empty(part.shape, dtype=np.int64), np.empty(part.shape)
                _cells(part, inverse, self._cells, place, within)
                self._between(place, within, values, out[start : start + limits.CHUNK_OF_CELLS])
            return out

        return at

    def _between(self, place: IntArray, within: FloatArray, values: FloatArray, out: FloatArray) -> None:
        """Estimates at positions in cells."""
        if not self._covariance.model.separable:
            correlation = self._covariance.tabulated(within * self._spacing, self._nodes)
            _estimate(place, correlation, self._inverse, values, limits.STENCIL, out)
            return
        offsets = np.arange(limits.STENCIL) - (limits.STENCIL // 2 - 1.0)
        steps = self._spacing / self._covariance.length
        near = self._covariance.of(np.abs(within.T[:, :, None] - offsets) * steps[:, None, None])
        weights = near @ np.stack(self._axes)
        _estimate_separable(place, weights, np.einsum("aps,aps->ap", weights, near), values, out)
