"""When a run saves where it stands, and what belongs to that."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from fissura.case.continued import as_data
from fissura.files.folder import Folder
from fissura.results.curve import Curve
from fissura.results.history import FILE as SECTIONS
from fissura.results.history import HistoryWriter
from fissura.results.provenance import versions
from fissura.results.summary import peak_memory
from fissura.running.checkpoint import FILE, Checkpoint, write_checkpoint
from fissura.simulation.saved import Noted, SavedState
from fissura.simulation.state import State

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

#: Checkpoints take at most this share of the time.
_SHARE = 0.01


class CheckpointWriter:
    """Writes the checkpoints of a run.

    Sections of the specimen are many and never change, so each checkpoint puts only those into a file that are new.

    Parameters
    ----------
    simulation : Simulation
        The run.
    folder : Folder
        Where it writes.
    history : HistoryWriter
        Sections so far.
    begun : Checkpoint, optional
        From which the run goes on.

    Attributes
    ----------
    memory : float
        Largest memory so far [bytes].
    """

    def __init__(
        self, simulation: Simulation, folder: Folder, history: HistoryWriter, begun: Checkpoint | None = None
    ) -> None:
        self._simulation, self._folder, self._history = simulation, folder, history
        self._every = simulation.case.output.checkpoint
        self._case: dict[str, Any] = as_data(simulation.case)
        self._state: SavedState | Noted | None = None if begun is None else begun.state
        self._peak: SavedState | Noted | None = None if begun is None else begun.peak
        self._parts = [] if begun is None else list(begun.sections)
        self._steps = 0 if begun is None else begun.steps + 1  # of the history, that are in these parts
        self._before = 0.0 if begun is None else begun.memory
        self._next = time.monotonic() + self._every

    @property
    def memory(self) -> float:
        """Largest memory so far [bytes]."""
        return max(self._before, peak_memory())

    def add(self, state: State, *, highest: bool) -> None:
        """Take the state after a step, of the largest load so far or not."""
        self._state = Noted.of(state, self._simulation.model.system)
        if highest:
            self._peak = self._state
        elif isinstance(self._peak, Noted) and self._peak.state.number == state.number - 1:
            self._peak = self._peak.seen().saved()  # it may stay for long, and need not keep all that it has

    @property
    def due(self) -> bool:
        """Whether it is time for another checkpoint."""
        return self._every > 0.0 and self._state is not None and time.monotonic() >= self._next

    def write(
        self,
        curve: Curve,
        written: Iterable[int],
        share: float,
        cpu_s: float,
        wall_s: float,
        *,
        owed: bool = False,
        at_end: bool = False,
    ) -> None:
        """Write a checkpoint.

        Parameters
        ----------
        curve : dict of str to (steps,) array
            The curve so far.
        written : iterable of int
            Steps whose states are written for ParaView.
        share : float
            Share of the run that is done.
        cpu_s, wall_s : float
            Processor and wall time so far [s].
        owed : bool
            The state of the last step is still to be written.
        at_end : bool
            All sections are in one file now.

        Raises
        ------
        OSError
            It cannot be written; the one before stays.
        """
        if self._every == 0.0 or self._state is None or self._peak is None:
            return
        began = time.monotonic()
        before = list(self._parts)
        parts = [SECTIONS] if at_end else before
        if not at_end and self._history.steps > self._steps:
            parts = [*before, f".section_{len(before):04d}.npz"]
            self._history.write(self._folder.own(parts[-1]), self._steps)
        same = self._peak is self._state
        self._state = _saved(self._state)
        self._peak = self._state if same else _saved(self._peak)
        checkpoint = Checkpoint(
            self._case,
            self._simulation.full,
            versions(),
            self._state,
            self._peak,
            curve,
            tuple(written),
            owed,
            share,
            tuple(parts),
            cpu_s,
            wall_s,
            self.memory,
        )
        write_checkpoint(self._folder.own(FILE), checkpoint)
        self._parts, self._steps = parts, self._history.steps
        for name in set(before) - set(parts):
            (self._folder.path / name).unlink(missing_ok=True)
        now = time.monotonic()
        self._next = now + max(self._every, (now - began) / _SHARE)


def _saved(found: SavedState | Noted) -> SavedState:
    return found.saved() if isinstance(found, Noted) else found
