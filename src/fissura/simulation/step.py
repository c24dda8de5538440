"""What a run yields: accepted steps and their states, as data."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Quantity
from fissura.tessellation import Tessellation


@dataclass(frozen=True)
class Snapshot:
    """State of one accepted step.

    Attributes
    ----------
    tessellation : Tessellation
        Bodies and contacts.
    displacement : (n, 6) array
        Displacements [m] and rotations of the nuclei.
    stress : (n, 3, 3) array
        Stress in bodies [Pa].
    criterion : (n,) array
        Value of the refinement criterion, 1 at strength; nan for fine bodies.
    strain, traction : (m, 3) array
        Strains ``e_N, e_M, e_L`` and tractions [Pa] of contacts.
    tangents : (m, 2, 3) array
        Unit vectors m, l.
    damage : (m,) array
        Damage of contacts.
    opening : (m,) array
        Crack opening ``L D e_N`` where ``e_N > 0`` [m].
    body_factor, contact_factor : (n,), (m,) array or None
        Relative strength at nuclei and at centroids of facets; None where it is the same everywhere.

    Examples
    --------
    >>> state = result.last
    >>> state.displacement.shape == (len(state.tessellation), 6)
    True
    >>> widest = state.tessellation.contacts.centroid[state.opening.argmax()]
    """

    tessellation: Tessellation
    displacement: FloatArray
    stress: FloatArray
    criterion: FloatArray
    strain: FloatArray
    traction: FloatArray
    tangents: FloatArray
    damage: FloatArray
    opening: FloatArray
    body_factor: FloatArray | None = None
    contact_factor: FloatArray | None = None


@dataclass(frozen=True)
class Moment:
    """A step as far as it is kept.

    Attributes
    ----------
    number, gauge, load, controlled, snapshot
        As of :class:`Step`.
    """

    number: int
    gauge: float
    load: float
    controlled: float
    snapshot: Snapshot


@dataclass(frozen=True)
class Step:
    """One accepted step.

    Attributes
    ----------
    number : int
        1, 2, ...
    gauge : float
        The gauge of the last stage, or where it has none the displacement of its load [m].
    load : float
        Load of the last stage [N]: its load factor, also before it is the one that is driven.
    load_displacement : float
        Mean displacement of the places of its loads, along them, times their ratios [m].
    bodies, fine_bodies : int
        Bodies, and those of them in the refined region.
    refinements, coarsenings : int
        Changes of the discretization since the step before: each refinement repeated this step.
    iterations, linear_iterations, factorizations : int
        Corrections, applications of the preconditioner in them, and preparations of linear solvers since the step
        before, repeats and failed attempts included.
    dissipated, stored, work : float
        Energy dissipated so far, elastic energy now, work of the load so far [J].
    exchanged : float
        Energy that changes of the discretization put in so far [J]: ``stored + dissipated = work + exchanged``.
    max_elastic_utilisation : float
        Largest effective traction over strength among elastic contacts.
    residual : float
        Relative force residual.
    snapshot : Snapshot
        The state.
    control : str
        What led in this step: "gauge", "displacement", "force" or "dissipation".
    load_change : float
        Sizes of all changes of the load that refinement made at a kept gauge since the step before [N].
    spent : (m,) array
        Energy that each contact of the snapshot dissipated in this step [J].
    quantity : str
        The controlled quantity: "gauge" or "displacement" of the load.
    reactions : (s, 6) array
        Force [N] and moment about the middle of its place [N m] of every support, on the specimen.
    held : (s,) tuple of str
        Names of the supports, and of what guides platens.
    rest : (6,) array
        Force [N], and moment about the middle of the load's place [N m], that load and reactions leave out of balance.
    dissipated_at : (L + s + 1,) array
        Energy dissipated so far by contacts of the bodies on which every load but the weight acts, every support, and
        any of them [J].
    utilisation : (m,) array
        Effective traction over strength of the snapshot's coarse contacts, as the criterion saw it; 0 for fine contacts
        and in elastic regions.
    stage : int
        Number of the stage, 1, 2, ...
    done : float
        Share of the loading programme that is done.
    forces, displacements : mapping of str to float
        Force [N], and mean displacement of its place along it [m], of every load by its name.
    gauges : mapping of str to float
        Every gauge by its name [m].

    Examples
    --------
    >>> simulation = fissura.Simulation(case)
    >>> step = next(simulation.steps())
    >>> step.number, step.load > 0.0
    (1, True)
    """

    number: int
    gauge: float
    load: float
    load_displacement: float
    bodies: int
    fine_bodies: int
    refinements: int
    coarsenings: int
    iterations: int
    linear_iterations: int
    factorizations: int
    dissipated: float
    stored: float
    work: float
    exchanged: float
    max_elastic_utilisation: float
    residual: float
    snapshot: Snapshot
    control: str = "gauge"
    load_change: float = 0.0
    spent: FloatArray = field(default_factory=lambda: np.zeros(0))
    utilisation: FloatArray = field(default_factory=lambda: np.zeros(0))
    quantity: Quantity = "gauge"
    reactions: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))
    rest: FloatArray = field(default_factory=lambda: np.zeros(6))
    dissipated_at: FloatArray = field(default_factory=lambda: np.zeros(2))
    held: tuple[str, ...] = ()
    stage: int = 1
    done: float = 0.0
    forces: Mapping[str, float] = field(default_factory=lambda: {"load": 0.0})
    displacements: Mapping[str, float] = field(default_factory=lambda: {"load": 0.0})
    gauges: Mapping[str, float] = field(default_factory=dict)

    @property
    def controlled(self) -> float:
        """Value of the controlled quantity [m]; it may turn back where dissipated energy leads."""
        return self.gauge if self.quantity == "gauge" else self.load_displacement

    @property
    def moment(self) -> Moment:
        """What is kept of it."""
        return Moment(self.number, self.gauge, self.load, self.controlled, self.snapshot)
