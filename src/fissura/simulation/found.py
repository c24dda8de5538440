"""Where a step ends, and what can be seen there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray
from fissura.simulation.step import Snapshot

if TYPE_CHECKING:
    from fissura.adaptivity import ElasticState
    from fissura.equilibrium import Equilibrium, System


@dataclass(frozen=True)
class Found:
    """Where a step ends.

    Attributes
    ----------
    equilibrium : Equilibrium
        Displacements, load and history.
    elastic : ElasticState
        What the criterion looked at.
    criterion : (n,) array
        Its value, 1 at strength; nan for fine bodies.
    """

    equilibrium: Equilibrium
    elastic: ElasticState
    criterion: FloatArray


def snapshot_of(system: System, found: Found) -> Snapshot:
    """What can be seen of a state of equilibrium."""
    response, contacts = found.equilibrium.response, system.tessellation.contacts
    n, m = len(system.tessellation), len(contacts)
    strain, damage = response.strain[:m], np.zeros(m)
    damage[system.damageable] = system.law.damage(response.history)
    return Snapshot(
        tessellation=system.tessellation,
        displacement=response.u.reshape(-1, 6)[:n],
        stress=found.elastic.stress,
        criterion=found.criterion,
        strain=strain,
        traction=response.traction[:m],
        tangents=system.geometry.frame[:m, 1:],
        damage=damage,
        opening=contacts.length * damage * np.maximum(strain[:, 0], 0.0),
        body_factor=system.body_factor,
        contact_factor=system.contact_factor,
    )
