"""Records a run step by step and writes its result folder."""

from __future__ import annotations

import logging
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.errors import InputError
from fissura.files import write_atomically, write_json
from fissura.results.curve import COLUMNS, CurveWriter, Row, columns, row, support_columns
from fissura.results.done import Done
from fissura.results.history import FILE, HistoryWriter
from fissura.results.result import Result
from fissura.results.state import write_state
from fissura.results.summary import build_summary, write_summary

if TYPE_CHECKING:
    from fissura.simulation import Simulation
    from fissura.step import Step

__all__ = ["Recorder"]

logger = logging.getLogger(__name__)

OWN_FILES = (
    "curve.csv",
    "case.toml",
    "case.json",
    "summary.json",
    "state_last.npz",
    "section.npz",
    "curve.png",
    "crack.png",
    "field.png",
    "compare.png",
    "compare_bodies.png",
    "moments.png",
    "refinement.gif",
    "refinement.mp4",
    "bodies.pvd",
    "contacts.pvd",
    "bodies_[0-9]*.vtu",
    "contacts_[0-9]*.vtu",
)
"""Files of an earlier run in the same folder, removed before a new one; nothing else is touched."""


class Recorder:
    """Keeps what matters of every step, and writes it as the run goes on.

    The curve and the summary are up to date on disk after every step, so that a run that is killed keeps
    them. Snapshots are kept for the steps at or first past ``k/n`` of the run's end (``n = case.output.vtk``, see
    `fissura.results.done.Done`), for the peak load, and for the last step; no others.

    Parameters
    ----------
    simulation : Simulation
        The run. Times count from its ``cpu_start`` and ``wall_start`` (`time.process_time` and
        `time.perf_counter` [s]) where it has them, else from here.
    folder : Path or None
        Where to write; made if needed. None: keep the results in memory only.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """

    def __init__(self, simulation: Simulation, folder: Path | None) -> None:
        self._simulation = simulation
        self._cpu_start: float = getattr(simulation, "cpu_start", time.process_time())
        self._wall_start: float = getattr(simulation, "wall_start", time.perf_counter())
        self._rows: list[Row] = []
        self._done = Done(simulation.case)
        self._passed = 0
        self._chosen: dict[int, Step] = {}
        self._written: dict[int, float] = {}
        self._peak: Step | None = None
        self._last: Step | None = None
        self._folder = folder
        self._curve: CurveWriter | None = None
        self._history = HistoryWriter(0.5 * simulation.case.specimen.size[2])
        if folder is not None:
            if (start := getattr(simulation, "tessellation", None)) is not None:
                self._history.start(start)
            try:
                self._curve = self._open(folder)
            except OSError as error:
                raise InputError(
                    str(folder), f"cannot be written ({error})", "a folder that can be made or written to"
                ) from error
            self._write_summary("running", "")

    def add(self, step: Step) -> None:
        """Record an accepted step."""
        values = row(step, self._cpu(), self._wall())
        self._rows.append(values)
        self._last = step
        if self._peak is None or abs(step.load) > abs(self._peak.load):
            self._peak = step
        due = self._due(self._done.after(step))
        if due:
            self._chosen[step.number] = step
        if self._curve is not None:
            self._history.add(step)
            self._curve.write(values)
            self._write_summary("running", "")
        if due:
            self._write_vtk(step)

    def finish(self, status: str, message: str = "") -> Result:
        """Write what belongs to the end of the run, and return the results.

        Parameters
        ----------
        status : str
            ``"finished"``, ``"stopped"`` or ``"interrupted"``.
        message : str, optional
            Why the run stopped.
        """
        if self._curve is not None:
            self._curve.close()
        for step in (self._peak, self._last):
            if step is not None:
                self._chosen[step.number] = step
                self._write_vtk(step)
        summary = self._write_summary(status, message)
        for warning in summary["warnings"]:
            logger.warning(warning)
        result = Result(
            case=self._simulation.case,
            full=self._simulation.full,
            curve=columns(self._rows),
            summary=summary,
            snapshots={number: self._chosen[number].snapshot for number in sorted(self._chosen)},
            folder=self._folder,
        )
        if self._folder is not None and self._last is not None:
            write_state(self._folder / "state_last.npz", self._last)
            self._history.write(self._folder / FILE)
            self._draw(result, self._folder)
        return result

    def _draw(self, result: Result, folder: Path) -> None:
        from fissura.results.crack_picture import plot_crack
        from fissura.results.pictures import plot_curve

        plot_crack(result, folder / "crack.png")
        case, field = result.case, getattr(self._simulation, "field", None)
        if case.field is not None and field is not None:
            from fissura.results.field_picture import plot_field

            plot_field(field, case.field, case.specimen.size, result.last.tessellation, folder / "field.png", case.name)
        try:
            plot_curve(result, folder / "curve.png")
        except InputError as error:
            # The measured band has gone since the start; the results are worth more than the picture.
            logger.warning("curve.png was not drawn: %s", error)

    def _due(self, share: float) -> bool:
        """Whether another of the evenly spaced shares of the run was reached."""
        total, before = self._simulation.case.output.vtk, self._passed
        while self._passed < total:
            # The last step ends on the target up to round-off.
            if share < (self._passed + 1) / total * (1 - 1e-9):
                break
            self._passed += 1
        return self._passed > before

    def _open(self, folder: Path) -> CurveWriter:
        folder.mkdir(parents=True, exist_ok=True)
        for pattern in OWN_FILES:
            for path in folder.glob(pattern):
                path.unlink()
        case = self._simulation.case
        source = getattr(case, "source", None)
        if isinstance(source, str):
            write_atomically(folder / "case.toml", source.encode())
        resolved = case.model_dump(mode="json", exclude={"source"})
        write_json(folder / "case.json", resolved)
        return CurveWriter(folder / "curve.csv", (*COLUMNS, *support_columns(len(case.supports))))

    def _write_vtk(self, step: Step) -> None:
        if self._folder is None or self._simulation.case.output.vtk == 0 or step.number in self._written:
            return
        from fissura.results.vtk import write_series, write_snapshot

        write_snapshot(self._folder, step.number, step.snapshot)
        self._written[step.number] = step.controlled
        write_series(self._folder, self._written)

    def _write_summary(self, status: str, message: str) -> dict[str, Any]:
        summary = build_summary(
            self._simulation,
            columns(self._rows),
            status=status,
            message=message,
            cpu_s=self._cpu(),
            wall_s=self._wall(),
        )
        if self._folder is not None:
            write_summary(self._folder / "summary.json", summary)
        return summary

    def _cpu(self) -> float:
        return time.process_time() - self._cpu_start

    def _wall(self) -> float:
        return time.perf_counter() - self._wall_start
