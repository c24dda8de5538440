"""A run as a path: loads over what grows all along it, the gauge or else dissipated energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.results.curve import Curve

__all__ = ["ROUND_OFF", "LoadPath"]

FloatArray = NDArray[np.float64]

ROUND_OFF = 1e-9
"""Part of the energy at the end below which a step has dissipated nothing."""


@dataclass(frozen=True)
class LoadPath:
    """Gauge, load and dissipated energy of a run, with the state before its first step in front.

    Attributes
    ----------
    key : str
        Name of the run in messages.
    gauge, load, energy : (steps + 1,) array
        Controlled quantity [m], load [N], energy dissipated so far [J].
    """

    key: str
    gauge: FloatArray
    load: FloatArray
    energy: FloatArray

    @classmethod
    def of(cls, curve: Curve, key: str) -> LoadPath:
        """Path of a curve.

        Raises
        ------
        InputError
            The curve has no step with a positive gauge.
        """
        if not np.any(curve["gauge_m"] > 0):
            raise InputError(key, "has no step with a positive gauge", "a run of at least one step")
        return cls(
            key,
            np.append(0.0, curve["gauge_m"].astype(np.float64)),
            np.append(0.0, curve["load_N"].astype(np.float64)),
            np.append(0.0, curve["dissipated_J"].astype(np.float64)),
        )

    @property
    def grows(self) -> bool:
        """Whether the gauge grows from step to step."""
        return bool(np.all(np.diff(self.gauge) > 0))

    def over_gauge(self) -> tuple[FloatArray, FloatArray]:
        """Gauges, and loads, gauges and energies at them, shape (3, k)."""
        return self.gauge, np.stack([self.load, self.gauge, self.energy])

    def until_turning(self) -> tuple[FloatArray, FloatArray]:
        """Gauges as long as they grow, and loads and energies at them, shape (2, k)."""
        end = int(np.argmax(np.append(np.diff(self.gauge) <= 0, True))) + 1
        return self.gauge[:end], np.stack([self.load, self.energy])[:, :end]

    def over_energy(self) -> tuple[FloatArray, FloatArray]:
        """Energies, and the same at them, from the last step on that dissipated nothing.

        The elastic steps before it all have the same energy, up to round-off.

        Raises
        ------
        InputError
            The run dissipated nothing.
        """
        energy = np.maximum.accumulate(self.energy)
        energy[energy <= ROUND_OFF * energy[-1]] = 0.0
        last = np.append(np.diff(energy) > 0, True)
        if last.sum() < 2:
            raise InputError(self.key, "has a gauge that turns back, and no dissipated energy", "a run with damage")
        return energy[last], np.stack([self.load, self.gauge, energy])[:, last]
