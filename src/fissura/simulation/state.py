"""All that decides how a run goes on, as data: what a run may be continued from, bit for bit."""

from dataclasses import dataclass, field

from fissura.adaptivity import Layout
from fissura.arrays import FloatArray
from fissura.equilibrium import Equilibrium, Leading, Leg, SolverMemory
from fissura.errors import Notice
from fissura.simulation.jumps import Jumps


@dataclass(frozen=True)
class Start:
    """What is found once, before the first step.

    Attributes
    ----------
    stiffness : float
        Load over controlled quantity of the elastic structure at the start [N/m].
    limit : float
        Controlled quantity at which its first contact comes to its strength [m].
    compliance : float or None
        Controlled quantity per unit load of the undamaged structure at full resolution [m/N]; None where nothing is
        calibrated.
    compliance_error : float or None
        Estimate of its relative error where it was extrapolated; None elsewhere.
    """

    stiffness: float
    limit: float
    compliance: float | None = None
    compliance_error: float | None = None


@dataclass(frozen=True)
class Before:
    """The state before the last accepted one, on the same discretization: the next step is extrapolated from both.

    Attributes
    ----------
    u : (6 n,) array
        Displacements and rotations.
    load, value : float
        Load [N] and controlled quantity [m].
    """

    u: FloatArray
    load: float
    value: float


@dataclass(frozen=True)
class Totals:
    """Sums over all accepted steps.

    Attributes
    ----------
    forces, displacements : (L,) array
        Of all loads now [N, m].
    dissipated : float
        Energy [J].
    dissipated_at : (L + s + 1,) array or float
        The same at every load but the weight, at every support, and at all of them [J]; 0 before the first step.
    work : float
        Of all loads [J].
    exchanged : float
        Energy that changes of the discretization put in [J].
    peak : float
        Largest size of the load factor since its loads are the ones that are driven [N].
    cpu_repeated, cpu_refining : float
        Processor time of solutions that were given up for a refinement, and of refinements [s].
    """

    forces: FloatArray
    displacements: FloatArray
    dissipated: float = 0.0
    dissipated_at: FloatArray | float = 0.0
    work: float = 0.0
    exchanged: float = 0.0
    peak: float = 0.0
    cpu_repeated: float = 0.0
    cpu_refining: float = 0.0


@dataclass(frozen=True)
class Effort:
    """What was done since the last accepted step, failed attempts included; see :class:`Step`."""

    iterations: int = 0
    linear_iterations: int = 0
    factorizations: int = 0
    refinements: int = 0
    coarsenings: int = 0
    load_change: float = 0.0


@dataclass(frozen=True)
class State:
    """Where a run stands. Between two steps nothing else decides how it goes on.

    Attributes
    ----------
    layout : Layout
        The current discretization.
    now : Equilibrium
        The last accepted state on it.
    start : Start
        What was found before the first step.
    totals : Totals
        Sums over accepted steps.
    leg : Leg or None
        The way that it is on; None before the first one.
    leading : Leading or None
        What is remembered to choose the next step; None before the first leg.
    number : int
        Accepted steps.
    before : Before or None
        The accepted state before; None where there is none on this discretization.
    spent : float
        Energy dissipated in the last step [J].
    in_energy : bool
        Whether energy led there.
    jumps : Jumps
        Where damage jumped.
    met : tuple of Notice
        What looks wrong.
    solver : SolverMemory
        What solvers keep.
    effort : Effort
        What was done since the last accepted step; nothing, between two steps.
    aim : (k, h) array or None
        History that the step being repeated had found before refinement; None between two steps.
    """

    layout: Layout
    now: Equilibrium
    start: Start
    totals: Totals
    leg: Leg | None = None
    leading: Leading | None = None
    number: int = 0
    before: Before | None = None
    spent: float = 0.0
    in_energy: bool = False
    jumps: Jumps = field(default_factory=Jumps)
    met: tuple[Notice, ...] = ()
    solver: SolverMemory = field(default_factory=SolverMemory)
    effort: Effort = field(default_factory=Effort)
    aim: FloatArray | None = None

    def position(self) -> tuple[int, float, str]:
        """Number of the next step, and the value of the controlled quantity where it begins, with its unit."""
        by_force = self.leg is not None and self.leg.quantity == "force"
        return self.number + 1, self.now.value, "N" if by_force else "m"
