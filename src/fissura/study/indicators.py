"""What a run can tell about its own error, without a run at full resolution.

All indicators look at the elastic part, which stands for material that could be damaged, or at its border. Strengths
are those of the run, with its random field if there is one:

``utilisation``
    Largest effective traction over strength of elastic contacts.
``border_utilisation``
    The same, of those elastic contacts that have a fine body.
``border_stress``
    Largest principal stress over tensile strength of coarse bodies that touch a fine one.
``strained_50``, ``strained_70``
    Elastic energy of the elastic contacts above 0.5 (0.7) of their strength, over all energy, stored and dissipated.
``border_1``, ``border_2``
    Energy that contacts dissipated while they were near the border, over all energy, stored and dissipated. Near are
    fine contacts with a body that touches a coarse one, or with one that touches such a body (a body is about 1.25
    ``l_f`` thick).
``balance``
    Energy that refinements put in or took out, over all work: they change the elastic structure under load.
``load_change``
    Changes of the load that refinement made at a kept gauge, their sizes summed, over the largest load.
``calibration``
    How far the factor on the stiffness of coarse contacts is from 1 at the end of the run. What is still coarse then
    must make up for all that the gauge differs from full resolution, wherever that comes from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.simulation.step import Snapshot, Step
from fissura.study.record import Energies
from fissura.tessellation import Tessellation

#: Names of the indicators that have a value in every step.
OBSERVED = (
    "utilisation",
    "border_utilisation",
    "border_stress",
    "strained_50",
    "strained_70",
    "border_1",
    "border_2",
    "balance",
    "load_change",
)
#: Names of all indicators.
INDICATORS = (*OBSERVED, "calibration")


@dataclass(frozen=True)
class _Zones:
    """Parts of one discretization.

    Attributes
    ----------
    at_border : (m,) bool array
        Coarse contacts with a fine body.
    coarse_border : (b,) array
        Coarse bodies that touch a fine one.
    outer : list of two (m,) bool arrays
        Fine contacts within one and two bodies from the border.
    """

    at_border: BoolArray
    coarse_border: IntArray
    outer: tuple[BoolArray, BoolArray]

    @classmethod
    def of(cls, tessellation: Tessellation) -> _Zones:
        contacts, fine = tessellation.contacts, tessellation.fine
        mixed = fine[contacts.bodies].any(axis=1) & ~contacts.fine
        touched = np.unique(contacts.bodies[mixed])
        first = np.zeros(len(tessellation), dtype=np.bool_)
        first[touched] = True
        near = first[contacts.bodies].any(axis=1) & contacts.fine
        second = first.copy()
        second[contacts.bodies[near]] = True
        nearer = second[contacts.bodies].any(axis=1) & contacts.fine
        return cls(mixed, touched[~fine[touched]], (near, nearer))


class Observer:
    """Collects indicators and the energy of contacts, step by step.

    Parameters
    ----------
    f_t : float
        Tensile strength of contacts [Pa], the mean where there is a random field.
    full : bool
        Whether at full resolution, where there are no indicators.
    """

    def __init__(self, f_t: float, *, full: bool) -> None:
        self._f_t, self._full = f_t, full
        self._at: Tessellation | None = None
        self._zones: _Zones | None = None
        self._spent: list[tuple[IntArray, FloatArray, FloatArray]] = []
        self._rows: list[list[float]] = []
        self._outer = np.zeros(2)
        self._changed = self._peak = 0.0

    def add(self, step: Step) -> None:
        """Take note of an accepted step."""
        tessellation = step.snapshot.tessellation
        contacts = tessellation.contacts
        # Without damage there is round-off only.
        spent = np.where(step.snapshot.damage > 0.0, step.spent, 0.0)
        spending = np.flatnonzero(spent > 0.0)
        pairs = np.sort(tessellation.nucleus[contacts.bodies[spending]], axis=1)
        self._spent.append((pairs, spent[spending], contacts.centroid[spending]))
        if self._full:
            return
        if self._zones is None or tessellation is not self._at:
            self._at, self._zones = tessellation, _Zones.of(tessellation)
        self._outer += [float(spent[outer].sum()) for outer in self._zones.outer]
        self._rows.append(self._values(step, step.snapshot, self._zones))

    def _values(self, step: Step, shot: Snapshot, zones: _Zones) -> list[float]:
        used = step.utilisation
        contacts = shot.tessellation.contacts
        energy = 0.5 * contacts.area * contacts.length * np.einsum("ca,ca->c", shot.traction, shot.strain)
        self._changed, self._peak = self._changed + step.load_change, max(self._peak, abs(step.load))
        spent = max(step.stored + step.dissipated, 1e-300)
        stress = np.linalg.eigvalsh(shot.stress[zones.coarse_border])[:, -1]
        strength = self._f_t if shot.body_factor is None else self._f_t * shot.body_factor[zones.coarse_border]
        return [
            step.max_elastic_utilisation,
            float(used[zones.at_border].max(initial=0.0)),
            float((stress / strength).max(initial=0.0)),
            float(energy[used > 0.5].sum()) / spent,
            float(energy[used > 0.7].sum()) / spent,
            *(self._outer / spent),
            abs(step.exchanged) / max(abs(step.work), 1e-300),
            self._changed / max(self._peak, 1e-300),
        ]

    def energies(self) -> Energies:
        """Energy dissipated so far, by contact."""
        if not self._spent:
            return Energies()
        pairs, energy, centroid = (np.concatenate(parts) for parts in zip(*self._spent, strict=True))
        return Energies.summed(pairs, energy, centroid)

    def indicators(self) -> dict[str, FloatArray]:
        """Values of the indicators of `OBSERVED` after every step, shape (steps,) each; none at full resolution."""
        if self._full:
            return {}
        values = np.array(self._rows).reshape(-1, len(OBSERVED))
        return {name: values[:, k].copy() for k, name in enumerate(OBSERVED)}
