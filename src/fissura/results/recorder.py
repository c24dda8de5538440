"""Records a run step by step and writes its result folder."""

from __future__ import annotations

import logging
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.errors import InputError
from fissura.files import write_atomically, write_json
from fissura.folder import Folder
from fissura.interrupts import shielded
from fissura.results.curve import COLUMNS, CurveWriter, GrowingCurve, case_columns, row
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

EVERY = 1.0
"""Seconds between summaries of a run that goes on."""


class Recorder:
    """Keeps what matters of every step, and writes it as the run goes on.

    The curve is up to date on disk after every step and the summary every second, so that a run that is killed keeps
    them. Snapshots are kept for the steps at or first past ``k/n`` of the run's end (``n = case.output.vtk``, see
    `fissura.results.done.Done`), for the peak load, and for the last step; no others. A signal that would end the
    program waits until what is being written is whole.

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
        self._table = GrowingCurve()
        self._done = Done(simulation.case)
        self._passed = 0
        self._chosen: dict[int, Step] = {}
        self._written: dict[int, float] = {}
        self._told = 0.0
        self._peak: Step | None = None
        self._last: Step | None = None
        self._path = folder
        self._curve: CurveWriter | None = None
        self._history = HistoryWriter(float(simulation.domain.bounds[:, 2].mean()))
        if folder is not None:
            if (start := getattr(simulation, "tessellation", None)) is not None:
                self._history.start(start)
            try:
                folder.mkdir(parents=True, exist_ok=True)
                self._folder = Folder.begun(folder, "run")
                self._curve = self._open()
                self._write_summary(self._summary("running", ""))
            except OSError as error:
                raise InputError(
                    str(folder), f"cannot be written ({error})", "a folder that can be made or written to"
                ) from error

    def add(self, step: Step) -> None:
        """Record an accepted step."""
        with shielded():
            values = row(step, self._cpu(), self._wall())
            self._table.add(values)
            self._last = step
            if self._peak is None or abs(step.load) > abs(self._peak.load):
                self._peak = step
            due = self._due(self._done.after(step))
            if due:
                self._chosen[step.number] = step
            if self._curve is not None:
                self._curve.write(values)
                self._history.add(step)
                if time.monotonic() - self._told >= EVERY:
                    self._write_summary(self._summary("running", ""))
            if due:
                self._write_vtk(step)

    def finish(self, status: str, message: str = "") -> Result:
        """Write what belongs to the end of the run, its final status last, and return the results.

        Parameters
        ----------
        status : str
            ``"finished"``, ``"stopped"``, ``"interrupted"``, ``"refused"`` or ``"failed"``.
        message : str, optional
            Why the run ended early.

        Raises
        ------
        OSError, KeyboardInterrupt
            A file cannot be written, or the user interrupts while pictures are drawn. Everything else is written; the
            attribute ``result`` has the results.
        """
        for step in (self._peak, self._last):
            if step is not None:
                self._chosen[step.number] = step
        result = Result(
            case=self._simulation.case,
            full=self._simulation.full,
            curve=self._table.columns(),
            summary=self._summary(status, message),
            snapshots={number: self._chosen[number].snapshot for number in sorted(self._chosen)},
            folder=self._path,
        )
        for warning in result.summary["warnings"]:
            logger.warning(warning)
        if self._path is None:
            return result
        ended: BaseException | None = None
        saved = False
        try:
            with shielded():
                self._save()
                saved = True
            self._draw(result)
        except (Exception, KeyboardInterrupt) as error:
            ended = error
        if not saved:
            result.summary["status"] = "failed" if status == "finished" else status
            why = f"not all files could be written: {str(ended) or type(ended).__name__}"
            result.summary["message"] = f"{message}; {why}" if message else why
        if ended is not None:
            ended.result = result  # type: ignore[attr-defined]
        with shielded():
            self._write_summary(result.summary)
        if ended is not None:
            raise ended
        return result

    def _save(self) -> None:
        """Write the last states."""
        if self._curve is not None:
            self._curve.close()
        for step in (self._peak, self._last):
            if step is not None:
                self._write_vtk(step)
        if self._last is not None:
            write_state(self._own("state_last.npz"), self._last)
            self._history.write(self._own(FILE))

    def _draw(self, result: Result) -> None:
        if self._last is None:
            return
        from fissura.results.crack_picture import plot_crack
        from fissura.results.lettering import attempted
        from fissura.results.pictures import plot_curve

        attempted("crack.png", lambda: plot_crack(result, self._own("crack.png")))
        case, field = result.case, getattr(self._simulation, "field", None)
        if case.field is not None and field is not None:
            from fissura.results.field_picture import plot_field

            part, domain, structure = case.field, self._simulation.domain, result.last.tessellation
            attempted(
                "field.png", lambda: plot_field(field, part, domain, structure, self._own("field.png"), case.name)
            )
        attempted("curve.png", lambda: plot_curve(result, self._own("curve.png")))

    def _due(self, share: float) -> bool:
        """Whether another of the evenly spaced shares of the run was reached."""
        total, before = self._simulation.case.output.vtk, self._passed
        while self._passed < total:
            # The last step ends on the target up to round-off.
            if share < (self._passed + 1) / total * (1 - 1e-9):
                break
            self._passed += 1
        return self._passed > before

    def _open(self) -> CurveWriter:
        case = self._simulation.case
        source = getattr(case, "source", None)
        if isinstance(source, str):
            write_atomically(self._own("case.toml"), source.encode(errors="replace"))
        write_json(self._own("case.json"), case.model_dump(mode="json", exclude={"source"}))
        return CurveWriter(self._own("curve.csv"), (*COLUMNS, *case_columns(case)))

    def _own(self, *names: str) -> Path:
        """Path of a file, the first one of some, that is about to be written."""
        self._folder.add(*names)
        return self._folder.path / names[0]

    def _write_vtk(self, step: Step) -> None:
        if self._path is None or self._simulation.case.output.vtk == 0 or step.number in self._written:
            return
        from fissura.results.vtk import SERIES, file_name, write_series, write_snapshot

        self._own(*(file_name(kind, step.number) for kind in SERIES), *(f"{kind}.pvd" for kind in SERIES))
        write_snapshot(self._path, step.number, step.snapshot)
        self._written[step.number] = step.controlled
        write_series(self._path, self._written)

    def _summary(self, status: str, message: str) -> dict[str, Any]:
        return build_summary(
            self._simulation,
            self._table.columns(),
            status=status,
            message=message,
            cpu_s=self._cpu(),
            wall_s=self._wall(),
        )

    def _write_summary(self, summary: dict[str, Any]) -> None:
        write_summary(self._own("summary.json"), summary)
        self._told = time.monotonic()

    def _cpu(self) -> float:
        return time.process_time() - self._cpu_start

    def _wall(self) -> float:
        return time.perf_counter() - self._wall_start
