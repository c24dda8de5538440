"""Covariance models: correlation as a function of the scaled distance ``d = |(x - y) / l|`` (theory section 8)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import gammaln, kve

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.kernels import njit
from fissura.material.field import limits


@dataclass(frozen=True)
class Model:
    """A family of correlation functions.

    Attributes
    ----------
    correlation : callable
        Takes scaled distances and the order ``nu`` (None if there is none); gives correlations.
    ordered : bool
        Whether it has an order ``nu``.
    separable : bool
        Whether it is the product of the correlations along the three axes.
    """

    correlation: Callable[[FloatArray, float | None], FloatArray]
    ordered: bool = False
    separable: bool = False


def squared_exponential(d: FloatArray, nu: float | None = None) -> FloatArray:
    """``exp(-d^2)``."""
    out: FloatArray = np.exp(-np.square(d))
    return out


def exponential(d: FloatArray, nu: float | None = None) -> FloatArray:
    """``exp(-d)``, which is Matérn's with ``nu = 1/2``."""
    out: FloatArray = np.exp(-np.asarray(d))
    return out


def matern(d: FloatArray, nu: float | None) -> FloatArray:
    """``2^(1-nu)/Gamma(nu) s^nu K_nu(s)`` with ``s = sqrt(2 nu) d``; tends to ``exp(-d^2/2)`` for large ``nu``."""
    assert nu is not None
    s = np.sqrt(2.0 * nu) * np.asarray(d, dtype=np.float64)
    out: FloatArray = np.ones(s.shape)
    away = s > 1e-10
    t = s[away]
    # In logarithms: factors of large nu overflow one by one, but not together.
    out[away] = np.exp((1.0 - nu) * np.log(2.0) - gammaln(nu) + nu * np.log(t) + np.log(kve(nu, t)) - t)
    out = np.minimum(out, 1.0)
    return out


#: Covariance models by the name that a case file gives.
MODELS: dict[str, Model] = {
    "squared-exponential": Model(squared_exponential, separable=True),
    "exponential": Model(exponential),
    "matern": Model(matern, ordered=True),
}


@njit()
def _look_up(x, nodes, inverse, table, step, out):  # type: ignore[no-untyped-def]
    """Correlation of every point with every node, from cubic pieces of a table."""
    last = len(table) - 1
    for p in range(len(x)):
        for k in range(len(nodes)):
            a = (x[p, 0] - nodes[k, 0]) * inverse[0]
            b = (x[p, 1] - nodes[k, 1]) * inverse[1]
            c = (x[p, 2] - nodes[k, 2]) * inverse[2]
            s = np.sqrt(a * a + b * b + c * c) * step
            i = int(min(s, last + 1.0))
            if i > last:
                out[p, k] = 0.0
            else:
                t = s - i
                out[p, k] = ((table[i, 0] * t + table[i, 1]) * t + table[i, 2]) * t + table[i, 3]


@dataclass(frozen=True)
class Covariance:
    """A correlation function with its lengths, along the axes.

    Attributes
    ----------
    model : Model
        The family.
    length : (3,) array
        Correlation lengths along x, y, z [m].
    nu : float or None
        Order, where the family has one.
    name : str
        Name of the family.
    """

    model: Model
    length: FloatArray
    nu: float | None = None
    name: str = ""

    def of(self, d: Any) -> FloatArray:
        """Correlation at scaled distances, any shape."""
        return self.model.correlation(np.asarray(d, dtype=np.float64), self.nu)

    def between(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Correlation of points x (n, 3) with points y (m, 3), exact; shape (n, m)."""
        return self.of(np.linalg.norm((x[:, None] - y) / self.length, axis=2))

    def tabulated(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """The same from a table of cubic pieces, some 100 times faster for Bessel functions.

        Within 1e-9 of the exact values, but for ``nu < 1/2`` right beside a point, where the correlation has a
        vertical slope.
        """
        out = np.empty((len(x), len(y)))
        table, step = self._table
        _look_up(np.ascontiguousarray(x), np.ascontiguousarray(y), 1.0 / self.length, table, step, out)
        return out

    @cached_property
    def _table(self) -> tuple[FloatArray, float]:
        from scipy.interpolate import CubicSpline  # few runs need it

        knots = np.linspace(0.0, self.reach(limits.NO_CORRELATION), limits.INTERVALS + 1)
        pieces = CubicSpline(knots, self.of(knots))
        width = knots[1]
        return np.ascontiguousarray((pieces.c * width ** np.arange(3, -1, -1)[:, None]).T), float(1.0 / width)

    def reach(self, level: float) -> float:
        """Scaled distance at which the correlation has fallen to a level."""
        far = 1.0
        while self.of(far) > level:
            far *= 2.0
        low, high = 0.0, far
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.of(middle) > level else (low, middle)
        return high


def covariance_named(name: str, length: tuple[float, ...], nu: float | None = None) -> Covariance:
    """The covariance of a case.

    Parameters
    ----------
    name : str
        Key of `MODELS`.
    length : tuple of float
        One correlation length, or three along the axes [m].
    nu : float, optional
        Order, for models that have one.

    Raises
    ------
    InputError
        Unknown name; an order that is missing, too large, or given where there is none.
    """
    model = MODELS.get(name)
    if model is None:
        raise InputError("field.correlation", f"{name!r} is not known", ", ".join(sorted(MODELS)))
    if model.ordered and nu is None:
        raise InputError("field.nu", f"missing, but {name} correlation needs it", "a number such as 1.5")
    if not model.ordered and nu is not None:
        raise InputError("field.nu", f"{name} correlation has none", 'only with correlation = "matern"')
    if nu is not None and not 0.0 < nu <= limits.LARGEST_ORDER:
        raise InputError(
            "field.nu", f"{nu:g} is not possible", f"a number above 0 and at most {limits.LARGEST_ORDER:g}"
        )
    lengths = np.array(length if len(length) == 3 else length * 3, dtype=np.float64)
    return Covariance(model, lengths, nu, name)
