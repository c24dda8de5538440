"""The log of a run, ``run.log``: what was run with what, its steps and refinements, warnings, and how it ended."""

import logging
from pathlib import Path

from fissura.case import Case
from fissura.results.provenance import commit, versions
from fissura.simulation.step import Step
from fissura.text import quantities as text

FILE = "run.log"
"""Its name."""

_FORMAT = "%(asctime)s %(levelname)-7s %(message)s"


class _Handler(logging.FileHandler):
    """Writes what it can: no run fails for the sake of its log."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Say nothing."""


class RunLog:
    """Writes lines of the standard library's logging: time, level and message.

    What modules of Fissura log from the level WARNING on goes into it, too, and below that what their loggers let pass.

    Parameters
    ----------
    path : Path
        File to write.
    go_on : bool
        Whether it is continued.
    """

    def __init__(self, path: Path, *, go_on: bool) -> None:
        self._handler = _Handler(path, mode="a" if go_on else "w", encoding="utf-8", delay=True)
        self._handler.setFormatter(logging.Formatter(_FORMAT))
        self._logger = logging.getLogger("fissura")
        self._logger.addHandler(self._handler)

    def begin(self, case: Case, kind: str, done: int) -> None:
        """Say what is run, and from which step on.

        Parameters
        ----------
        case : Case
            The case.
        kind : str
            Adaptive or full, and its bodies, in words.
        done : int
            Steps before.
        """
        self._say(", ".join(f"{name} {version}" for name, version in versions().items()) + f", commit {commit()}")
        self._say(f"{case.name}, seed {case.seed}, {kind}" + (f", continued after step {done}" if done else ""))

    def step(self, step: Step, quantity: str) -> None:
        """Tell of an accepted step.

        Parameters
        ----------
        step : Step
            The step.
        quantity : str
            What is controlled.
        """
        show = text.force if quantity == "force" else text.length
        control = ", under dissipation control" if step.control == "dissipation" else ""
        self._say(
            f"step {step.number}: {quantity} {show(step.controlled)}, load {text.force(step.load)},"
            f" {step.bodies} bodies, {step.iterations} iterations{control}"
        )
        if step.refinements or step.coarsenings:
            self._say(f"step {step.number}: refined {step.refinements} times, coarsened {step.coarsenings} times")

    def end(self, status: str, message: str, wall: float, cpu: float) -> None:
        """Say how the run has ended, with its wall and processor time [s].

        Parameters
        ----------
        status : str
            How.
        message : str
            Why, or ``""``.
        wall, cpu : float
            Times [s].
        """
        told = f"{status}: {message}" if message else status
        self._say(f"{told}, wall time {text.seconds(wall)}, processor time {text.seconds(cpu)}")
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._logger.removeHandler(self._handler)
        self._handler.close()

    def _say(self, message: str) -> None:
        self._handler.handle(logging.LogRecord("fissura.run", logging.INFO, "", 0, message, None, None))
