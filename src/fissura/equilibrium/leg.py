"""A leg of a loading programme: the way from where a stage or the target before it ended to the next target."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fissura.arrays import FloatArray

if TYPE_CHECKING:
    from fissura.equilibrium.settled import Equilibrium


@dataclass(frozen=True)
class Leg:
    """What is driven, from where to where, and with what steps.

    Attributes
    ----------
    index : int
        Its number among the legs of the programme, from 0.
    quantity : str
        What is controlled: "gauge", "displacement" or "force".
    kept : (L,) array
        Forces of loads that act besides [N].
    begin, end : float
        Controlled quantity where it begins and where it is to end [m or N].
    load : float
        Load factor where it begins [N].
    slope : float
        1 if the load factor of the elastic structure grows with the controlled quantity, else -1.
    longest, first, smallest : float
        Steps [m or N].
    share : float
        Most energy that a step dissipates, over what it takes to break the specimen.
    """

    index: int
    quantity: str
    kept: FloatArray
    begin: float
    end: float
    load: float
    slope: float
    longest: float
    first: float
    smallest: float
    share: float

    @property
    def length(self) -> float:
        """Length of the way [m or N]."""
        return abs(self.end - self.begin)

    @property
    def _sense(self) -> float:
        return math.copysign(1.0, self.end - self.begin)

    @property
    def loads(self) -> bool:
        """Whether the load grows in size where it begins; from rest it does."""
        return self.load == 0.0 or self.forward(self.load) > 0.0

    def progress(self, value: float) -> float:
        """How far a value of the controlled quantity is on the way [m or N]."""
        return self._sense * (value - self.begin)

    def value(self, progress: float) -> float:
        """The controlled quantity so far on the way."""
        return self.end if progress == self.length else self.begin + self._sense * progress

    def forward(self, load: float) -> float:
        """A load factor, or a change of one, counted as positive where the elastic load of this way goes."""
        return self._sense * self.slope * load

    def softened(self, now: Equilibrium, found: Equilibrium, share: float) -> bool:
        """Whether load over way has fallen below a share of what it was."""
        before, after = (abs(state.load - self.load) for state in (now, found))
        return after * self.progress(now.value) < share * before * self.progress(found.value)
