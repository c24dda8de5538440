"""Coarsening: what was refined, stayed undamaged and has unloaded goes back to coarse.

The discretization is a function of the refined region, so coarsening is the same selection with a smaller region. It
keeps every body of a damaged contact with a margin around it, so that no damaged contact changes: their facets are
those of full resolution. Bodies whose stress is still high stay as well. A part that has to be refined again after it
was given up stays for good, so that it cannot flicker.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from fissura.adaptivity import limits
from fissura.adaptivity.region import RefinedRegion
from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.contact import AppliedLaw
from fissura.tessellation import Tessellation


def needed_bodies(
    tessellation: Tessellation,
    damageable: IntArray,
    law: AppliedLaw,
    strain: FloatArray,
    history: FloatArray,
    threshold: float,
) -> BoolArray:
    """Bodies that must stay fine: with a damaged or highly stressed contact, or not unloaded yet.

    Parameters
    ----------
    tessellation : Tessellation
        The discretization.
    damageable : (k,) int array
        Contacts with the damage law.
    law : AppliedLaw
        Their law.
    strain, history : (k, 3), (k, h) arrays
        Their strains ``e_N, e_M, e_L`` and accepted history.
    threshold : float
        Utilisation from which a contact counts as highly stressed.

    Returns
    -------
    (n,) bool array
        False for coarse bodies.
    """
    contacts, n = tessellation.contacts, len(tessellation)
    ends = contacts.bodies[damageable]
    weight = contacts.area[damageable] * contacts.length[damageable]
    of_bodies = [np.bincount(ends.ravel(), np.repeat(weight * value, 2), n) for value in law.loading(strain, history)]
    needed = tessellation.fine & (of_bodies[0] >= limits.UNLOADED * of_bodies[1])
    needed[ends[(law.damage(history) > 0.0) | (law.utilisation(strain) > threshold)]] = True
    return np.asarray(needed, dtype=np.bool_)


@dataclass(frozen=True)
class Coarsening:
    """Decides when a region shrinks, and to what.

    Attributes
    ----------
    given_up : RefinedRegion or None
        What was fine before the latest coarsening.
    lasting : (k, 3) array
        Critical centres in parts that had been given up before [m].
    rest : int
        Accepted steps since the discretization last changed.
    """

    given_up: RefinedRegion | None = None
    lasting: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    rest: int = 0

    def stepped(self) -> Coarsening:
        """After an accepted step."""
        return replace(self, rest=self.rest + 1)

    def refined(self, centers: FloatArray) -> Coarsening:
        """After a refinement around critical centres, shape (k, 3)."""
        lasting = self.lasting
        if self.given_up is not None:
            again = centers[self.given_up.distance(centers) <= 0.0]
            lasting = np.unique(np.concatenate([lasting, again]), axis=0)
        return replace(self, lasting=lasting, rest=0)

    def smaller(
        self,
        region: RefinedRegion,
        tessellation: Tessellation,
        needed: BoolArray,
        fine_in: Callable[[RefinedRegion], int],
    ) -> RefinedRegion | None:
        """The region that is still needed; None where it is not worth a change.

        Parameters
        ----------
        region : RefinedRegion
            What is fine now.
        tessellation : Tessellation
            The discretization.
        needed : (n,) bool array
            Bodies that must stay fine.
        fine_in : callable
            Tells how many fine bodies a region has.
        """
        fine = int(tessellation.fine.sum())
        if self.rest < limits.PAUSE or fine <= limits.FEWEST:
            return None
        smaller = region.coarsened(tessellation.x[needed], self.lasting)
        if fine - fine_in(smaller) < max(limits.SAVING * fine, limits.FEWEST):
            return None
        return smaller

    def coarsened(self, region: RefinedRegion) -> Coarsening:
        """After the given region was given up for a smaller one."""
        return replace(self, given_up=region, rest=0)
