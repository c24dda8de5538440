"""Reactions of supports, their balance with the load, and contacts of the bodies that carry either."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from fissura.equilibrium.response import Response
    from fissura.equilibrium.system import System


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


def reactions(system: System, response: Response, load: float) -> Reactions:
    """Resultants of the forces of supports, and what they and all loads leave out of balance under a load factor."""
    conditions, sizes = system.conditions, system.supports.forces(response.u)
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
    for one, force in zip(system.acting.loads, system.forces(load), strict=True):
        acting = force * one.coefficients
        rest += np.hstack([acting.sum(axis=0), np.cross(one.points - middle, acting).sum(axis=0)])
    rest[3:] += np.cross(middles - middle, each[:, :3]).sum(axis=0)
    return Reactions(each, rest)


def carrying(system: System) -> tuple[IntArray, ...]:
    """Contacts of the bodies on which every load but the weight acts, and every support; the last are all of these."""
    n, loads, acting = len(system.tessellation), len(system.conditions.loads), system.acting
    # What acts on a platen acts on the bodies under it.
    bodies = [system.platens.bodies[some[0] - n] if some[0] >= n else some for some in acting.bodies]
    ends = len(acting.loads) + np.cumsum([0, *(held.functionals for held in system.conditions.held)])
    found = []
    for some in [*bodies[:loads], *(np.concatenate(bodies[a:b]) for a, b in pairwise(ends))]:
        of = np.zeros(n, dtype=np.bool_)
        of[some] = True
        found.append(np.flatnonzero(of[system.tessellation.contacts.bodies].any(axis=1)))
    return *found, np.unique(np.concatenate(found))
