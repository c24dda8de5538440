"""What is left of one realisation, and how it is computed."""

from __future__ import annotations

import tempfile
import traceback
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fissura.errors import InputError, RunStopped
from fissura.results import Result
from fissura.results.curve import Curve
from fissura.running.run import run as run_case
from fissura.simulation.step import Step

if TYPE_CHECKING:
    from fissura.ensemble.task import Task


@dataclass(frozen=True)
class Outcome:
    """A computed realisation, or why there is none. It is small, pickles, and knows no files.

    Attributes
    ----------
    task : Task
        What was to be computed.
    status : str
        ``"finished"``, ``"stopped"`` (the run could not go on; its curve up to there is kept) or ``"failed"`` (there is
        no curve).
    message : str
        Why it is not finished.
    again : bool
        Whether `resume` tries it again: the failure may have had to do with the machine.
    summary : dict
        Content of ``summary.json``; empty if the run failed.
    curve : dict of str to array, or None
        The curve.
    crack_start : dict or None
        See `CrackStart`.
    details : str
        Traceback of a failure.
    files : dict of str to bytes
        All other files of the run, if they are to be kept.
    """

    task: Task
    status: str
    message: str = ""
    again: bool = False
    summary: dict[str, Any] = field(default_factory=dict)
    curve: Curve | None = None
    crack_start: dict[str, float] | None = None
    details: str = ""
    files: dict[str, bytes] = field(default_factory=dict)

    @classmethod
    def failed(cls, task: Task, error: BaseException) -> Outcome:
        """Outcome of a realisation of which nothing is left but an error."""
        message = str(error) or type(error).__name__
        if not isinstance(error, InputError | RunStopped):
            message = f"{type(error).__name__}: {message}"
        details = "".join(traceback.format_exception(error))
        return cls(task, "failed", message, again=not isinstance(error, InputError | RunStopped), details=details)


class CrackStart:
    """Finds where the crack of a run starts.

    The place is the centroid of the first contact to open by ``G_t/f_t`` of the material's means. A contact in tension
    has lost about two thirds of its strength there and spent about as much of its fracture energy: it belongs to the
    crack, not to the scattered damage before. If several contacts get there in one step, the widest open counts.

    Parameters
    ----------
    threshold : float
        The opening [m].
    """

    def __init__(self, threshold: float) -> None:
        self.threshold = threshold
        self.found: dict[str, float] | None = None

    def watch(self, step: Step) -> None:
        """Look at an accepted step."""
        opening = step.snapshot.opening
        if self.found is not None or not len(opening):
            return
        widest = int(np.argmax(opening))
        if opening[widest] >= self.threshold:
            x, y, z = step.snapshot.tessellation.contacts.centroid[widest].tolist()
            self.found = {"x_m": x, "y_m": y, "z_m": z, "gauge_m": step.gauge, "load_N": step.load}


def compute(task: Task) -> Outcome:
    """Compute a realisation; every way it can go wrong is an outcome, too.

    Raises
    ------
    KeyboardInterrupt
        The user interrupts.
    """
    try:
        if not task.keep:
            return _computed(task, None)
        with tempfile.TemporaryDirectory(prefix="fissura_") as folder:
            outcome = _computed(task, Path(folder))
            return replace(outcome, files={path.name: path.read_bytes() for path in sorted(Path(folder).glob("[!.]*"))})
    except Exception as error:
        return Outcome.failed(task, error)


def _computed(task: Task, folder: Path | None) -> Outcome:
    start = CrackStart(task.case.material.G_t / task.case.material.f_t)
    result: Result
    try:
        result = run_case(task.case, full=task.full, output=folder, overwrite=True, on_step=start.watch, progress=False)
        status, message, again = "finished", "", False
    except RunStopped as error:
        stopped: Result | None = getattr(error, "result", None)
        if stopped is None:
            raise
        result = stopped
        status, message, again = "stopped", str(error), isinstance(error.__cause__, MemoryError)
    return Outcome(task, status, message, again, result.summary, result.curve, start.found)
