"""What an ensemble consists of: realisations, their seeds and cases. Nothing here depends on who computes them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, get_args

import numpy as np
from scipy.special import ndtri

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.case.ensemble import COMBINE, Combine, Varied
from fissura.case.points import Point, points_of
from fissura.case.types import whole
from fissura.case.units import show
from fissura.ensemble.seeds import FIELD, NUCLEI, STRATA, seed_of, spawned
from fissura.ensemble.task import Companions, Key, Kind, Mode, Sampling, Task
from fissura.errors import InputError

MOST_RUNS = 100_000
"""Largest number of realisations: each has a folder of its own, and the tables are in memory as a whole."""

#: Largest number of values in a Latin hypercube, which is in memory as a whole.
_MOST_STRATA = 10_000_000

LEADING_MODES = 10
"""Modes of the field that Latin hypercube sampling stratifies unless told otherwise."""


@dataclass(frozen=True)
class Plan:
    """An ensemble as a pure function of its arguments.

    Parameters
    ----------
    case : Case
        The case; its seed is that of the nuclei where these do not vary.
    runs : int
        Number of realisations, of each point where keys are varied.
    mode : {"geometry", "field", "both"}
        What is random. In mode ``"geometry"`` there is no random field.
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
    vary : dict of str to tuple
        Values by dotted key of the case: a parameter study, with the same seeds at each of its points.
    combine : {"grid", "together"}
        How values of several keys make points, see `fissura.case.points.points_of`.
    chosen : tuple of int
        Seeds of the realisations, instead of those spawned from `master`.

    Raises
    ------
    InputError
        The arguments do not fit together, or ask for a random field in a case without one.

    Examples
    --------
    >>> plan = Plan(case, 3, master=7)
    >>> plan.run(1).case.seed == plan.seeds(1)[0]
    True
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
    vary: Varied = field(default_factory=dict)
    combine: Combine = "grid"
    chosen: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        for option, name, least in (
            ("--runs", "runs", 1),
            ("--seed", "master", 0),
            ("--leading-modes", "leading_modes", 1),
        ):
            object.__setattr__(self, name, whole_number(option, getattr(self, name), least))
        object.__setattr__(self, "chosen", tuple(whole_number("seeds", seed, 0) for seed in self.chosen))
        for option, value, names in (
            ("--mode", self.mode, Mode),
            ("--sampling", self.sampling, Sampling),
            ("--companions", self.companions, Companions),
            ("combine", self.combine, Combine),
        ):
            if value not in get_args(names):
                allowed = COMBINE if option == "combine" else ", ".join(get_args(names))
                raise InputError(option, f"{value!r} is not known", allowed)
        self._check_number()
        for point in self.points:
            self._check_case(point.case)
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

    def _check_number(self) -> None:
        """Refuse more runs than a folder holds, and seeds that are not as many as there are runs."""
        total = self.runs * len(self.points)
        if total > MOST_RUNS:
            of = f" at {len(self.points)} points" if len(self.points) > 1 else ""
            raise InputError(
                "--runs",
                f"{self.runs} realisations{of} are too many for one folder",
                f"1 to {MOST_RUNS // len(self.points)}; for more, several ensembles with different --seed",
            )
        if self.chosen and len(self.chosen) != self.runs:
            raise InputError("--runs", f"{self.runs} is not the number of the seeds", f"{len(self.chosen)}")
        if len(set(self.chosen)) < len(self.chosen):
            raise InputError("seeds", "one of them is there twice", "different whole numbers")

    def _check_case(self, case: Case) -> None:
        """Refuse a case in which what is to be random is not."""
        if self.mode != "geometry" and case.field is None:
            raise InputError(
                "--mode", f"{self.mode!r} needs a random field, and {self.case.name} has no [field]", "geometry"
            )
        if self.mode != "field" and case.discretization.nuclei is not None:
            raise InputError("--mode", f"{self.mode!r} places nuclei, but discretization.nuclei gives them", "field")
        if self.mode == "geometry" and any(key.partition(".")[0] == "field" for key in self.vary):
            raise InputError("--mode", "'geometry' has no random field, and keys of it are varied", "field, both")

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The points of the parameter study; one, without values, where nothing is varied."""
        return points_of(self.case, self.vary, self.combine)

    def at(self, point: int) -> Plan:
        """The plan of one point alone; numbers of its runs are different ones.

        Parameters
        ----------
        point : int
            Its number, from 0.

        Returns
        -------
        Plan
            One without varied keys.

        Examples
        --------
        >>> Plan(case, 2, vary={"material.f_t": ("2 MPa", "3 MPa")}).at(1).case.material.f_t
        3000000.0
        """
        return replace(self, case=self.points[point].case, vary={}, combine="grid")

    def seeds(self, number: int) -> tuple[int, int | None]:
        """Seed of the nuclei and seed of the field of a realisation.

        Parameters
        ----------
        number : int
            Of the realisation, from 1 on.

        Returns
        -------
        tuple of int, and of int or None
            None without a field.

        Examples
        --------
        >>> Plan(case, 2, chosen=(11, 12)).seeds(2)
        (12, None)
        """
        if self.chosen:
            seed = of_field = self.chosen[number - 1]
            if self.case.field is not None and self.case.field.seed is not None and seed == self.case.seed:
                of_field = self.case.field.seed  # the case as it is
            return (self.case.seed if self.mode == "field" else seed), (None if self.mode == "geometry" else of_field)
        nuclei = self.case.seed if self.mode == "field" else seed_of(spawned(self.master, number, NUCLEI))
        return nuclei, None if self.mode == "geometry" else seed_of(spawned(self.master, number, FIELD))

    @cached_property
    def leading(self) -> FloatArray:
        """Standard Gaussian values given to the leading modes of the field, shape (runs, leading_modes).

        Latin hypercube: each column has one value in each of ``runs`` intervals of equal probability, the columns
        paired at random (McKay, Beckman, Conover 1979). Empty, shape (runs, 0), for Monte Carlo.
        """
        if self.sampling == "monte-carlo":
            return np.empty((self.runs, 0))
        from scipy.stats.qmc import LatinHypercube  # takes long to import

        rng = np.random.default_rng(spawned(self.master, 0, STRATA))
        return np.asarray(ndtri(LatinHypercube(self.leading_modes, rng=rng).random(self.runs)))

    def run(self, number: int) -> Task:
        """The run of a number: first all points of the first realisation, then of the second, and so on.

        Parameters
        ----------
        number : int
            Of the run, from 1 on.

        Returns
        -------
        Task
            What is to be computed.

        Examples
        --------
        >>> Plan(case, 2, chosen=(11, 12)).run(2).case.seed
        12
        """
        before, point = divmod(number - 1, len(self.points))
        realisation, case = before + 1, self.points[point].case
        nuclei, seed = self.seeds(realisation)
        changes: dict[str, Any] = {"seed": nuclei}
        if seed is None:
            changes["field"] = None
        else:
            assert case.field is not None
            changes["field"] = case.field.model_copy(update={"seed": seed, **self._strata(realisation)})
        return self._task(number, "run", realisation, point, changes)

    def companion(self, number: int) -> Task:
        """The deterministic run with the nuclei of a realisation; with those of the case for realisation 0.

        Parameters
        ----------
        number : int
            Of the companion, from 0 on.

        Returns
        -------
        Task
            What is to be computed.

        Examples
        --------
        >>> Plan(case, 2).companion(0).case.seed == case.seed
        True
        """
        realisation, point = divmod(number, len(self.points))
        seed = self.case.seed if realisation == 0 else self.seeds(realisation)[0]
        return self._task(number, "companion", realisation, point, {"seed": seed, "field": None})

    def keys(self) -> Iterator[Key]:
        """What the ensemble consists of, in order, each run after its companion; takes no time, unlike `tasks`.

        Yields
        ------
        tuple of str and int
            Kind and number.

        Examples
        --------
        >>> list(Plan(case, 2).keys())
        [('companion', 0), ('run', 1), ('run', 2)]
        """
        count = len(self.points)
        if self.companions == "one" or (self.companions == "each" and self.mode == "field"):
            yield from (("companion", number) for number in range(count))
        for realisation in range(1, self.runs + 1):
            for point in range(count):
                if self.companions == "each" and self.mode == "both":
                    yield "companion", realisation * count + point
                yield "run", (realisation - 1) * count + point + 1

    def task(self, key: Key) -> Task:
        """The run or companion of a key.

        Parameters
        ----------
        key : tuple of str and int
            Kind and number, as `keys` gives them.

        Returns
        -------
        Task
            What is to be computed.

        Examples
        --------
        >>> Plan(case, 2).task(("run", 2)).number
        2
        """
        kind, number = key
        return self.run(number) if kind == "run" else self.companion(number)

    def tasks(self) -> Iterator[Task]:
        """All runs of the ensemble in order, each after its companion; made one by one, as they are asked for.

        Returns
        -------
        iterator of Task
            What is to be computed.

        Examples
        --------
        >>> len(list(Plan(case, 2).tasks()))
        3
        """
        return map(self.task, self.keys())

    def _strata(self, number: int) -> dict[str, Any]:
        return {"leading": tuple(self.leading[number - 1].tolist())} if self.sampling == "latin-hypercube" else {}

    def _task(self, number: int, kind: Kind, realisation: int, point: int, changes: dict[str, Any]) -> Task:
        at = self.points[point]
        output = at.case.output.model_copy(update={"measured": None} if self.keep else {"measured": None, "vtk": 0})
        case = at.case.model_copy(update={**changes, "output": output})
        return Task(number, kind, case, self.full, self.keep, realisation, point, at.values)


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
