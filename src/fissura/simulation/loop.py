"""The loop over steps: equilibrium, criterion, refinement, the same step again (theory section 5).

It yields accepted steps and knows no files.
"""

import time
from collections.abc import Iterator

from fissura.case import Case
from fissura.errors import Notice
from fissura.machine.memory import within_memory
from fissura.material.field import RandomField
from fissura.simulation.advance import advance
from fissura.simulation.discretization import Discretization
from fissura.simulation.model import Model
from fissura.simulation.start import started
from fissura.simulation.state import State
from fissura.simulation.step import Step
from fissura.simulation.stopping import stopping
from fissura.specimen import Domain
from fissura.tessellation import Tessellation


class Simulation:
    """One specimen, broken step by step.

    Parameters
    ----------
    case : Case
        What to do.
    full : bool
        Every nucleus is fine from the start: the reference for the adaptive run of the same case.

    Attributes
    ----------
    case, full : Case, bool
        As given.
    bodies_full, bodies_start : int
        Bodies at full resolution, and at the start of this run.
    bodies_full_estimated : bool
        Whether the former is an estimate, since they are placed in blocks and not all of them are needed.
    nuclei_given : int
        Nuclei that a file gave; full resolution has these, and those added to them.
    model : Model
        What follows from the case and the state.
    state : State or None
        Where the run stands; None before its start. It goes on from a state that is put here.

    Raises
    ------
    InputError
        Something in the case cannot be built.

    Examples
    --------
    >>> simulation = fissura.Simulation(case)
    >>> simulation.bodies_start == len(simulation.tessellation)
    True
    >>> for step in simulation.steps():
    ...     if step.load < 0.5 * result.peak_load:
    ...         break
    """

    def __init__(self, case: Case, *, full: bool = False) -> None:
        self.wall_start, self.cpu_start = time.perf_counter(), time.process_time()
        self.case, self.full = case, full
        with within_memory("discretization.l_f", "the bodies of the specimen", "a larger spacing"):
            self._discretization = Discretization(case, full=full)
        self.bodies_full = self._discretization.bodies_full
        self.bodies_full_estimated = self._discretization.estimated
        self.nuclei_given = self._discretization.nuclei.given
        self.bodies_start = len(self.tessellation)
        self.state: State | None = None
        self.model = Model(case, self._discretization)

    @property
    def tessellation(self) -> Tessellation:
        """The current discretization."""
        return self._discretization.system.tessellation

    @property
    def told_full(self) -> str:
        """Bodies at full resolution, as messages tell them."""
        return self._discretization.told_full

    @property
    def domain(self) -> Domain:
        """The specimen."""
        return self._discretization.domain

    @property
    def field(self) -> RandomField | None:
        """Relative strength as a function of position; None where it is the same everywhere."""
        return self._discretization.field

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What looks wrong in the case, and what a run has met so far."""
        state = self.state
        return (*self._discretization.notices, *(() if state is None else (*state.met, *state.jumps.notices())))

    @property
    def elastic_scale(self) -> float:
        """Factor that calibration put on the stiffness of elastic contacts; 1 without calibration."""
        return 1.0 if self.state is None else self.state.layout.elastic_scale

    @property
    def calibration_error(self) -> float | None:
        """Relative error of the compliance that calibration met, as estimated; None where it was solved for."""
        return None if self.state is None else self.state.start.compliance_error

    @property
    def initial_stiffness(self) -> float:
        """Load over controlled quantity of the elastic structure at the start [N/m]; nan before it is known."""
        return float("nan") if self.state is None else self.state.start.stiffness

    @property
    def cpu_repeated(self) -> float:
        """Processor time so far of solutions that were given up for a refinement [s]."""
        return 0.0 if self.state is None else self.state.totals.cpu_repeated

    @property
    def cpu_refining(self) -> float:
        """Processor time so far of refinements: tessellation, equations, and settling on them [s]."""
        return 0.0 if self.state is None else self.state.totals.cpu_refining

    def start(self) -> State:
        """The state before the first step.

        Returns
        -------
        State
            The elastic structure, without load.

        Raises
        ------
        InputError
            The case is refused.
        RunStopped
            A calculation failed.

        Examples
        --------
        >>> fissura.Simulation(case).start().number
        0
        """
        with stopping(lambda: (1, 0.0, "m"), refusing=True):
            return started(self.model, (self.bodies_start, self.told_full))

    @property
    def ended(self) -> bool:
        """Whether the run is over."""
        return self.state is not None and self.model.ended(self.state)

    def steps(self) -> Iterator[Step]:
        """Accepted steps, until the target is reached; `state` goes with them.

        Yields
        ------
        Step
            One after another.

        Raises
        ------
        RunStopped
            No equilibrium was found even with the smallest step, or a calculation failed; the steps yielded so far are
            valid.
        InputError
            The case is refused before its first step.

        Examples
        --------
        >>> loads = [step.load for step in fissura.Simulation(case).steps()]
        >>> max(loads) == result.peak_load
        True
        """
        state = self.state = self.start() if self.state is None else self.state
        while not self.model.ended(state):
            state, step = advance(self.model, state)
            self.state = state
            yield step
