"""A step of a run: equilibrium, criterion, refinement, the same step again (theory section 5)."""

import logging
import time
from dataclasses import replace

import numpy as np

from fissura.adaptivity import transfer_history
from fissura.arrays import BoolArray
from fissura.equilibrium import Equilibrium, Goal, PathFollower, System, settle
from fissura.errors import InputError, Notice, RunStopped
from fissura.linear import SingularMatrixError
from fissura.simulation import limits
from fissura.simulation.accepted import accepted
from fissura.simulation.entering import entered
from fissura.simulation.found import Found
from fissura.simulation.guess import guessed
from fissura.simulation.model import Model
from fissura.simulation.state import State
from fissura.simulation.step import Step
from fissura.simulation.stopping import FAILURES, reason, stopping

_log = logging.getLogger(__name__)


def advance(model: Model, state: State) -> tuple[State, Step]:
    """Go on by one accepted step.

    Parameters
    ----------
    model : Model
        What is run.
    state : State
        Where the run stands, in the same case.

    Returns
    -------
    state : State
        Where it stands then.
    step : Step
        The step, to be recorded.

    Raises
    ------
    RunStopped
        No equilibrium was found even with the smallest step, or a calculation failed.
    """
    with stopping(state.position):
        if state.leg is None or model.follower(state, memory=state.leading).ended(state.now.value):
            way = model.ahead(state)
            assert way is not None
            model.begin(state)
            state = entered(model, state, way)
        else:
            model.begin(state)
        if state.number:
            state = _coarsened(model, state)
        state, step = _stepped(model, state)
    model.end(state)
    return state, step


def _stepped(model: Model, state: State) -> tuple[State, Step]:
    """Try one goal after another until one is reached."""
    follower = model.follower(state, memory=state.leading)
    begun, dissipated = state.now, state.totals.dissipated
    while True:
        goal = follower.goal(state.now.value)
        state, found = _attempted(model, state, follower, goal)
        if found is not None:
            break
        if not follower.failed(state.now.load):
            number, _, unit = state.position()
            raise RunStopped(_lost(model, state, follower), number, goal.size, unit)
    state, step = accepted(model, state, goal, found)
    last = found.equilibrium.iterations
    follower.succeeded(goal, begun, found.equilibrium, state.totals.dissipated - dissipated)
    jumps = state.jumps.accepted(step.number, step.gauge, step.load, last)
    return replace(state, leading=follower.memory, jumps=jumps, solver=model.solver.memory(model.system)), step


def _lost(model: Model, state: State, follower: PathFollower) -> str:
    """Why no step was found."""
    tried = f"no equilibrium within {model.solver.max_iterations} iterations, even with a step of"
    key = f"{model.stage(state).key}.min_step"
    if model.system.by_force:
        return (
            f"the specimen bears no more than about {state.now.load:.4g} N: {tried} {follower.length:.3g} N (the"
            f" smallest one is {follower.smallest:.3g} N, see {key}); only a displacement can lead beyond the peak"
        )
    return f"{tried} {follower.length:.3g} m (the smallest one is {follower.smallest:.3g} m, see {key})"


def _attempted(model: Model, state: State, follower: PathFollower, goal: Goal) -> tuple[State, Found | None]:
    """One step with all its refinements; None when no equilibrium was found."""
    solver, sensitivity = model.solver, model.case.adaptivity
    refinements = 0
    while True:
        system, began, peak = model.system, time.process_time(), state.totals.peak
        counted = system.symmetric.factorizations
        found = solver.solve(
            system,
            state.now.response.history,
            goal.constraint(system, state.now),
            guessed(system, state, goal),
            limits.LEAST_LOAD * peak,
            patience=goal.patience,
        )
        iterations = goal.patience * solver.max_iterations if found is None else found.iterations
        state = _worked(
            state,
            factorizations=system.symmetric.factorizations - counted,
            linear_iterations=solver.linear_iterations,
            iterations=iterations,
        )
        if found is None:
            return replace(state, jumps=state.jumps.failed()), None
        if follower.skipped(goal, state.now, found, peak):
            return state, None
        elastic, criterion = model.discretization.assess(found.response, found.load)
        if not (np.nan_to_num(criterion) > sensitivity.gamma).any():
            return state, Found(found, elastic, criterion)
        refinements += 1
        state = _worked(state, refinements=1)
        if refinements > limits.MOST_REFINEMENTS:
            raise RunStopped(f"{refinements - 1} refinements did not satisfy the criterion", *state.position())
        # Bodies that would be critical soon are taken along: re-tessellation costs more than a few bodies.
        soon = np.nan_to_num(criterion) > sensitivity.ahead * sensitivity.gamma
        solved = time.process_time()
        try:
            state = _refined(model, state, soon, found)
        except (InputError, SingularMatrixError) as error:
            raise RunStopped(f"the refined discretization cannot be used: {error}", *state.position()) from error
        state = _worked(state, factorizations=model.system.symmetric.factorizations)
        totals = state.totals
        repeated, refining = totals.cpu_repeated + solved - began, totals.cpu_refining + time.process_time() - solved
        state = replace(state, totals=replace(totals, cpu_repeated=repeated, cpu_refining=refining))


def _worked(state: State, **more: int | float) -> State:
    """With more effort."""
    effort = state.effort
    return replace(state, effort=replace(effort, **{name: getattr(effort, name) + n for name, n in more.items()}))


def _refined(model: Model, state: State, critical: BoolArray, found: Equilibrium) -> State:
    """Refine around critical bodies and settle the last accepted state on the new discretization."""
    old = model.system
    old.symmetric.release()  # a half of the memory of large runs, which the new equations need
    new = model.discretization.refine(old.tessellation.x[critical])
    state = _moved(state, old, new)
    aim = transfer_history(old.pairs(), found.response.history, new.pairs(), new.virgin())
    _log.info("refined to %d bodies at %.4g m", len(new.tessellation), state.now.value)
    return replace(state, layout=model.discretization.layout, aim=aim)


def _coarsened(model: Model, state: State) -> State:
    """Give up what is fine and not needed any more, where that pays, and settle the last accepted state there."""
    old, moved = model.system, state

    def settled(system: System) -> None:
        nonlocal moved
        moved = _moved(state, old, system)

    try:
        changed = model.discretization.coarsen(state.now.response, settled)
    except FAILURES as error:
        # The fine structure is as it was, and as good: the run goes on with it.
        model.discretization.keep_fine()
        notice = Notice(
            "adaptivity.coarsen",
            f"what had unloaded could not be made coarse again after step {state.number} ({reason(error)}); the run"
            " goes on without",
            "nothing, if it ends in time; coarsen = false does not try",
        )
        _log.warning(notice)
        return replace(state, layout=model.discretization.layout, met=(*state.met, notice))
    if changed:
        _log.info("coarsened to %d bodies at %.4g m", len(model.system.tessellation), moved.now.value)
        moved = _worked(moved, coarsenings=1)
    return replace(moved, layout=model.discretization.layout)


def _moved(state: State, old: System, system: System) -> State:
    """Settle the last accepted state on another discretization; where that fails, nothing has changed.

    The load and the energy stored jump a little. The jump of energy is kept apart, so that the balance of the rest
    can be told.
    """
    before, totals = state.now, state.totals
    history = transfer_history(old.pairs(), before.response.history, system.pairs(), system.virgin())
    if before.load == 0.0 and system.dead is None:
        rest = Equilibrium(system.response(np.zeros(system.size), history), 0.0, 0.0)
        return replace(state, before=None, now=rest)
    now = settle(system, history, before.value)
    totals = replace(
        totals,
        exchanged=totals.exchanged + (now.response.stored - before.response.stored),
        forces=system.forces(now.load),
        displacements=np.asarray(system.acting.load_rows @ now.response.u),
    )
    state = _worked(state, load_change=abs(now.load - before.load))
    return replace(state, before=None, now=now, totals=totals)
