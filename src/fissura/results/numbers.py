"""Numbers of a run, from its curve and its summary."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fissura.results.curve import COLUMN_OF, Curve

if TYPE_CHECKING:
    from fissura.case import Case, Quantity

__all__ = ["Numbers"]


class Numbers:
    """What follows from the curve and the summary of a run."""

    case: Case
    curve: Curve
    summary: dict[str, Any]

    @property
    def status(self) -> str:
        """How the run ended: ``"finished"``, ``"stopped"`` and others, see docs/files.md."""
        return str(self.summary.get("status"))

    @property
    def gauge(self) -> NDArray[np.float64]:
        """Gauge at every step [m], or displacement of the load where the case has no gauge; shape (steps,)."""
        return self.curve["gauge_m"].astype(np.float64)

    @property
    def controlled(self) -> NDArray[np.float64]:
        """Controlled quantity at every step [m], shape (steps,); it turns back where there is snap-back.

        It is the gauge or the displacement of the load, as `Case.quantity` says.
        """
        return self.values_of(self.case.quantity)

    def values_of(self, quantity: Quantity) -> NDArray[np.float64]:
        """Gauge, or displacement of the load, at every step.

        Parameters
        ----------
        quantity : {"gauge", "displacement"}
            Which.

        Returns
        -------
        (steps,) array
            Its values [m].

        Examples
        --------
        >>> bool(result.values_of("displacement")[-1] > 0.0)
        True
        """
        return self.curve[COLUMN_OF[quantity]].astype(np.float64)

    @property
    def load_values(self) -> NDArray[np.float64]:
        """Load at every step [N], shape (steps,)."""
        return self.curve["load_N"].astype(np.float64)

    @property
    def led_by_energy(self) -> NDArray[np.bool_]:
        """Whether dissipated energy led in a step, shape (steps,); never in files of before there was that choice."""
        led = self.curve.get("control")
        return np.zeros(self.steps, dtype=np.bool_) if led is None else led == "dissipation"

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return len(self.curve["step"])

    @property
    def peak_load(self) -> float:
        """Load of largest magnitude, with its sign [N]; nan without steps."""
        return self.number("peak_load_N")

    @property
    def gauge_at_peak(self) -> float:
        """Gauge at the peak load [m]; nan without steps."""
        return self.number("gauge_at_peak_m")

    @property
    def dissipated_energy(self) -> float:
        """Energy dissipated by the contacts until the last step [J]; nan without steps."""
        return self.number("dissipated_energy_J")

    @property
    def initial_stiffness(self) -> float:
        """Load per gauge of the first elastic solution [N/m]; nan without steps."""
        return self.number("initial_stiffness_N_per_m")

    def number(self, key: str) -> float:
        """A number of the summary.

        Parameters
        ----------
        key : str
            One of ``summary.json``, see docs/files.md.

        Returns
        -------
        float
            Its value; nan where it is not known.

        Examples
        --------
        >>> result.number("bodies_end") == len(result.last.tessellation)
        True
        """
        value = self.summary.get(key)
        return math.nan if value is None else float(value)
