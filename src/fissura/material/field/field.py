"""A realisation of the random field: relative strength and fracture energy as functions of position."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case, Field
from fissura.errors import InputError
from fissura.machine.memory import within_memory
from fissura.material.field import limits
from fissura.material.field.covariance import covariance_named
from fissura.material.field.expansion import Expansion, expand
from fissura.material.field.grid import Accuracy
from fissura.material.field.marginal import Marginal, marginal_named
from fissura.specimen import domain_from_case


@dataclass(frozen=True)
class RandomField:
    """One realisation. It depends on position and seed only, never on a discretization.

    Attributes
    ----------
    gaussian : callable
        From points (n, 3) [m] to standard Gaussian values (n,), ``H^``.
    marginal : Marginal
        Distribution of the relative strength ``H``.
    accuracy : Accuracy
        Of the expansion.
    seed : int
        Seed of the realisation.
    gaussian_energy, marginal_energy : callable, Marginal or None
        The same for the fracture energy, where it has a field of its own; else it goes with ``H^2``.
    """

    gaussian: Callable[[FloatArray], FloatArray]
    marginal: Marginal
    accuracy: Accuracy
    seed: int
    gaussian_energy: Callable[[FloatArray], FloatArray] | None = None
    marginal_energy: Marginal | None = None

    def strength(self, x: FloatArray) -> FloatArray:
        """Relative strength ``H = F^-1(Phi(H^))``, mean 1, at points (n, 3) [m]; shape (n,)."""
        return _transformed(self.gaussian, self.marginal, x)

    def energy(self, x: FloatArray) -> FloatArray:
        """Relative fracture energy at points (n, 3) [m]: its own field, else ``H^2``; shape (n,)."""
        if self.gaussian_energy is None or self.marginal_energy is None:
            return np.square(self.strength(x))
        return _transformed(self.gaussian_energy, self.marginal_energy, x)

    def factors(self, x: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """Relative strength, and energy over its square where that is not 1 everywhere; shapes (n,)."""
        strength = self.strength(x)
        if self.gaussian_energy is None:
            return strength, None
        return strength, self.energy(x) / np.square(strength)


def _transformed(gaussian: Callable[[FloatArray], FloatArray], marginal: Marginal, x: FloatArray) -> FloatArray:
    out = np.empty(len(x))
    for start in range(0, len(x), limits.CHUNK_OF_POINTS):
        part = slice(start, start + limits.CHUNK_OF_POINTS)
        out[part] = marginal.from_gaussian(gaussian(x[part]))
    return out


@lru_cache(maxsize=2)
def _expanded(
    name: str,
    length: tuple[float, ...],
    nu: float | None,
    size: tuple[float, float, float],
    variance_error: float,
    spacing: float | None,
) -> Expansion:
    """The same for all realisations of a case, so kept for the next one."""
    return expand(covariance_named(name, length, nu), size, variance_error, spacing)


def field_from_case(case: Case) -> RandomField | None:
    """The realisation of a case's field; None for a case without one.

    Its numbers come from streams spawned from ``field.seed``, by default the seed of the case: placing nuclei, which
    draws from the seed itself, is not touched by them.

    Raises
    ------
    InputError
        A name that is not known, parameters that are not possible or do not belong together, more leading values
        than modes, or a correlation length that is too small.
    """
    part = case.field
    if part is None:
        return None
    with within_memory(
        "field.length", "the grid of the random field", "a longer correlation, or a larger field.spacing"
    ):
        return _realised(part, case)


def _realised(part: Field, case: Case) -> RandomField:
    marginal = _marginal(part)
    seed = case.seed if part.seed is None else part.seed
    bounds = domain_from_case(case).bounds
    low, (length, depth, thickness) = bounds[0], (bounds[1] - bounds[0]).tolist()
    size = (length, depth, thickness)
    expansion = _expanded(part.correlation, part.length, part.nu, size, part.variance_error, part.spacing)
    modes = expansion.accuracy.modes
    if len(part.leading) > modes:
        raise InputError("field.leading", f"{len(part.leading)} values, but the field has {modes} modes", "fewer")
    first, second = (np.random.default_rng(s) for s in np.random.SeedSequence(seed, spawn_key=(0,)).spawn(2))
    xi = first.standard_normal(modes)
    xi[expansion.leading(len(part.leading))] = part.leading
    gaussian = _moved(expansion.realisation(xi), low)
    if part.energy is None:
        return RandomField(gaussian, marginal, expansion.accuracy, seed)
    own = part.energy
    rho = own.cross_correlation
    mixed = rho * xi + np.sqrt(1.0 - rho * rho) * second.standard_normal(modes)
    energy = marginal_named(own.marginal, own.cov, "field.energy", shape=own.shape, graft=own.graft, lower=own.lower)
    return RandomField(gaussian, marginal, expansion.accuracy, seed, _moved(expansion.realisation(mixed), low), energy)


def _moved(gaussian: Callable[[FloatArray], FloatArray], low: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """A field over ``[low, low + size]`` from one over ``[0, size]``."""
    return lambda x: gaussian(x - low)


def _marginal(part: Field) -> Marginal:
    return marginal_named(part.marginal, part.cov, shape=part.shape, graft=part.graft, lower=part.lower)
