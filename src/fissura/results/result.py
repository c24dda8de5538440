"""What a run leaves behind, in memory or reloaded from its folder."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.results import quantities as text
from fissura.results.curve import COLUMN_OF, COLUMNS, Curve, read_curve
from fissura.results.names import load_name
from fissura.results.peak import peak_position
from fissura.results.state import read_state
from fissura.results.summary import curve_numbers, read_summary, result_folder

if TYPE_CHECKING:
    from fissura.case import Case, Quantity
    from fissura.step import Snapshot

__all__ = ["Result"]


@dataclass(frozen=True, repr=False, eq=False)
class Result:
    """Results of one run.

    Attributes
    ----------
    case : Case
        What was run.
    full : bool
        Whether the whole specimen was fine from the start.
    curve : dict of str to (steps,) array
        The curve; keys are the columns of ``curve.csv`` (`fissura.results.curve.COLUMNS`).
    summary : dict
        Content of ``summary.json``.
    snapshots : dict of int to Snapshot
        States by step number: those chosen for ParaView, that of the peak load, and the last. A reloaded
        result has the last one only.
    folder : Path or None
        Where the files are; None when nothing was written.
    """

    case: Case
    full: bool
    curve: Curve
    summary: dict[str, Any]
    snapshots: dict[int, Snapshot]
    folder: Path | None = None

    @classmethod
    def load(cls, folder: str | Path) -> Result:
        """Read a result folder.

        A run that was killed before its end can be loaded too; its status is ``"running"`` and it has no
        snapshots.

        Raises
        ------
        InputError
            There is no such folder, or a file in it is missing or broken.
        """
        from fissura.case import case_from_dict
        from fissura.case.load import read_json

        folder = result_folder(folder)
        curve, summary = read_curve(folder / "curve.csv"), read_summary(folder / "summary.json")
        if summary.get("status") == "running" and set(COLUMNS) <= set(curve):
            summary |= curve_numbers(curve)  # it is written every second only, the curve after every step
        steps, told = len(curve["step"]), summary.get("steps")
        if summary.get("status") != "running" and isinstance(told, int) and told != steps:
            problem = f"has {steps} step{'' if steps == 1 else 's'}, and summary.json tells of {told}"
            raise InputError(str(folder / "curve.csv"), problem, "files of one run")
        path = folder / "case.json"
        data = read_json(path, "the case.json of a Fissura run")
        state = folder / "state_last.npz"
        snapshots = dict([read_state(state)]) if state.exists() else {}
        try:
            case = case_from_dict(data, folder, files_exist=False)
        except InputError as error:
            raise InputError(f"{path}: {error.key}", error.problem, error.allowed) from None
        return cls(case, bool(summary.get("full")), curve, summary, snapshots, folder)

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
        """Gauge, or displacement of the load, at every step [m], shape (steps,)."""
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
        return self._number("peak_load_N")

    @property
    def gauge_at_peak(self) -> float:
        """Gauge at the peak load [m]; nan without steps."""
        return self._number("gauge_at_peak_m")

    @property
    def dissipated_energy(self) -> float:
        """Energy dissipated by the contacts until the last step [J]; nan without steps."""
        return self._number("dissipated_energy_J")

    @property
    def initial_stiffness(self) -> float:
        """Load per gauge of the first elastic solution [N/m]; nan without steps."""
        return self._number("initial_stiffness_N_per_m")

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

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value that describe the run."""
        s, number = self.summary, self._number
        kind = "full resolution" if self.full else f"adaptive ({s.get('criterion')})"
        led = f" ({s['steps_led_by_energy']} led by energy)" if s.get("steps_led_by_energy") else ""
        coarser = f"{s['coarsenings']} coarsenings, " if s.get("coarsenings") else ""
        at_peak = float(self.controlled[peak_position(self.load_values)]) if self.steps else math.nan
        bodies = " → ".join(text.count(number(key)) for key in ("bodies_start", "bodies_end"))
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
                "elastic contacts at most at",
                text.per_cent(number("max_elastic_utilisation")) + " of strength",
            ),
            *self._precision(),
            ("bodies", f"{bodies} (full: {text.count(number('bodies_full'))})"),
            (
                "steps",
                f"{self.steps}{led} with {s.get('refinements')} refinements, {coarser}{s.get('iterations')} iterations",
            ),
            ("time", f"{text.seconds(number('wall_s'))} ({text.seconds(number('cpu_s'))} of processor)"),
            ("memory", f"{number('peak_memory_MB'):.0f} MB"),
        ]

    def _precision(self) -> list[tuple[str, str]]:
        """Row about the error of adaptivity; none at full resolution."""
        if self.summary.get("load_error_bound") is None:
            return []
        bound = text.per_cent(self._number("load_error_bound"))
        return [("load off full resolution", f"by {bound} of its peak at most, in 95 of 100 runs like it")]

    def _number(self, key: str) -> float:
        value = self.summary.get(key)
        return math.nan if value is None else float(value)

    def __repr__(self) -> str:
        width = max(len(name) for name, _ in self.table())
        return "\n".join(f"{name:<{width}}  {value}" for name, value in self.table())
