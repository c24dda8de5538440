"""What an ensemble consists of: realisations, their seeds and cases. Nothing here depends on who computes them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from fissura.case import Case
from fissura.case.types import whole
from fissura.case.units import show
from fissura.errors import InputError

__all__ = [
    "LEADING_MODES",
    "MOST_RUNS",
    "Companions",
    "Key",
    "Kind",
    "Mode",
    "Plan",
    "Sampling",
    "Task",
    "spawned",
    "whole_number",
]

FloatArray = NDArray[np.float64]

Mode = Literal["geometry", "field", "both"]
"""What is random: the nuclei, the field of material, or both."""

Sampling = Literal["monte-carlo", "latin-hypercube"]
Companions = Literal["one", "each", "none"]
Kind = Literal["run", "companion"]
Key = tuple[Kind, int]
"""What tells runs of an ensemble apart: kind and number."""

MOST_RUNS = 100_000
"""Largest number of realisations: each has a folder of its own, and the tables are in memory as a whole."""

#: Largest number of values in a Latin hypercube, which is in memory as a whole.
_MOST_STRATA = 10_000_000

LEADING_MODES = 10
"""Modes of the field that Latin hypercube sampling stratifies unless told otherwise."""

NUCLEI, FIELD, STRATA, RESAMPLING = 0, 1, 2, 3
"""Purposes of random numbers, the second part of their spawn key."""

SEED_BITS = 49
"""Seeds are below 2**49, so that spreadsheets and JSON readers keep every digit of them."""


def spawned(master: int, number: int, purpose: int) -> np.random.SeedSequence:
    """Independent stream of random numbers of an ensemble.

    Parameters
    ----------
    master : int
        The one seed of the ensemble.
    number : int
        Number of the realisation, from 1; 0 for what belongs to all.
    purpose : int
        `NUCLEI`, `FIELD`, `STRATA` or `RESAMPLING`.

    Returns
    -------
    SeedSequence
        With the spawn key ``(number, purpose)``: it depends on nothing else, so that realisation 7 is the same in an
        ensemble of 10 and of 1000.
    """
    return np.random.SeedSequence(master, spawn_key=(number, purpose))


@dataclass(frozen=True)
class Task:
    """One run to be computed.

    Attributes
    ----------
    number : int
        Of the realisation, from 1; 0 for the companion of them all.
    kind : {"run", "companion"}
        Whether it belongs to the ensemble or is computed for comparison.
    case : Case
        What to compute.
    full, keep : bool
        Full resolution; all the files of a run.
    """

    number: int
    kind: Kind
    case: Case
    full: bool = False
    keep: bool = False

    @property
    def key(self) -> Key:
        """What tells tasks of an ensemble apart."""
        return self.kind, self.number


@dataclass(frozen=True)
class Plan:
    """An ensemble as a pure function of its arguments.

    Parameters
    ----------
    case : Case
        The case; its seed is that of the nuclei where these do not vary.
    runs : int
        Number of realisations.
    mode : {"geometry", "field", "both"}
        What varies. In mode ``"geometry"`` there is no random field.
    sampling : {"monte-carlo", "latin-hypercube"}
        How the field is sampled.
    master : int
        Seed of the ensemble.
    full : bool
        Full resolution.
    companions : {"one", "each", "none"}
        Deterministic runs for comparison, without a field: of the nuclei of the case, of those of every realisation,
        or none.
    leading_modes : int
        Modes of the field that Latin hypercube sampling stratifies.
    keep : bool
        Keep all the files of a run.

    Raises
    ------
    InputError
        The arguments do not fit together, or ask for a random field in a case without one.
    """

    case: Case
    runs: int
    mode: Mode = "geometry"
    sampling: Sampling = "monte-carlo"
    master: int = 1
    full: bool = False
    companions: Companions = "one"
    leading_modes: int = LEADING_MODES
    keep: bool = False

    def __post_init__(self) -> None:
        for option, name, least in (
            ("--runs", "runs", 1),
            ("--seed", "master", 0),
            ("--leading-modes", "leading_modes", 1),
        ):
            object.__setattr__(self, name, whole_number(option, getattr(self, name), least))
        if self.runs > MOST_RUNS:
            raise InputError(
                "--runs",
                f"{self.runs} realisations are too many for one folder",
                f"1 to {MOST_RUNS}; for more, several ensembles with different --seed",
            )
        for option, value, names in (
            ("--mode", self.mode, Mode),
            ("--sampling", self.sampling, Sampling),
            ("--companions", self.companions, Companions),
        ):
            if value not in get_args(names):
                raise InputError(option, f"{value!r} is not known", ", ".join(get_args(names)))
        if self.mode != "geometry" and self.case.field is None:
            raise InputError(
                "--mode", f"{self.mode!r} needs a random field, and {self.case.name} has no [field]", "geometry"
            )
        if self.mode != "field" and self.case.discretization.nuclei is not None:
            raise InputError("--mode", f"{self.mode!r} places nuclei, but discretization.nuclei gives them", "field")
        if self.sampling == "latin-hypercube" and self.mode == "geometry":
            raise InputError(
                "--sampling", "Latin hypercubes sample the field, and --mode geometry has none", "monte-carlo"
            )
        if self.sampling == "latin-hypercube" and self.runs * self.leading_modes > _MOST_STRATA:
            raise InputError(
                "--leading-modes",
                f"{self.leading_modes} modes of {self.runs} realisations are too many values to stratify",
                f"1 to {_MOST_STRATA // self.runs}",
            )
        if self.companions == "each" and self.mode == "geometry":
            raise InputError("--companions", "'each' run of --mode geometry is deterministic itself", "one, none")

    def seeds(self, number: int) -> tuple[int, int | None]:
        """Seed of the nuclei and seed of the field of a realisation; None without a field."""
        nuclei = self.case.seed if self.mode == "field" else _seed(spawned(self.master, number, NUCLEI))
        return nuclei, None if self.mode == "geometry" else _seed(spawned(self.master, number, FIELD))

    @cached_property
    def leading(self) -> FloatArray:
        """Standard Gaussian values given to the leading modes of the field, shape (runs, leading_modes).

        Latin hypercube: each column has one value in each of ``runs`` intervals of equal probability, the columns
        paired at random (McKay, Beckman, Conover 1979). Empty, shape (runs, 0), for Monte Carlo.
        """
        if self.sampling == "monte-carlo":
            return np.empty((self.runs, 0))
        from scipy.special import ndtri
        from scipy.stats.qmc import LatinHypercube

        rng = np.random.default_rng(spawned(self.master, 0, STRATA))
        return np.asarray(ndtri(LatinHypercube(self.leading_modes, rng=rng).random(self.runs)))

    def run(self, number: int) -> Task:
        """The realisation of a number, from 1 on."""
        nuclei, seed = self.seeds(number)
        changes: dict[str, Any] = {"seed": nuclei}
        if seed is None:
            changes["field"] = None
        else:
            assert self.case.field is not None
            changes["field"] = self.case.field.model_copy(update={"seed": seed, **self._strata(number)})
        return self._task(number, "run", changes)

    def companion(self, number: int) -> Task:
        """The deterministic run with the nuclei of a realisation; with those of the case for number 0."""
        seed = self.case.seed if number == 0 else self.seeds(number)[0]
        return self._task(number, "companion", {"seed": seed, "field": None})

    def keys(self) -> Iterator[Key]:
        """What the ensemble consists of, in order, each run after its companion; takes no time, unlike `tasks`."""
        if self.companions == "one" or (self.companions == "each" and self.mode == "field"):
            yield "companion", 0
        for number in range(1, self.runs + 1):
            if self.companions == "each" and self.mode == "both":
                yield "companion", number
            yield "run", number

    def task(self, key: Key) -> Task:
        """The run or companion of a number."""
        kind, number = key
        return self.run(number) if kind == "run" else self.companion(number)

    def tasks(self) -> Iterator[Task]:
        """All runs of the ensemble in order, each after its companion; made one by one, as they are asked for."""
        return map(self.task, self.keys())

    def _strata(self, number: int) -> dict[str, Any]:
        return {"leading": tuple(self.leading[number - 1].tolist())} if self.sampling == "latin-hypercube" else {}

    def _task(self, number: int, kind: Kind, changes: dict[str, Any]) -> Task:
        output = self.case.output.model_copy(update={"measured": None} if self.keep else {"measured": None, "vtk": 0})
        return Task(number, kind, self.case.model_copy(update={**changes, "output": output}), self.full, self.keep)


def _seed(sequence: np.random.SeedSequence) -> int:
    return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(64 - SEED_BITS))


def whole_number(option: str, value: int, least: int) -> int:
    """A whole number of Python or NumPy, as one of Python.

    Raises
    ------
    InputError
        It is something else, smaller than ``least``, or too large.
    """
    number = whole(value)
    if number is None or not least <= number < 2**63:
        raise InputError(option, f"{show(value)} is not possible", f"a whole number, {least} or larger")
    return number
