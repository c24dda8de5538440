"""What there is of a run, in memory or in its folder, and the numbers that follow from it."""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.case import Case, Quantity
from fissura.errors import InputError
from fissura.results.curve import COLUMN_OF, Curve, peak_position
from fissura.results.history import Frame, read_history
from fissura.results.names import load_name
from fissura.simulation.step import Snapshot
from fissura.text import quantities as text
from fissura.text.rows import Described


@dataclass(frozen=True, repr=False, eq=False)
class RunData(Described):
    """What there is of a run; its fields are those of `Result`."""

    case: Case
    full: bool
    curve: Curve
    summary: dict[str, Any]
    snapshots: dict[int, Snapshot]
    folder: Path | None = None
    sections: tuple[Frame, ...] = ()

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """The section in the middle of the specimen at every step that pictures are made of; step 0 is unloaded.

        Raises
        ------
        InputError
            The folder has no such file, because the run has not ended.
        """
        if self.sections or self.folder is None:
            return self.sections

        return read_history(self.folder)

    @property
    def last(self) -> Snapshot:
        """State of the last step.

        Raises
        ------
        InputError
            There is none: no step was accepted, or the run was killed.
        """
        if not self.snapshots:
            raise InputError(str(self.folder or self.case.name), "has no state of a last step")
        return self.snapshots[max(self.snapshots)]

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
        """Whether dissipated energy led in a step, shape (steps,)."""
        return np.asarray(self.curve["control"] == "dissipation")

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

    def _rows(self) -> list[tuple[str, str]]:
        s, number = self.summary, self.number
        kind = "full resolution" if self.full else f"adaptive ({s.get('criterion')})"
        led = f" ({s['steps_led_by_energy']} under dissipation control)" if s.get("steps_led_by_energy") else ""
        coarser = f"{s['coarsenings']} coarsenings, " if s.get("coarsenings") else ""
        at_peak = float(self.controlled[peak_position(self.load_values)]) if self.steps else math.nan
        bodies = " → ".join(text.count(number(key)) for key in ("bodies_start", "bodies_end"))
        about = "about " if s.get("bodies_full_estimated") else ""
        return [
            ("case", f"{s.get('case')}, seed {s.get('seed')}, {kind}"),
            ("status", ": ".join(str(s[key]) for key in ("status", "message") if s.get(key))),
            (
                load_name(self.case).replace("load", "peak load"),
                f"{text.force(self.peak_load)} at {text.length(at_peak)}",
            ),
            ("initial stiffness", text.stiffness(self.initial_stiffness)),
            ("dissipated energy", text.energy(self.dissipated_energy)),
            ("energy balance error", text.per_cent(number("energy_balance_error"))),
            ("load and reactions differ by", text.per_cent(number("unbalanced_force"))),
            (
                "largest elastic utilisation",
                text.per_cent(number("max_elastic_utilisation")) + " of the strength, in elastic contacts",
            ),
            *self._precision(),
            ("bodies", f"{bodies} (full: {about}{text.count(number('bodies_full'))})"),
            (
                "steps",
                f"{self.steps}{led} with {s.get('refinements')} refinements, {coarser}{s.get('iterations')} iterations",
            ),
            ("time", f"{text.seconds(number('wall_s'))} (processor time {text.seconds(number('cpu_s'))})"),
            ("memory", f"{number('peak_memory_MB'):.0f} MB"),
        ]

    def _precision(self) -> list[tuple[str, str]]:
        """Row about the error of adaptivity; none at full resolution."""
        if self.summary.get("load_error_bound") is None:
            return []
        bound = text.per_cent(self.number("load_error_bound"))
        return [("estimated load error", f"at most {bound} of the peak (holds in 9 of 10 runs)")]
