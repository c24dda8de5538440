"""A state without what follows from the rest of it, as it is saved, and the state again."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from fissura.adaptivity import Coarsening, Layout, RefinedRegion
from fissura.equilibrium import (
    Equilibrium,
    Leading,
    Leg,
    Norms,
    SecantMemory,
    SolverMemory,
    StepLength,
    System,
)
from fissura.errors import InputError, Notice
from fissura.jumps import Jumps
from fissura.state import Before, Effort, Start, State, Totals

if TYPE_CHECKING:
    from fissura.model import Model

__all__ = ["TYPES", "Rows", "SavedResponse", "SavedState", "restored", "saved"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Rows:
    """Those rows of an array that differ from what they usually are, to the last bit.

    Attributes
    ----------
    rows : (r,) array
        Their numbers.
    values : (r, c) array
        Their values.
    """

    rows: NDArray[np.int32]
    values: FloatArray

    @classmethod
    def of(cls, values: FloatArray, usual: FloatArray) -> Rows:
        """What differs; (k, c) each."""
        other = np.ascontiguousarray(values).view(np.int64) != np.ascontiguousarray(usual).view(np.int64)
        rows = np.flatnonzero(other.any(axis=1))
        return cls(rows.astype(np.int32), values[rows])

    def put(self, usual: FloatArray) -> FloatArray:
        """The array again."""
        out = usual.copy()
        out[self.rows] = self.values
        return out


@dataclass(frozen=True)
class SavedResponse:
    """What a response does not follow from.

    Attributes
    ----------
    u : (6 n,) array
        Displacements and rotations.
    damaged, history : Rows
        Tractions of the contacts with damage that are not those without it [Pa], and history that is not initial.
    """

    u: FloatArray
    damaged: Rows
    history: Rows


@dataclass(frozen=True)
class SavedState:
    """A state as it is saved.

    Attributes
    ----------
    state : State
        With a `SavedResponse`, without fine nuclei, and without forces that are the unit load.
    digest : str
        Of the discretization that it belongs to.
    """

    state: State
    digest: str


#: Dataclasses that a saved state may be made of.
TYPES: tuple[type, ...] = (
    Before,
    Coarsening,
    Effort,
    Equilibrium,
    Jumps,
    Layout,
    Leading,
    Leg,
    Norms,
    Notice,
    RefinedRegion,
    Rows,
    SavedResponse,
    SavedState,
    SecantMemory,
    SolverMemory,
    Start,
    State,
    StepLength,
    Totals,
)


def saved(state: State, system: System) -> SavedState:
    """What of a state does not follow from the rest.

    Parameters
    ----------
    state : State
        A state between two steps.
    system : System
        The equations of its layout.
    """
    response, active = state.now.response, system.active
    usual = response.strain[active] * system.moduli[active]
    kept: Any = SavedResponse(
        response.u,
        Rows.of(response.traction[active], usual),
        Rows.of(response.history, system.virgin()),
    )
    solver, secant = state.solver, state.solver.secant
    if secant is not None and secant.exact:
        solver = replace(solver, secant=replace(secant, unit_forces=np.empty(0)))
    coarsening = replace(state.layout.coarsening, x=np.empty((0, 3)))
    state = replace(
        state,
        now=replace(state.now, response=kept),
        layout=replace(state.layout, coarsening=coarsening),
        solver=solver,
    )
    return SavedState(state, digest(system))


def restored(found: SavedState, model: Model) -> State:
    """The state again, in a model that is made of the same case; the model has its equations then.

    Raises
    ------
    InputError
        The discretization is another one.
    """
    state = found.state
    coarsening = replace(state.layout.coarsening, x=model.structure.nuclei.x)
    state = replace(state, layout=replace(state.layout, coarsening=coarsening))
    system = model.at(state)
    if digest(system) != found.digest:
        raise InputError(
            "--resume",
            "the specimen is not the one of the checkpoint, although the case is the same",
            "files that the case names, Fissura and its libraries as they were; or begin anew, with --overwrite",
        )
    kept: Any = state.now.response
    strain = system.strain(kept.u)
    damaged = kept.damaged.put(strain[system.active] * system.moduli[system.active])
    response = system.reached(kept.u, damaged, kept.history.put(system.virgin()))
    solver, secant = state.solver, state.solver.secant
    if secant is not None and secant.exact:
        solver = replace(solver, secant=replace(secant, unit_forces=system.load))
    return replace(state, now=replace(state.now, response=response), solver=solver)


def digest(system: System) -> str:
    """A short text that tells discretizations apart."""
    if system not in _DIGESTS:
        _DIGESTS[system] = _digest(system)
    return _DIGESTS[system]


#: It is asked for in every step.
_DIGESTS: WeakKeyDictionary[System, str] = WeakKeyDictionary()


def _digest(system: System) -> str:
    contacts, found = system.tessellation.contacts, hashlib.blake2b(digest_size=16)
    factor = np.empty(0) if system.contact_factor is None else system.contact_factor
    for values in (system.tessellation.x, contacts.bodies, contacts.area, system.moduli, factor):
        found.update(np.ascontiguousarray(values).data)
    return found.hexdigest()
