"""A state without what follows from the rest of it, as it is saved, and the state again."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from fissura.adaptivity import Coarsening, Layout, RefinedRegion
from fissura.arrays import FloatArray, IntArray
from fissura.contact import AppliedLaw
from fissura.equilibrium import (
    Equilibrium,
    Leading,
    Leg,
    SecantMemory,
    SolverMemory,
    StepLength,
    System,
)
from fissura.errors import InputError, Notice
from fissura.simulation.jumps import Jumps
from fissura.simulation.state import Before, Effort, Start, State, Totals

if TYPE_CHECKING:
    from fissura.simulation.model import Model


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
        With a `SavedResponse`, with `Rows` of what contacts have left, and without forces that are the unit load.
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


@dataclass(frozen=True)
class Noted:
    """A state with what of its equations decides what is saved: nothing is computed before that is asked for.

    Attributes
    ----------
    state : State
        A state between two steps.
    damageable : (k,) array
        Contacts with damage.
    moduli : (m, 3) array
        Stiffness of all contacts [Pa].
    law : AppliedLaw
        Law of the contacts with damage.
    digest : str
        Of the discretization.
    """

    state: State
    damageable: IntArray
    moduli: FloatArray
    law: AppliedLaw
    digest: str

    @classmethod
    def of(cls, state: State, system: System) -> Noted:
        """Note a state with the equations of its layout."""
        return cls(state, system.damageable, system.moduli, system.law, digest(system))

    def saved(self) -> SavedState:
        """What of the state does not follow from the rest."""
        state, response = self.state, self.state.now.response
        usual = response.strain[self.damageable] * self.moduli[self.damageable]
        kept: Any = SavedResponse(
            response.u,
            Rows.of(response.traction[self.damageable], usual),
            Rows.of(response.history, self.law.initial_history()),
        )
        solver, secant = state.solver, state.solver.secant
        if secant is not None:
            intact: Any = Rows.of(secant.intact, np.ones_like(secant.intact))
            forces = np.empty(0) if secant.exact else secant.unit_forces
            solver = replace(solver, secant=replace(secant, intact=intact, unit_forces=forces))
        state = replace(state, now=replace(state.now, response=kept), solver=solver)
        return SavedState(state, self.digest)

    def seen(self) -> Noted:
        """The same to be looked at only, not to go on from."""
        return replace(self, state=replace(self.state, before=None, solver=SolverMemory()))


def restored(found: SavedState, model: Model) -> State:
    """The state again, in a model that is made of the same case; the model has its equations then.

    Raises
    ------
    InputError
        The discretization is another one.
    """
    state = found.state
    system = model.at(state)
    if digest(system) != found.digest:
        raise InputError(
            "--resume",
            "the specimen is not the one of the checkpoint, although the case is the same",
            "files that the case names, Fissura and its libraries as they were; or begin anew, with --overwrite",
        )
    kept: Any = state.now.response
    strain = system.strain(kept.u)
    damaged = kept.damaged.put(strain[system.damageable] * system.moduli[system.damageable])
    response = system.answer(kept.u, strain, damaged, kept.history.put(system.virgin()))
    solver, secant = state.solver, state.solver.secant
    if secant is not None:
        saved_intact: Any = secant.intact
        intact = saved_intact.put(np.ones((len(system.damageable), 3)))
        forces = system.load if secant.exact else secant.unit_forces
        solver = replace(solver, secant=replace(secant, intact=intact, unit_forces=forces))
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
