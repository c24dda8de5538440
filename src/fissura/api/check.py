"""What a case would run: sizes, limits and warnings, without solving anything."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fissura.api.stages import stages_in_words, study_in_words
from fissura.case import Case, case_of
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.contact import limits_from_case
from fissura.errors import InputError, Notice
from fissura.kernels import seconds_to_compile
from fissura.machine.memory import gigabytes, physical_memory
from fissura.material.field import RandomField
from fissura.results.measured import read_measured
from fissura.simulation.described import described
from fissura.simulation.loop import Simulation
from fissura.simulation.memory import estimate_bodies, estimate_memory, require_memory
from fissura.specimen import Domain
from fissura.text.quantities import force
from fissura.text.rows import Described, aligned

_QUICK = 3.0
"""Compiling that takes no longer [s] is done for a check."""


@dataclass(frozen=True, repr=False)
class CheckReport(Described):
    """What would be run.

    Attributes
    ----------
    name : str
        Name of the case.
    law, criterion : str
        Contact law and refinement criterion.
    bodies_start : int or None
        Bodies of the first discretization; None where it was not built.
    bodies_full : int
        Bodies of the whole specimen at full resolution; estimated where not all of it was built.
    nuclei_given : int
        Nuclei of full resolution that a file gave.
    contacts, fine_contacts : int or None
        Contacts of the first discretization, and those of them with the damage law; None where it was not built.
    memory_full : float
        Estimated memory [bytes] of full resolution.
    memory_machine : float
        Memory of this machine [bytes].
    limits : mapping of str to float
        Limits [m] on the length of a fine contact, by the names that the law gives them.
    longest_contact : float
        Longest fine contact [m] there can be: that of the first discretization, or twice ``l_f``, four times it beside
        a notch.
    stages : tuple of pairs of str
        What is controlled in every stage, and how far and in what steps, in words.
    weight : float, optional
        Weight of the specimen [N]; None without gravity.
    warnings : tuple of Notice
        What looks wrong, and what to do about it.
    contact : tuple of float
        Elastic constants of the contacts: normal modulus [Pa], and tangential over normal stiffness.
    macro : tuple of float, optional
        Modulus of elasticity [Pa] and Poisson's ratio of the material as a whole; None where the table of bulk values
        ends.
    field_rows : tuple of pairs of str
        Name and value of what there is to say about the random field.
    study : str
        What the table ``[ensemble]`` asks for, in words; empty without one.
    estimated : bool
        Whether `bodies_full` is an estimate.

    Examples
    --------
    >>> report = fissura.check(case)
    >>> report.bodies_start < report.bodies_full
    True
    >>> report.warnings
    ()
    """

    name: str
    law: str
    criterion: str
    bodies_start: int | None
    bodies_full: int
    contacts: int | None
    fine_contacts: int | None
    memory_full: float
    memory_machine: float
    limits: Mapping[str, float]
    longest_contact: float
    stages: tuple[tuple[str, str], ...]
    weight: float | None = None
    warnings: tuple[Notice, ...] = ()
    contact: tuple[float, float] = (math.nan, math.nan)
    macro: tuple[float, float] | None = None
    nuclei_given: int = 0
    field_rows: tuple[tuple[str, str], ...] = ()
    study: str = ""
    estimated: bool = True

    @property
    def memory_start(self) -> float | None:
        """Estimated memory of the first discretization [bytes]; None where it was not built."""
        return None if self.bodies_start is None else estimate_memory(self.bodies_start)

    @property
    def _bodies(self) -> list[tuple[str, str]]:
        full = ("bodies at full resolution", f"about {self.bodies_full}" if self.estimated else f"{self.bodies_full}")
        if self.memory_start is None:
            return [("bodies at start", "not counted: fissura check --build counts them, after compiling"), full]
        nuclei = ("nuclei from the file", f"{self.nuclei_given}, and {self.bodies_full - self.nuclei_given} added")
        return [
            ("bodies at start", f"{self.bodies_start}"),
            full,
            *([nuclei] if self.nuclei_given else []),
            ("contacts at start", f"{self.contacts}, {self.fine_contacts} with damage"),
            ("memory at start", f"about {gigabytes(self.memory_start)}, grows with refinement"),
        ]

    @property
    def _stages(self) -> list[tuple[str, str]]:
        several = len(self.stages) > 1
        return [
            (f"{name}, stage {k}" if several else name, text)
            for k, stage in enumerate(self.stages, 1)
            for name, text in zip(("control", "steps"), stage, strict=True)
        ]

    def _rows(self) -> list[tuple[str, str]]:
        return [
            ("case", self.name),
            ("law, criterion", f"{self.law}, {self.criterion}"),
            ("elastic, contacts", f"E {self.contact[0] / 1e9:.4g} GPa, alpha {self.contact[1]:.4g}"),
            ("elastic, bulk", f"E {self.macro[0] / 1e9:.4g} GPa, nu {self.macro[1]:.3f}" if self.macro else "-"),
            *self._bodies,
            ("memory with --full", f"about {gigabytes(self.memory_full)} of {gigabytes(self.memory_machine)}"),
            ("longest fine contact", f"{self.longest_contact * 1e3:.4g} mm"),
            *((f"limit {name}", f"{limit * 1e3:.4g} mm") for name, limit in self.limits.items()),
            *self.field_rows,
            *([] if self.weight is None else [("weight, first", force(self.weight))]),
            *self._stages,
            *([("fissura ensemble", self.study)] if self.study else []),
        ]

    def __repr__(self) -> str:
        return "\n".join([*aligned(self.table()), *(f"warning: {notice}" for notice in self.warnings)])

    def _repr_html_(self) -> str:
        from fissura.pictures.html import notebook_html

        return notebook_html(self.table(), map(str, self.warnings), None)


def check(case: Case | Mapping[str, Any] | str | Path, *, build: bool | None = True) -> CheckReport:
    """Describe what a case would run, without solving anything, as ``fissura check`` does.

    Parameters
    ----------
    case : Case, mapping or path
        As of `fissura.run`.
    build : bool, optional
        Whether to place and count all bodies, as a run does, which also finds mistakes that show only then. None: they
        are counted unless kernels had to be compiled for it.

    Returns
    -------
    CheckReport
        Sizes, limits and warnings.

    Raises
    ------
    InputError
        If anything in the case is wrong, or the specimen does not fit into memory.

    Examples
    --------
    >>> found = fissura.check(case)
    >>> found.bodies_start <= found.bodies_full
    True
    """
    case = case_of(case)
    require_memory(case)

    if case.output.measured is not None:
        read_measured(case.output.measured)
    if build is None:
        build = seconds_to_compile() < _QUICK
    if build:
        return _built(case)

    found = described(case)
    return _described(case, found.domain, found.notices, round(estimate_bodies(case)), 0.0)


def _built(case: Case) -> CheckReport:
    """What a case would run, with its bodies."""
    simulation = Simulation(case)
    contacts = simulation.tessellation.contacts
    lengths = contacts.length[contacts.fine]
    found = _described(case, simulation.domain, simulation.notices, simulation.bodies_full, lengths.max(initial=0.0))
    return replace(
        found,
        bodies_start=simulation.bodies_start,
        estimated=simulation.bodies_full_estimated,
        nuclei_given=simulation.nuclei_given,
        contacts=len(contacts),
        fine_contacts=len(lengths),
        field_rows=_field_rows(case, simulation.field),
    )


def _described(
    case: Case, domain: Domain, notices: tuple[Notice, ...], bodies_full: int, longest: float
) -> CheckReport:
    """What there is to say of a case whose longest fine contact, as far as known, has this length [m]."""
    limits, machine = limits_from_case(case), physical_memory()
    # Saturated: no point is farther than l_f from a nucleus, so no two neighbours are more than 2 l_f apart. At a notch
    # that nucleus may lie across it, and the nearest one on the point's own side as far again.
    bound = (4.0 if case.notch else 2.0) * case.discretization.l_f if case.discretization.nuclei is None else 0.0
    longest, memory_full = max(bound, float(longest)), estimate_memory(bodies_full)
    warnings, gravity = list(notices), case.gravity
    if longest >= min(limits.values(), default=math.inf):
        problem = "a fine contact may be longer than the law allows: the run would stop there"
        warnings.append(Notice("discretization.l_f", problem, "a smaller l_f, or a larger material.G_t"))
    if memory_full > machine:
        problem = "full resolution does not fit into the memory of this machine"
        warnings.append(Notice("discretization.l_f", problem, "run adaptively, without --full"))
    return CheckReport(
        name=case.name,
        law=case.material.law,
        criterion=case.adaptivity.criterion,
        bodies_start=None,
        bodies_full=bodies_full,
        contacts=None,
        fine_contacts=None,
        memory_full=memory_full,
        memory_machine=machine,
        limits=limits,
        longest_contact=longest,
        weight=None if gravity is None else gravity.density * gravity.acceleration * domain.volume,
        stages=stages_in_words(case, case.material.G_t * domain.smallest_section),
        warnings=tuple(warnings),
        contact=(case.material.E, case.material.alpha),
        macro=_macro(case),
        study=study_in_words(case),
    )


def _field_rows(case: Case, field: RandomField | None) -> tuple[tuple[str, str], ...]:
    """What there is to say about the random field of a case."""
    part = case.field
    if part is None or field is None:
        return ()
    found = field.accuracy
    length = " x ".join(f"{1e3 * value:.4g}" for value in part.length)
    apart = f"{found.nodes} nodes {1e3 * min(found.spacing):.3g} mm apart"
    return (
        ("random field", f"{part.correlation}, {length} mm; {part.marginal}, CoV {part.cov:g}; seed {field.seed}"),
        ("expansion", f"{found.method}: {found.modes} modes, {apart}"),
        ("variance error", f"{found.mean:.2%} on average, {found.largest:.2%} at most; corrected at every point"),
    )


def _macro(case: Case) -> tuple[float, float] | None:
    """Elastic constants of the bulk that a case's contacts give; None where the table ends."""
    try:
        return macroscopic_elasticity().macroscopic(case.material.E, case.material.alpha)
    except InputError:
        return None
