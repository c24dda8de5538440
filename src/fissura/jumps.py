"""Jumps of damage before the peak, which make it depend on the length of steps."""

from __future__ import annotations

from fissura.errors import Notice

__all__ = ["Jumps"]

#: Corrections up to which a step has followed its path: most take two or three, where much damage begins up to eight.
_FOLLOWED = 8


class Jumps:
    """Remembers where damage jumped in a run.

    Where contacts break suddenly there are several states of equilibrium beyond, and the length of the step decides
    which of them is found. Such a step takes many corrections, or fails and is tried again in another way
    (`benchmarks/step_length.py`).
    """

    def __init__(self) -> None:
        self._failed = False
        self._found: list[tuple[int, float]] = []  # number of the step, and gauge
        self._peak, self._until = 0.0, 0

    def failed(self) -> None:
        """An attempt found no equilibrium."""
        self._failed = True

    def accepted(self, number: int, gauge: float, load: float, iterations: int) -> None:
        """Take note of an accepted step.

        Parameters
        ----------
        number : int
            Its number: 1, 2, ...
        gauge, load : float
            Gauge [m] and load [N] at its end.
        iterations : int
            Corrections that its solution took.
        """
        if self._failed or iterations > _FOLLOWED:
            self._found.append((number, gauge))
        self._failed = False
        if abs(load) > self._peak:
            self._peak, self._until = abs(load), number

    def notices(self) -> tuple[Notice, ...]:
        """What is to be said of jumps before the peak, or at it."""
        before = [(number, gauge) for number, gauge in self._found if number <= self._until]
        if not before:
            return ()
        first, gauge = before[0]
        return (
            Notice(
                "control.max_step",
                f"damage jumped before the peak in {len(before)} of {self._until} steps, first at step {first} (gauge"
                f" {gauge:.3g} m): what comes then depends on the length of steps, and the peak may by some per cent",
                "see whether a run with a smaller max_step has the same peak",
            ),
        )
