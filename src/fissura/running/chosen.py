"""States that are written for ParaView: evenly over the run, that of the peak load, and the last one."""

from collections.abc import Callable, Mapping
from pathlib import Path

from fissura.case import Case
from fissura.results.done import Done
from fissura.results.vtk import SERIES, file_name, write_series, write_snapshot
from fissura.simulation.step import Moment


class ChosenStates:
    """Decides which states are due, and writes them.

    Due are the steps at or first past ``k/n`` of the run's end (``n = case.output.vtk``, see
    `fissura.results.done.Done`).

    Parameters
    ----------
    case : Case
        What is run.
    folder : Path or None
        Where to write; None: nowhere.
    own : callable
        Takes names of files that are about to be written there.

    Attributes
    ----------
    written : dict of int to float
        Steps whose states are written, and the controlled quantity there [m].
    owed : bool
        The state of the last step is due and not written yet.
    """

    def __init__(self, case: Case, folder: Path | None, own: Callable[..., Path]) -> None:
        self._total, self._folder, self._own = case.output.vtk, folder, own
        self._done = Done(case)
        self._passed = 0
        self.written: dict[int, float] = {}
        self.owed = False

    @property
    def share(self) -> float:
        """Share of the run that is done."""
        return self._done.share

    def due(self, moment: Moment, done: float) -> bool:
        """Whether a step has reached another of the evenly spaced shares of the run.

        Parameters
        ----------
        moment : Moment
            The step.
        done : float
            Share of the loading programme that is done.
        """
        before = self._passed
        self._pass(self._done.after(done, moment.load))
        self.owed = self._passed > before
        return self.owed

    def _pass(self, share: float) -> None:
        while self._passed < self._total:
            # The last step ends on the target up to round-off.
            if share < (self._passed + 1) / self._total * (1 - 1e-9):
                break
            self._passed += 1

    def write(self, moment: Moment) -> None:
        """Write a state, unless it is there or none are wanted."""
        if self._folder is None or self._total == 0 or moment.number in self.written:
            self.owed = False
            return

        self._own(*(file_name(kind, moment.number) for kind in SERIES), *(f"{kind}.pvd" for kind in SERIES))
        write_snapshot(self._folder, moment.number, moment.snapshot)
        self.written[moment.number] = moment.controlled
        write_series(self._folder, self.written)
        self.owed = False

    def resume(self, share: float, peak: float, written: Mapping[int, float], names: set[str]) -> None:
        """Go on with states that were written before, and remove others.

        Parameters
        ----------
        share : float
            Share of the run that is done.
        peak : float
            Largest size of the load so far [N].
        written : mapping of int to float
            Steps, and the controlled quantity there [m].
        names : set of str
            Files in the folder that are ours.
        """
        self._done.share, self._done.peak = share, peak
        self._pass(share)
        if self._folder is None:
            return

        self.written = dict(written)
        kept = {file_name(kind, number) for kind in SERIES for number in written}
        for name in names - kept:
            if name.endswith(".vtu"):
                (self._folder / name).unlink(missing_ok=True)
        if written:
            write_series(self._folder, self.written)
