"""Records a run step by step and writes its result folder."""

from __future__ import annotations

import logging
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.errors import InputError
from fissura.files.folder import Folder
from fissura.machine.interrupts import shielded
from fissura.results.curve import COLUMN_OF, COLUMNS, GrowingCurve, case_columns, row
from fissura.results.curve_writer import CurveWriter
from fissura.results.history import FILE, HistoryWriter
from fissura.results.result import Result
from fissura.results.state import LAST, write_state
from fissura.results.summary import build_summary, peak_memory, write_summary
from fissura.running.chosen import ChosenStates
from fissura.running.run_log import FILE as LOG
from fissura.running.run_log import RunLog
from fissura.running.saving import CheckpointWriter
from fissura.running.storing import draw_pictures, write_case
from fissura.simulation.state import State
from fissura.simulation.step import Moment, Snapshot, Step

if TYPE_CHECKING:
    from fissura.running.resuming import Begun
    from fissura.simulation.loop import Simulation

logger = logging.getLogger(__name__)

EVERY = 1.0
"""Seconds between summaries of a run that goes on."""


class Recorder:
    """Keeps what matters of every step, and writes it as the run goes on.

    The curve is up to date on disk after every step and the summary every second, so that a run that is killed keeps
    them; now and then a checkpoint tells how to go on. Snapshots are kept for the steps that `ChosenStates` chooses,
    for the peak load, and for the last step; no others. A signal that would end the program waits until what is being
    written is whole.

    Parameters
    ----------
    simulation : Simulation
        The run. Times count from its ``cpu_start`` and ``wall_start`` (`time.process_time` and
        `time.perf_counter` [s]) where it has them, else from here.
    folder : Path or None
        Where to write; made if needed. None: keep the results in memory only.
    begun : Begun, optional
        What was recorded there of this run, to go on with.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """

    def __init__(self, simulation: Simulation, folder: Path | None, begun: Begun | None = None) -> None:
        self._simulation = simulation
        self._cpu_start: float = getattr(simulation, "cpu_start", time.process_time())
        self._wall_start: float = getattr(simulation, "wall_start", time.perf_counter())
        self._table = GrowingCurve()
        self._states = ChosenStates(simulation.case, folder, self._own)
        self._snapshots: dict[int, Snapshot] = {}
        self._told = 0.0
        self._peak: Moment | None = None
        self._last: Moment | None = None
        self._path = folder
        self._curve: CurveWriter | None = None
        self._saving: CheckpointWriter | None = None
        self._log: RunLog | None = None
        self._history = HistoryWriter(float(simulation.domain.bounds[:, 2].mean()))
        if begun is None and (start := getattr(simulation, "tessellation", None)) is not None:
            self._history.start(start)
        if folder is not None:
            try:
                self._open(folder, begun)
            except OSError as error:
                raise InputError(
                    str(folder), f"cannot be written ({error})", "a folder that can be made or written to"
                ) from error

    def add(self, step: Step, state: State | None = None) -> None:
        """Record an accepted step, and the state after it if the run is to be resumed from there."""
        with shielded():
            values = row(step, self._cpu(), self._wall())
            self._table.add(values)
            self._last = step.moment
            highest = self._peak is None or abs(step.load) > abs(self._peak.load)
            if highest:
                self._peak = self._last
            due = self._states.due(self._last, step.done)
            if due:
                self._snapshots[step.number] = step.snapshot
            self._history.add(step)
            if self._curve is None:
                return
            # Nothing is written before all of this is in memory: what fails to be written is still to be resumed.
            if self._saving is not None and state is not None:
                self._saving.add(state, highest=highest)
            self._curve.write(values)
            if self._log is not None:
                self._log.step(step, self._simulation.case.quantity)
            if due:
                self._states.write(self._last)
            if self._saving is not None and self._saving.due:
                self._write_checkpoint()
            if time.monotonic() - self._told >= EVERY:
                self._write_summary(self._summary("running", ""))

    def watch(self, state: State, step: Step) -> None:
        """Record an accepted step, as an observer of a run."""
        self.add(step, state)

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
        for moment in (self._peak, self._last):
            if moment is not None:
                self._snapshots[moment.number] = moment.snapshot
        result = Result(
            case=self._simulation.case,
            full=self._simulation.full,
            curve=self._table.columns(),
            summary=self._summary(status, message),
            snapshots=dict(sorted(self._snapshots.items())),
            folder=self._path,
            sections=self._history.frames,
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
            if self._log is not None:
                self._log.end(result.summary["status"], result.summary["message"], self._wall(), self._cpu())
            self._write_summary(result.summary)
        if ended is not None:
            raise ended
        return result

    def _save(self) -> None:
        """Write the last states, and how to go on."""
        written = tuple(self._states.written)  # a run that goes on has another peak and another last step
        try:
            if self._curve is not None:
                self._curve.close()
            for moment in (self._peak, self._last):
                if moment is not None:
                    self._states.write(moment)
            if self._last is not None:
                write_state(self._own(LAST), self._last)
                self._history.write(self._own(FILE))
        except BaseException:
            with suppress(OSError):
                self._write_checkpoint(written)
            raise
        self._write_checkpoint(written, at_end=True)

    def _draw(self, result: Result) -> None:
        if self._last is not None:
            draw_pictures(result, self._simulation.domain, getattr(self._simulation, "field", None), self._own)

    def _open(self, folder: Path, begun: Begun | None) -> None:
        """Begin to write, or go on with it."""
        folder.mkdir(parents=True, exist_ok=True)
        case = self._simulation.case
        self._folder = Folder.begun(folder, "run") if begun is None else Folder.kept(folder, "run")
        if begun is not None:
            self._resume(folder, begun)
        write_case(case, self._own)
        names = (*COLUMNS, *case_columns(case))
        curve = None if begun is None else begun.checkpoint.curve
        self._curve = CurveWriter(self._own("curve.csv"), names, curve)
        checkpoint = None if begun is None else begun.checkpoint
        self._saving = CheckpointWriter(self._simulation, self._folder, self._history, checkpoint)
        self._log = RunLog(self._own(LOG), go_on=begun is not None)
        full, start = self._simulation.full, self._simulation.bodies_start
        kind = "full resolution" if full else f"adaptive, full resolution has {self._simulation.told_full}"
        self._log.begin(case, f"{start} bodies ({kind})", 0 if checkpoint is None else checkpoint.steps)
        self._write_summary(self._summary("running", ""))

    def _resume(self, folder: Path, begun: Begun) -> None:
        """Take what was recorded up to a checkpoint, and remove what was written after it."""
        found, case = begun.checkpoint, self._simulation.case
        self._history.read(
            [folder / name for name in found.sections], found.steps + 1, begun.last.snapshot.tessellation
        )
        self._table = GrowingCurve(found.curve)
        self._peak, self._last = begun.peak, begun.last
        self._cpu_start -= found.cpu_s
        self._wall_start -= found.wall_s
        reached = found.curve[COLUMN_OF[case.quantity]].tolist()
        names = set(self._folder.names())
        written = {number: reached[number - 1] for number in found.written}
        self._states.resume(begun.share, abs(self._peak.load), written, names)
        if found.owed:
            self._snapshots[self._last.number] = self._last.snapshot
            self._states.write(self._last)
        for name in names:
            if name.startswith(".section_") and name not in found.sections:
                (folder / name).unlink(missing_ok=True)

    def _write_checkpoint(self, written: tuple[int, ...] | None = None, *, at_end: bool = False) -> None:
        if self._saving is not None:
            states = tuple(self._states.written) if written is None else written
            share, owed = self._states.share, self._states.owed
            self._saving.write(
                self._table.columns(), states, share, self._cpu(), self._wall(), owed=owed, at_end=at_end
            )

    def _own(self, *names: str) -> Path:
        """Path of a file, the first one of some, that is about to be written."""
        self._folder.add(*names)
        return self._folder.path / names[0]

    def _summary(self, status: str, message: str) -> dict[str, Any]:
        return build_summary(
            self._simulation,
            self._table.columns(),
            status=status,
            message=message,
            cpu_s=self._cpu(),
            wall_s=self._wall(),
            memory=peak_memory() if self._saving is None else self._saving.memory,
        )

    def _write_summary(self, summary: dict[str, Any]) -> None:
        write_summary(self._own("summary.json"), summary)
        self._told = time.monotonic()

    def _cpu(self) -> float:
        return time.process_time() - self._cpu_start

    def _wall(self) -> float:
        return time.perf_counter() - self._wall_start
