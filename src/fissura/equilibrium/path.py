"""What leads along the path of a specimen: a gauge, or the energy that is dissipated.

A gauge leads as long as it grows. Where it would have to turn back (snap-back) there is no equilibrium at its next
value; the energy dissipated always grows, and takes over until the gauge grows steadily again (Gutierrez 2004;
Verhoosel, Remmers & Gutierrez 2009).
"""

import logging
import math
from dataclasses import dataclass, replace
from typing import Any

from fissura.case import LoadingStage
from fissura.equilibrium import limits
from fissura.equilibrium.constraint import Constraint, dissipating, prescribed
from fissura.equilibrium.leg import Leg
from fissura.equilibrium.settled import Equilibrium
from fissura.equilibrium.steps import StepLength
from fissura.equilibrium.system import System

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Goal:
    """Where a step is to end.

    Attributes
    ----------
    control : str
        What leads: "gauge", "displacement", "force" or "dissipation".
    size : float
        Value of the controlled quantity at the end [m or N], or energy to dissipate [J].
    patience : int
        Factor on the number of iterations.
    """

    control: str
    size: float
    patience: int = 1

    @property
    def in_energy(self) -> bool:
        """Whether energy leads."""
        return self.control == "dissipation"

    def constraint(self, system: System, now: Equilibrium) -> Constraint:
        """The equation for a step that begins at an equilibrium."""
        if self.in_energy:
            return dissipating(system, now.response, now.load, self.size)
        return prescribed(system, self.size, now.value)


@dataclass(frozen=True)
class Leading:
    """What is remembered of the steps so far, to choose the next one.

    Attributes
    ----------
    gauge, energy : StepLength
        Of steps under the gauge [m], and of those in energy [J].
    in_energy : bool
        Whether energy leads.
    leapt : bool
        The step just tried is too long to be sure of the peak.
    jumping : bool
        A jump is to be followed under the gauge.
    failures : int
        Failed attempts at the next step.
    growing, needed : int
        Steps in a row in which the gauge grew while energy led, and how many of them give it the lead again.
    since : int
        Steps since it has it.
    dissipated : float
        Energy dissipated in the last accepted step [J].
    top : float
        Largest size of the load factor on this leg [N].
    """

    gauge: StepLength
    energy: StepLength
    in_energy: bool = False
    leapt: bool = False
    jumping: bool = False
    failures: int = 0
    growing: int = 0
    needed: int = limits.GROWING
    since: int = limits.SOON
    dissipated: float = 0.0
    top: float = 0.0


class PathFollower:
    """Chooses goals, learning from how earlier ones were met.

    Parameters
    ----------
    leg : Leg
        The way to go.
    stage : LoadingStage
        The stage to which it belongs.
    energy : float
        What it takes to break the specimen, roughly [J]: a step dissipates the share ``energy_step`` at most.
    limit : float
        Way at which the first contact comes to its strength [m or N]: the first step ends there at the latest, and the
        smallest step shrinks with the first one.
    memory : Leading, optional
        What is remembered of earlier steps; nothing by default.

    Attributes
    ----------
    memory : Leading
        What is remembered now.
    """

    def __init__(
        self,
        leg: Leg,
        stage: LoadingStage,
        energy: float,
        limit: float = math.inf,
        memory: Leading | None = None,
    ) -> None:
        self._leg, self._quantity = leg, leg.quantity
        self._by_force = leg.quantity == "force"
        self._always = stage.energy and not self._by_force and leg.loads
        self._may_switch = (self._always or stage.switch) and not self._by_force
        self._stop_load = stage.stop_load if leg.loads else 0.0
        self._alone = not leg.kept.any()
        self.memory = self._beginning(leg, energy, limit) if memory is None else memory

    @staticmethod
    def _beginning(leg: Leg, energy: float, limit: float) -> Leading:
        """What is known before the first step."""
        first = min(leg.first, max(limit, limits.LEAST_FIRST * leg.first))
        longest = energy * leg.share
        return Leading(
            StepLength.starting(first, leg.longest, leg.smallest * (first / leg.first)),
            StepLength(longest, longest / 2.0**limits.HALVINGS, 0),
            top=abs(leg.load),
        )

    def _remember(self, **changes: Any) -> None:
        self.memory = replace(self.memory, **changes)

    @property
    def length(self) -> float:
        """Length of the next step under the gauge, or what else is controlled [m or N]."""
        return self.memory.gauge.length

    @property
    def smallest(self) -> float:
        """Step under the gauge below which a run is given up [m]."""
        return self.memory.gauge.smallest

    def ended(self, value: float) -> bool:
        """Whether the leg is over, with this value of the controlled quantity."""
        return self._leg.progress(value) >= self._leg.length * (1.0 - limits.AT_END)

    def broken(self, load: float, peak: float) -> bool:
        """Whether nothing more is to be done: the load factor [N] has fallen far below the peak."""
        least = max(self._stop_load, limits.BROKEN if self.memory.in_energy and self._alone else 0.0)
        return abs(load) < least * peak <= self.memory.top

    def goal(self, value: float) -> Goal:
        """Goal of the next step, from a value of the controlled quantity."""
        if self.memory.in_energy:
            return Goal("dissipation", self.memory.energy.length)
        patient = self.memory.failures >= limits.CUTS and (self.memory.jumping or not self._may_switch)
        patient = patient and self.memory.failures < limits.CUTS + limits.PATIENT_ATTEMPTS
        leg = self._leg
        end = leg.value(self.memory.gauge.next_value(leg.progress(value), leg.length))
        return Goal(self._quantity, end, limits.PATIENCE if patient else 1)

    def skipped(self, goal: Goal, now: Equilibrium, found: Equilibrium, peak: float) -> bool:
        """Whether a converged step left something out, so that it is not to be accepted.

        It lost load, and with it a part of the path that energy can follow, or is so long that the peak may lie within
        it; `failed` shortens it then.

        Parameters
        ----------
        goal : Goal
            Its goal.
        now, found : Equilibrium
            Where it began and ended.
        peak : float
            Largest load so far [N].
        """
        if goal.in_energy or self.memory.jumping:
            return False
        leg = self._leg
        so_far, far = leg.progress(now.value), leg.progress(found.value)
        long = not self._by_force and so_far > 0.0 and far > (1.0 + limits.SHORT_STEP) * so_far
        leapt = long and abs(now.load) >= limits.TOP * peak and leg.softened(now, found, limits.STIFF)
        leapt = leapt and self.memory.gauge.halved() is not None
        self._remember(leapt=leapt)
        return leapt or (self._may_switch and leg.forward(now.load - found.load) > limits.JUMP * peak)

    def succeeded(self, goal: Goal, now: Equilibrium, found: Equilibrium, dissipated: float) -> None:
        """Take note of an accepted step.

        Parameters
        ----------
        goal, now, found
            As of :meth:`skipped`.
        dissipated : float
            Energy dissipated [J].
        """
        leg, value, iterations = self._leg, found.value, found.iterations
        growth, top = leg.progress(value) - leg.progress(now.value), max(self.memory.top, abs(found.load))
        self._remember(failures=0, jumping=False, dissipated=dissipated, top=top)
        if goal.in_energy:
            gauge, needed = self.memory.gauge, self.memory.needed
            growing = self.memory.growing + 1 if growth >= gauge.length / needed else 0
            self._remember(energy=self.memory.energy.after(iterations, 0.0), growing=growing)
            steady = growing >= needed or (growth > gauge.longest and needed == limits.GROWING)
            if steady and not self._always:
                # It begins with steps as long as those that energy made, lest it leap over what comes.
                first = min(max(growth, gauge.smallest), gauge.longest)
                gauge = StepLength.starting(first, gauge.longest, gauge.smallest)
                self._remember(in_energy=False, since=0, gauge=gauge)
                _log.info("controlled by the %s again, at %.4g m", self._quantity, value)
            return
        self._remember(since=self.memory.since + 1, gauge=self.memory.gauge.after(iterations, leg.progress(value)))
        loading = leg.forward(found.load) > 0.0
        if self._always and loading and dissipated >= limits.DAMAGE_BEGINS * self.memory.energy.longest:
            self._take_over()

    def failed(self, load: float) -> bool:
        """Take note of a step that was not accepted; False when nothing is left to try.

        Parameters
        ----------
        load : float
            Load factor where it began [N]: energy cannot lead where there is none, or where the way unloads.
        """
        gauge = self.memory.gauge
        shorter = gauge.halved()
        if self.memory.leapt:
            self._remember(leapt=False, gauge=shorter or gauge)
            return True
        failures = self.memory.failures + 1
        self._remember(failures=failures)
        if self.memory.in_energy:
            less = self.memory.energy.halved()
            if less is not None:
                self._remember(energy=less)
            else:
                self._remember(in_energy=False, jumping=True, failures=limits.CUTS)
            return True
        if self._may_switch and not self.memory.jumping and self._leg.forward(load) > 0.0:
            if self._damaging or failures > limits.ELASTIC_CUTS or shorter is None:
                self._take_over()
            else:
                self._remember(gauge=shorter)
            return True
        if shorter is None:
            if failures > limits.CUTS:
                return False
            self._remember(failures=limits.CUTS)
            return True
        self._remember(gauge=shorter)
        return True

    @property
    def _first(self) -> float:
        """Least energy of the first step in which energy leads [J]."""
        return self.memory.energy.longest / 2.0**limits.FIRST_HALVINGS

    @property
    def _damaging(self) -> bool:
        """Whether the last step did some damage."""
        return self.memory.dissipated > self._first

    def _take_over(self) -> None:
        """Let energy lead, with steps that dissipate as much as the last one did."""
        memory = self.memory
        first = min(max(memory.dissipated, self._first), memory.energy.longest)
        energy = StepLength.starting(first, memory.energy.longest, memory.energy.smallest)
        needed = min(2 * memory.needed, limits.MOST_GROWING) if memory.since < limits.SOON else limits.GROWING
        self._remember(energy=energy, needed=needed, in_energy=True, failures=0, growing=0)
        _log.info("dissipation control is active, with %.3g J a step", energy.length)
