"""Jumps of damage before the peak, which make it depend on the length of steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fissura.errors import Notice
from fissura.simulation import limits


@dataclass(frozen=True)
class Jumps:
    """Remembers where damage jumped in a run.

    Where contacts break suddenly there are several states of equilibrium beyond, and the length of the step decides
    which of them is found. Such a step takes many corrections, or fails and is tried again in another way
    (`benchmarks/step_length.py`).

    Attributes
    ----------
    number : (j,) tuple of int
        Steps in which it jumped.
    gauge : (j,) tuple of float
        Gauge at their ends [m].
    has_failed : bool
        An attempt at the next step has found no equilibrium.
    peak : float
        Largest load so far [N].
    until : int
        Step that reached it.
    """

    number: tuple[int, ...] = ()
    gauge: tuple[float, ...] = ()
    has_failed: bool = False
    peak: float = 0.0
    until: int = 0

    def failed(self) -> Jumps:
        """After an attempt that found no equilibrium."""
        return replace(self, has_failed=True)

    def accepted(self, number: int, gauge: float, load: float, iterations: int) -> Jumps:
        """After an accepted step.

        Parameters
        ----------
        number : int
            Its number: 1, 2, ...
        gauge, load : float
            Gauge [m] and load [N] at its end.
        iterations : int
            Corrections that its solution took.
        """
        found = self
        if self.has_failed or iterations > limits.FOLLOWED:
            found = replace(found, number=(*self.number, number), gauge=(*self.gauge, gauge))
        if abs(load) > self.peak:
            found = replace(found, peak=abs(load), until=number)
        return replace(found, has_failed=False)

    def notices(self) -> tuple[Notice, ...]:
        """What is to be said of jumps before the peak, or at it."""
        before = [found for found in zip(self.number, self.gauge, strict=True) if found[0] <= self.until]
        if not before:
            return ()
        first, gauge = before[0]
        return (
            Notice(
                "control.max_step",
                f"damage jumped before the peak in {len(before)} of {self.until} steps, first at step {first} (gauge"
                f" {gauge:.3g} m): results after that step depend on the length of"
                " steps, and the peak may change by a few per cent",
                "see whether a run with a smaller max_step has the same peak",
            ),
        )
