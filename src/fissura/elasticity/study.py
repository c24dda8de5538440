"""Macroscopic constants over contact constants, sizes and seeds: mean, scatter, confidence, effect of the surface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import stdtrit

from fissura.arrays import FloatArray
from fissura.elasticity import limits
from fissura.elasticity.homogenise import Homogenisation
from fissura.elasticity.specimen import Prism
from fissura.elasticity.stiffness import anisotropy, isotropic_part
from fissura.tessellation.periodic import PeriodicCell

#: What is measured: periodic cells; prisms by gauges on their sides; prisms from end to end.
KINDS = ("periodic", "gauge", "ends")


@dataclass(frozen=True)
class Row:
    """Constants of one kind of structure, one size and one `alpha`, over seeds.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    alpha : float
        Tangential over normal stiffness of contacts.
    size : float
        Side of the cell or width of the prism in ``l_min``.
    bodies : float
        Mean number of bodies.
    E, nu : (s,) array
        Macroscopic over contact modulus, and Poisson's ratio, for each seed.
    anisotropy : float
        Mean anisotropy of the stiffness; nan for prisms.
    """

    kind: str
    alpha: float
    size: float
    bodies: float
    E: FloatArray
    nu: FloatArray
    anisotropy: float = np.nan

    @property
    def seeds(self) -> int:
        """Number of structures."""
        return len(self.E)


def spread(values: FloatArray) -> tuple[float, float, float]:
    """Mean, standard deviation, and half of the 95 % confidence interval of the mean (Student's distribution).

    The last two are nan for a single value.
    """
    if len(values) < 2:
        return float(values.mean()), np.nan, np.nan

    deviation = float(values.std(ddof=1))
    factor = float(stdtrit(len(values) - 1, 0.5 * (1.0 + limits.CONFIDENCE)))
    return float(values.mean()), deviation, factor * deviation / float(np.sqrt(len(values)))


@dataclass(frozen=True)
class LayerFit:
    """How a constant approaches that of the bulk: ``E = E_bulk (1 + c l_min / size)``.

    Attributes
    ----------
    E_bulk : float
        Limit of ``E_macro / E`` for small bodies.
    c : float
        Size of the surface's effect.
    E_bulk_error, c_error : float
        Their standard errors.
    """

    E_bulk: float
    c: float
    E_bulk_error: float
    c_error: float

    @classmethod
    def of(cls, sizes: FloatArray, E: FloatArray) -> LayerFit:
        """Least squares over structures, their scatter taken to go with the root of their volume.

        Parameters
        ----------
        sizes : (k,) array
            Sizes in ``l_min``, at least two different ones, and more structures than two.
        E : (k,) array
            Their values.
        """
        weight = sizes**1.5
        left = np.stack([weight, weight / sizes], axis=1)
        right = E * weight
        limit, slope = np.linalg.lstsq(left, right)[0]
        residual = right - left @ np.array([limit, slope])
        covariance = np.linalg.inv(left.T @ left) * float(residual @ residual) / (len(E) - 2)
        gradient = np.array([-slope / limit**2, 1.0 / limit])  # of c = slope / limit
        errors = np.sqrt([covariance[0, 0], gradient @ covariance @ gradient])
        return cls(float(limit), float(slope / limit), float(errors[0]), float(errors[1]))


@dataclass(frozen=True)
class Study:
    """All rows of a study.

    Attributes
    ----------
    rows : tuple of Row
        By kind, `alpha` and size.
    aspect : float
        Length over width of the prisms.
    """

    rows: tuple[Row, ...]
    aspect: float

    def of(self, kind: str, *, alpha: float | None = None, size: float | None = None) -> tuple[Row, ...]:
        """Rows of a kind, of one `alpha` or size if given."""
        return tuple(
            row for row in self.rows if row.kind == kind and alpha in (None, row.alpha) and size in (None, row.size)
        )

    @property
    def alphas(self) -> tuple[float, ...]:
        """All `alpha`, ascending."""
        return tuple(sorted({row.alpha for row in self.rows}))

    @property
    def sizes(self) -> tuple[float, ...]:
        """All sizes, ascending."""
        return tuple(sorted({row.size for row in self.rows}))

    def layer(self, kind: str, alpha: float) -> LayerFit | None:
        """Effect of the surface; None where there are too few sizes or structures to tell."""
        rows = self.of(kind, alpha=alpha)
        if len(rows) < 2 or sum(row.seeds for row in rows) < 3:
            return None
        sizes = np.repeat([row.size for row in rows], [row.seeds for row in rows])
        return LayerFit.of(sizes, np.concatenate([row.E for row in rows]))


def structure_seeds(count: int) -> range:
    """Seeds of the structures of a study."""
    return range(1, count + 1)


def study(
    alphas: Sequence[float],
    sizes: Sequence[float],
    seeds: Sequence[int],
    *,
    aspect: float = 2.0,
    on_structure: Callable[[int, int], None] | None = None,
) -> Study:
    """Compute macroscopic constants of periodic cells and prisms.

    Parameters
    ----------
    alphas : sequence of float
        Tangential over normal stiffness of contacts, above 0.
    sizes : sequence of float
        Sides of cells and widths of prisms in ``l_min``, at least 4.
    seeds : sequence of int
        One structure of each kind and size for each.
    aspect : float
        Length over width of the prisms.
    on_structure : callable, optional
        Called after every structure with how many are done, and how many there are.

    Returns
    -------
    Study
    """
    alphas, sizes = sorted(set(alphas)), sorted(set(sizes))
    rows: dict[tuple[str, float, float], Row] = {}
    done, total = 0, 2 * len(sizes) * len(seeds)

    def tell() -> None:
        nonlocal done
        done += 1
        if on_structure is not None:
            on_structure(done, total)

    for size in sizes:
        cells, prisms, counts = [], [], []
        for seed in seeds:
            cells.append(_cell(alphas, size, seed))
            tell()
            prism = Prism(size, aspect, 1.0, seed)
            counts.append(len(prism))
            prisms.append([prism.constants(alpha) for alpha in alphas])
            tell()
        numbers = np.array([values for _, values in cells])  # seed, alpha, (E, nu, anisotropy)
        for a, alpha in enumerate(alphas):
            E, nu, uneven = numbers[:, a].T
            bodies = float(np.mean([count for count, _ in cells]))
            rows["periodic", alpha, size] = Row("periodic", alpha, size, bodies, E, nu, float(uneven.mean()))
            found = [each[a] for each in prisms]
            nu = np.array([each.nu for each in found])
            for kind, E in (("gauge", [x.E_gauge for x in found]), ("ends", [x.E_whole for x in found])):
                rows[kind, alpha, size] = Row(kind, alpha, size, float(np.mean(counts)), np.array(E), nu)
    return Study(tuple(rows[key] for key in product(KINDS, alphas, sizes)), aspect)


def _cell(alphas: Sequence[float], size: float, seed: int) -> tuple[int, list[tuple[float, float, float]]]:
    """Bodies of a periodic cell, and for each alpha its modulus, Poisson's ratio and anisotropy."""
    cell = PeriodicCell.placed(size, 1.0, np.random.default_rng(np.random.SeedSequence(seed)))
    structure = Homogenisation(cell)
    out = []
    for alpha in alphas:
        stiffness = structure.stiffness(alpha)
        isotropic = isotropic_part(stiffness)
        out.append((isotropic.E, isotropic.nu, anisotropy(stiffness)))
    return len(cell), out
