"""Reactions of supports, their balance with the load, and contacts of the bodies that carry either."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fissura.specimen import Conditions, Functional
    from fissura.tessellation import Tessellation

__all__ = ["Carried", "Reactions", "carried", "reactions"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Reactions:
    """What supports do to the specimen.

    Attributes
    ----------
    each : (s, 6) array
        Force [N] and moment about the middle of its place [N m] of every support.
    rest : (6,) array
        Force [N], and moment about the middle of the load's place [N m], that loads and reactions leave out of
        balance: zero but for the error of equilibrium.
    """

    each: FloatArray
    rest: FloatArray


def reactions(conditions: Conditions, sizes: FloatArray, loads: Sequence[Functional], forces: FloatArray) -> Reactions:
    """Resultants of the forces of supports.

    Parameters
    ----------
    conditions : Conditions
        Supports.
    sizes : (r,) array
        Force of every functional of the supports [N].
    loads : sequence of Functional
        Unit loads.
    forces : (L,) array
        Their sizes [N].
    """
    resultants = np.array([f.coefficients.sum(axis=0) for f in conditions.supports]).reshape(-1, 3)
    middles = np.array([place.middle for place in conditions.held]).reshape(-1, 3)
    owner = np.repeat(np.arange(len(conditions.held)), [place.functionals for place in conditions.held])
    moments = np.array(
        [
            np.cross(f.points - middles[k], f.coefficients).sum(axis=0)
            for k, f in zip(owner, conditions.supports, strict=True)
        ]
    ).reshape(-1, 3)
    each = np.zeros((len(middles), 6))
    np.add.at(each, owner, sizes[:, None] * np.hstack([resultants, moments]))
    middle, rest = conditions.middle, each.sum(axis=0)
    for load, force in zip(loads, forces, strict=True):
        acting = force * load.coefficients
        rest += np.hstack([acting.sum(axis=0), np.cross(load.points - middle, acting).sum(axis=0)])
    rest[3:] += np.cross(middles - middle, each[:, :3]).sum(axis=0)
    return Reactions(each, rest)


@dataclass(frozen=True)
class Carried:
    """Contacts of the bodies on which the load and the supports act.

    Attributes
    ----------
    places : tuple of (k,) arrays
        Contacts at every load, and at every support.
    everywhere : (k,) array
        All of them.
    """

    places: tuple[IntArray, ...]
    everywhere: IntArray

    def sums(self, values: FloatArray) -> FloatArray:
        """Sums of values of contacts, (m,) -> (L + s + 1,): at loads, at supports, and at all of them."""
        return np.array([values[contacts].sum() for contacts in (*self.places, self.everywhere)])


def carried(tessellation: Tessellation, bodies: list[IntArray]) -> Carried:
    """Contacts with one of some bodies.

    Parameters
    ----------
    tessellation : Tessellation
        Bodies and contacts.
    bodies : list of (k,) arrays
        Bodies on which each load and each support acts.
    """
    found = []
    for some in bodies:
        of = np.zeros(len(tessellation), dtype=np.bool_)
        of[some] = True
        found.append(np.flatnonzero(of[tessellation.contacts.bodies].any(axis=1)))
    return Carried(tuple(found), np.unique(np.concatenate(found)))
