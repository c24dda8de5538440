"""Step lengths that adjust themselves.

Lengths are the longest one divided by powers of two, and every step ends at a multiple of its own length. Runs of one
case, adaptive or full, therefore meet at the same values of the controlled quantity as far as they can.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fissura.equilibrium import limits


@dataclass(frozen=True)
class StepLength:
    """Length of the next step.

    Attributes
    ----------
    longest : float
        Longest step [m].
    smallest : float
        Step below which a run is given up [m].
    level : int
        The step is ``longest / 2**level``.
    easy : int
        Easy steps in a row.
    """

    longest: float
    smallest: float
    level: int
    easy: int = 0

    @classmethod
    def starting(cls, first: float, longest: float, smallest: float) -> StepLength:
        """Begin with the length nearest below `first`."""
        level = 0
        while longest / 2**level > first * (1.0 + 1e-9):
            level += 1
        return cls(longest, smallest, level)

    @property
    def length(self) -> float:
        """Current length [m]."""
        return self.longest / float(2**self.level)

    def next_value(self, value: float, target: float) -> float:
        """End of the next step: the next multiple of the length, at most the target [m]."""
        count = int((value + limits.ALIGNED * self.length) / self.length) + 1
        # Without the last digit a multiple is the target that it stands for, also where that is not the target yet.
        end = float(f"{count * self.length:.15g}")
        return target if end > target - limits.ALIGNED * self.length else end

    def after(self, iterations: int, value: float) -> StepLength:
        """Length after a step that ended at `value` and took so many iterations."""
        if iterations >= limits.HARD:
            return self.halved() or replace(self, easy=0)
        if iterations > limits.EASY or self.level == 0:
            return replace(self, easy=0)
        easy = self.easy + 1
        doubled = 2.0 * self.length
        aligned = abs(value / doubled - round(value / doubled)) < limits.ALIGNED
        if easy >= limits.EASY_STEPS and aligned:
            return replace(self, level=self.level - 1, easy=0)
        return replace(self, easy=easy)

    def halved(self) -> StepLength | None:
        """Half the length, or None when that is below the smallest."""
        if 0.5 * self.length < self.smallest:
            return None
        return replace(self, level=self.level + 1, easy=0)
