"""A run as a path: loads over what grows all along it, gauge or displacement, or else dissipated energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Quantity
from fissura.errors import InputError
from fissura.results.curve import COLUMN_OF, Curve

NAMES: dict[Quantity, str] = {"gauge": "gauge", "displacement": "displacement of the load"}
"""What loads may be drawn and compared over, in words."""

ROUND_OFF = 1e-9
"""Part of the energy at the end below which a step has dissipated nothing."""


@dataclass(frozen=True)
class LoadPath:
    """Gauge or displacement, load and dissipated energy of a run, with the state before its first step in front.

    Attributes
    ----------
    key : str
        Name of the run in messages.
    value, load, energy : (steps + 1,) array
        Gauge or displacement of the load [m], load [N], energy dissipated so far [J].
    quantity : str
        Which of the two `value` is: "gauge" or "displacement".
    """

    key: str
    value: FloatArray
    load: FloatArray
    energy: FloatArray
    quantity: Quantity = "gauge"

    @classmethod
    def of(cls, curve: Curve, key: str, quantity: Quantity) -> LoadPath:
        """Path of a curve, over the gauge or over the displacement of the load.

        Raises
        ------
        InputError
            The curve has no step in which that is positive.
        """
        value = curve[COLUMN_OF[quantity]].astype(np.float64)
        if not np.any(value > 0):
            raise InputError(key, f"has no step with a positive {NAMES[quantity]}", "a run of at least one step")
        return cls(
            key,
            np.append(0.0, value),
            np.append(0.0, curve["load_N"].astype(np.float64)),
            np.append(0.0, curve["dissipated_J"].astype(np.float64)),
            quantity,
        )

    @property
    def name(self) -> str:
        """What `value` is, in words."""
        return NAMES[self.quantity]

    @property
    def grows(self) -> bool:
        """Whether the value grows from step to step."""
        return bool(np.all(np.diff(self.value) > 0))

    def over_value(self) -> tuple[FloatArray, FloatArray]:
        """Values, and loads, values and energies at them, shape (3, k)."""
        return self.value, np.stack([self.load, self.value, self.energy])

    def until_turning(self) -> tuple[FloatArray, FloatArray]:
        """Values as long as they grow, and loads and energies at them, shape (2, k)."""
        end = int(np.argmax(np.append(np.diff(self.value) <= 0, True))) + 1
        return self.value[:end], np.stack([self.load, self.energy])[:, :end]

    def over_energy(self) -> tuple[FloatArray, FloatArray]:
        """Energies, and the same at them, from the last step on that dissipated nothing.

        The elastic steps before it all have the same energy, up to round-off, and so have those of a cycle: of steps
        with one energy the one with the largest load counts, at which a cycle has turned.

        Raises
        ------
        InputError
            The run dissipated nothing.
        """
        energy = np.maximum.accumulate(self.energy)
        energy[energy <= ROUND_OFF * energy[-1]] = 0.0
        group = np.append(0, np.cumsum(np.diff(energy) > ROUND_OFF * energy[-1]))
        if group[-1] < 1:
            raise InputError(
                self.key, f"has a {self.name} that turns back, and no dissipated energy", "a run with damage"
            )
        order = np.lexsort((np.abs(self.load), group))
        chosen = order[np.append(np.diff(group) > 0, True)]
        return energy[chosen], np.stack([self.load, self.value, energy])[:, chosen]
