"""External forces and measurements of one discretization: loads, weight, supports and gauges on its bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from fissura.arrays import FloatArray, IntArray
from fissura.equilibrium.attach import attach_rows, owners_of
from fissura.specimen import Conditions, Functional
from fissura.tessellation import Tessellation


@dataclass(frozen=True)
class Acting:
    """What acts on bodies and what is measured of them.

    Attributes
    ----------
    loads : tuple of Functional
        All L unit loads. The weight, the last one where there is gravity, acts at the centroids of bodies.
    supports : tuple of Functional
        What is held.
    bodies : tuple of (k,) arrays
        Bodies that own the points of every load and every functional of the supports.
    load_rows, support_rows, gauge_rows : (L, 6 n), (r, 6 n), (g, 6 n) sparse array
        Their coefficients, and those of gauges, on the unknowns of bodies.
    """

    loads: tuple[Functional, ...]
    supports: tuple[Functional, ...]
    bodies: tuple[IntArray, ...]
    load_rows: csr_array
    support_rows: csr_array
    gauge_rows: csr_array

    @classmethod
    def on(cls, conditions: Conditions, tessellation: Tessellation, whole: Tessellation) -> Acting:
        """Attach conditions to the bodies of a discretization.

        Parameters
        ----------
        conditions : Conditions
            Loads, supports and gauges.
        tessellation : Tessellation
            Bodies of the specimen.
        whole : Tessellation
            The same, with platens after them.
        """
        placed, supports = conditions.loads, conditions.supports
        owners = _owners((*placed, *supports), tessellation)
        of_loads, of_supports = owners[: len(placed)], owners[len(placed) :]
        if conditions.weight is not None:
            share = tessellation.volume / tessellation.volume.sum()
            everywhere = np.arange(len(tessellation))
            points = tessellation.centroids
            weight = Functional(points, share[:, None] * conditions.weight.direction, np.zeros_like(everywhere))
            placed, of_loads = (*placed, weight), (*of_loads, everywhere)
        return cls(
            placed,
            supports,
            (*of_loads, *of_supports),
            _rows(placed, whole, of_loads),
            _rows(supports, whole, of_supports),
            _rows(conditions.gauges, whole, _owners(conditions.gauges, tessellation)),
        )

    def points_and_forces(self, forces: FloatArray, held: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Bodies (k,), points (k, 3) [m] and values (k, 3) [N] of all external forces.

        Parameters
        ----------
        forces : (L,) array
            Sizes of the loads [N].
        held : (r,) array
            Sizes of the forces of supports [N].
        """
        both, sizes = (*self.loads, *self.supports), (*forces, *held)
        values = np.concatenate([f.coefficients * size for f, size in zip(both, sizes, strict=True)])
        return np.concatenate(self.bodies), np.concatenate([f.points for f in both]), values


def _owners(functionals: Sequence[Functional], tessellation: Tessellation) -> tuple[IntArray, ...]:
    """Bodies that own the points of each functional."""
    if not functionals:
        return ()
    ends = np.cumsum([len(f.points) for f in functionals])[:-1]
    return tuple(np.split(owners_of(functionals, tessellation), ends))


def _rows(functionals: Sequence[Functional], tessellation: Tessellation, owners: Sequence[IntArray]) -> csr_array:
    """Coefficients on the unknowns of bodies."""
    if not functionals:
        return csr_array((0, 6 * len(tessellation)))
    return attach_rows(functionals, tessellation, np.concatenate(owners))
