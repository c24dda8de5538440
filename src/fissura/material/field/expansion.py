"""Which expansion represents a field, and on what grid."""

import logging
from collections.abc import Callable
from typing import Protocol

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.errors import InputError
from fissura.material.field import limits
from fissura.material.field.circulant import CirculantExpansion, local_error, torus
from fissura.material.field.covariance import Covariance
from fissura.material.field.eole import DenseExpansion
from fissura.material.field.grid import Accuracy, counts
from fissura.material.field.separable import SeparableExpansion

_log = logging.getLogger(__name__)


class Expansion(Protocol):
    """A Gaussian field as a function of position and of independent standard Gaussian numbers."""

    accuracy: Accuracy

    def leading(self, count: int) -> IntArray:
        """Which of the numbers of a realisation belong to the modes that vary most."""
        ...

    def realisation(self, xi: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """The field for given numbers (modes,): from points (n, 3) to standard Gaussian values (n,)."""
        ...


def expand(
    covariance: Covariance,
    size: tuple[float, float, float],
    variance_error: float = 0.01,
    spacing: float | None = None,
) -> Expansion:
    """Choose the expansion of a field over a box, by size and by what its covariance allows.

    Parameters
    ----------
    covariance : Covariance
        Correlation and its lengths.
    size : tuple of float
        The box [m].
    variance_error : float, optional
        Limit on the variance error averaged over the box, before the pointwise variance is corrected.
    spacing : float, optional
        Of the grid [m]; by default a third of the correlation lengths, and finer where the variance error needs it.

    Returns
    -------
    Expansion
        Its error is above the limit only where the grid would have to be too large; a warning is logged then.

    Raises
    ------
    InputError
        The correlation lengths, or the spacing, are too small for the box, or the spacing too large for the lengths.
    """
    steps = covariance.length * limits.SPACING if spacing is None else np.full(3, spacing)
    most = limits.SEPARABLE if covariance.model.separable else limits.DENSE
    small = SeparableExpansion if covariance.model.separable else DenseExpansion
    finer = steps
    while np.prod(counts(size, finer), dtype=float) <= most:
        found: Expansion = small(covariance, size, finer, variance_error)
        if spacing is not None or found.accuracy.mean <= variance_error:
            return _looked_at(found, variance_error, covariance, spacing)
        finer = finer * limits.SHRINK
    found = _embedded(covariance, size, variance_error, steps, spacing)
    return _looked_at(found, variance_error, covariance, spacing)


def _embedded(
    covariance: Covariance,
    size: tuple[float, float, float],
    variance_error: float,
    steps: FloatArray,
    spacing: float | None,
) -> Expansion:
    """Circulant embedding, on a finer grid while the error is too large and the grid is not."""

    def nodes(steps: FloatArray) -> float:
        return float(np.prod(torus(covariance, size, steps, limits.COUNTED), dtype=float))

    if nodes(steps) > limits.MOST:
        key, value = ("field.length", covariance.length.min()) if spacing is None else ("field.spacing", spacing)
        least = float(value) * (nodes(steps) / limits.MOST) ** (1.0 / 3.0)
        raise InputError(
            key,
            f"{float(value):g} m would take a grid of {nodes(steps):.2g} nodes in this specimen",
            f"about {least:.2g} m or more, for at most {limits.MOST:.2g} nodes",
        )
    while spacing is None and local_error(covariance, steps)[0] > variance_error:
        if nodes(steps * limits.SHRINK) > limits.MOST_FINER:
            break
        steps = steps * limits.SHRINK
    return CirculantExpansion(covariance, size, steps)


def _looked_at(expansion: Expansion, limit: float, covariance: Covariance, spacing: float | None) -> Expansion:
    """The expansion, after a warning where its error is above the limit.

    Raises
    ------
    InputError
        There are points for which its grid knows nothing of the field.
    """
    found = expansion.accuracy
    if spacing is not None and found.largest > limits.NOTHING_LEFT:
        length = float(covariance.length.min())
        raise InputError(
            "field.spacing",
            f"{spacing:g} m: nothing is left of a field of correlation length {length:g} m between nodes so far apart",
            f"about {length:g} m or less, better a third of that",
        )
    if found.mean > limit:
        _log.warning(
            "the variance error of the field is %.2g %% on average, above field.variance_error = %.2g %%: it is"
            " smooth below its grid spacing of %.3g mm (variance is corrected, short-range correlation is not)",
            100.0 * found.mean,
            100.0 * limit,
            1e3 * min(found.spacing),
        )
    return expansion
