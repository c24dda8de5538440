"""Weighted sums of point displacements: what supports hold, loads act on and gauges measure (theory section 6).

They belong to the specimen, never to bodies: a :class:`Functional` knows points and coefficients only, and is
attached to whichever bodies own its points in a discretization.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.specimen.place import Place


@dataclass(frozen=True)
class Functional:
    """A weighted sum of point displacements, ``sum_k coefficients[k] . u(points[k])``.

    As a load it is the work-conjugate set of point forces.

    Attributes
    ----------
    points : (k, 3) array
        Points on the surface [m].
    coefficients : (k, 3) array
        Weights of the displacement components.
    cells : (k,) array
        The convex cell of the specimen behind each point.
    platen : int or None
        The platen to which the points belong; None for points of the specimen.
    """

    points: FloatArray
    coefficients: FloatArray
    cells: IntArray
    platen: int | None = None

    @property
    def middle(self) -> FloatArray:
        """Mean of the points, weighted by the sizes of their coefficients, shape (3,) [m]."""
        return np.average(self.points, axis=0, weights=np.linalg.norm(self.coefficients, axis=1))

    def __add__(self, other: Functional) -> Functional:
        return Functional(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.coefficients, other.coefficients]),
            np.concatenate([self.cells, other.cells]),
        )

    def __rmul__(self, factor: float) -> Functional:
        return replace(self, coefficients=factor * self.coefficients)

    def __sub__(self, other: Functional) -> Functional:
        return self + -1.0 * other


def mean_displacement(place: Place, direction: FloatArray) -> Functional:
    """Mean displacement of a place along a direction.

    Parameters
    ----------
    place : Place
        Points on the surface.
    direction : (3,) or (k, 3) array
        Unit vector, or one for each point.
    """
    return Functional(place.points, place.weights[:, None] * np.asarray(direction, float), place.cells)


def mean_rotation(place: Place, unit: FloatArray) -> Functional | None:
    """Mean rotation of a place about a line through its centroid, times its radius of gyration [m].

    None when the place has no extent beside that line.
    """
    arm = place.points - place.centroid
    lever = np.cross(unit, arm)
    inertia = float(place.weights @ np.einsum("ka,ka->k", lever, lever))
    if inertia <= 1e-18:
        return None
    return Functional(place.points, place.weights[:, None] * lever / np.sqrt(inertia), place.cells)
