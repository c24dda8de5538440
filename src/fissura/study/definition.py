"""What a study runs: specimens, seeds and variations of parameters, read from a TOML file."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Field, ValidationError, model_validator

from fissura.case import Case, case_from_dict
from fissura.case.load import read_case_file
from fissura.case.part import Part
from fissura.case.report import fail, input_error
from fissura.case.types import Count, Fraction
from fissura.errors import InputError
from fissura.files.tables import read_toml

FULL = "full"
"""Name of the run at full resolution, next to those of variations."""

MOST_RUNS = 100_000
"""Largest number of runs of a study: each has a file of its own, and all are compared in memory."""

#: Most cases of a study, all of which are validated before the first run.
_MOST_CASES = 10_000

#: Tables of a case that a variation may change; full resolution depends on nothing in them but the fixed keys.
_VARIED = ("adaptivity", "discretization", "solver")
_FIXED = tuple(("discretization", key) for key in ("l_f", "nuclei", "placement"))

_NAME = 'up to 60 characters: letters, digits and any of "_ + - . = , %" and blanks'


def _some(seeds: tuple[int, ...]) -> tuple[int, ...]:
    if not seeds:
        fail("the list is empty", "at least one seed")
    return seeds


Names = tuple[str, ...]
Seeds = Annotated[tuple[Count, ...], AfterValidator(_some)]


class Limits(Part):
    """Errors below which a run counts as right, as fractions; 0.01 is 1 per cent."""

    load: Fraction = 0.01
    peak: Fraction = 0.01
    energy: Fraction = 0.01


class SpecimenEntry(Part):
    """A specimen: a case file, and what is different from it."""

    name: str = Field(description="the name of the specimen")
    case: str = Field(description="the path of a case file, relative to the study")
    type: str = Field(default="", description="the kind of specimen, by which results are gathered")
    change: dict[str, Any] = Field(default_factory=dict)
    seeds: Seeds | None = Field(default=None, description="a list of whole numbers, 0 or larger")
    limits: Limits = Limits()


class Variation(Part):
    """A choice of the parameters of adaptivity, with which every specimen is run."""

    name: str = Field(description="the name of the variation")
    change: dict[str, Any] = Field(default_factory=dict)
    seeds: Seeds | None = Field(default=None, description="a list of whole numbers, 0 or larger")
    specimens: Names | None = Field(default=None, description="a list of names of specimens")


class Study(Part):
    """A whole study.

    Attributes
    ----------
    name : str
        Title of its tables.
    seeds : tuple of int
        Seeds of every specimen that has none of its own.
    specimens : tuple of SpecimenEntry
    variations : tuple of Variation
        A variation is run with the seeds of a specimen that are among its own, if it has any.
    """

    name: str = "study"
    seeds: Seeds = Field(default=(1,), description="a list of whole numbers, 0 or larger")
    specimens: tuple[SpecimenEntry, ...] = Field(description="at least one table [[specimens]] with name and case")
    variations: tuple[Variation, ...] = (Variation(name="default"),)

    @model_validator(mode="after")
    def _names(self) -> Self:
        for key, names in (
            ("specimens", [entry.name for entry in self.specimens]),
            ("variations", [entry.name for entry in self.variations]),
        ):
            if not names:
                fail("the list is empty", f"at least one table [[{key}]]", key)
            seen: dict[str, str] = {}  # names by the files they would have
            for k, name in enumerate(names):
                if not re.fullmatch(r"\w[\w +\-.=,%]{0,59}", name) or name.endswith((" ", ".")):
                    fail(f"{name!r} cannot name a file", _NAME, (key, k, "name"))
                # Records of runs are files: names that differ in blanks or capitals only may name the same file.
                earlier = seen.get(_file_name(name))
                seen[_file_name(name)] = name
                if earlier is not None:
                    problem = f"{name!r} is the name of two" if earlier == name else f"{name!r} is too near {earlier!r}"
                    fail(problem, "a name of its own for each", (key, k, "name"))
                if _file_name(name) == FULL:
                    fail(f"{name!r} is the name of the run at full resolution", "another name", (key, k, "name"))
        specimens = dict.fromkeys(entry.name for entry in self.specimens)
        for k, variation in enumerate(self.variations):
            for name in variation.specimens or ():
                if name not in specimens:
                    fail(f"{name!r} is not known", ", ".join(specimens), ("variations", k, "specimens"))
            for table, value in variation.change.items():
                if table not in _VARIED or not isinstance(value, Mapping):
                    fail("changes the specimen", f"keys of {', '.join(_VARIED)}", ("variations", k, "change", table))
            for table, key in _FIXED:
                if key in variation.change.get(table, {}):
                    problem = "changes the run at full resolution, too"
                    fail(problem, "another specimen with this change", ("variations", k, "change", table, key))
        return self


@dataclass(frozen=True)
class Task:
    """One run of a study.

    Attributes
    ----------
    specimen, variation : str
        Names; the variation of the run at full resolution is `FULL`.
    seed : int
    case : Case
        What to run.
    """

    specimen: str
    seed: int
    variation: str
    case: Case

    @property
    def full(self) -> bool:
        """Whether it is the run at full resolution."""
        return self.variation == FULL

    @property
    def path(self) -> Path:
        """Where its record lies in the folder of the study."""
        return Path("runs") / self.specimen / f"seed{self.seed:04d}" / f"{self.variation.replace(' ', '_')}.npz"

    def __str__(self) -> str:
        return f"{self.specimen}, seed {self.seed}, {self.variation}"


@dataclass(frozen=True)
class LoadedStudy:
    """A study with the cases it means.

    Attributes
    ----------
    study : Study
    cases : dict of (str, str) to Case
        Cases by names of specimen and variation, seeds not yet put in.
    """

    study: Study
    cases: dict[tuple[str, str], Case]

    def tasks(self) -> Iterator[Task]:
        """All runs, seed by seed; full resolution comes before the runs that are compared with it."""
        of = [(entry.name, *_seeds(self.study, entry)) for entry in self.study.specimens]
        for seed in dict.fromkeys(seed for _, own, _ in of for seed in own):
            for specimen, own, seeds in of:
                names = [name for name, some in seeds.items() if seed in some] if seed in own else []
                for name in [FULL, *names] if names else []:
                    case = self.cases[specimen, name].model_copy(update={"seed": seed})
                    yield Task(specimen, seed, name, case)


def _file_name(name: str) -> str:
    """What tells files of runs apart where capitals do not."""
    return name.replace(" ", "_").casefold()


def _seeds(study: Study, entry: SpecimenEntry) -> tuple[dict[int, None], dict[str, dict[int, None]]]:
    """Seeds of a specimen in order, and those among them with which each variation is run."""
    own = dict.fromkeys(entry.seeds or study.seeds)
    applied = [v for v in study.variations if v.specimens is None or entry.name in v.specimens]
    return own, {v.name: own if v.seeds is None else {s: None for s in v.seeds if s in own} for v in applied}


def _check_size(study: Study) -> None:
    """Refuse more runs than can be kept and compared, before anything is made of them.

    Raises
    ------
    InputError
        There are too many; the key is that of the most seeds, or of the variations.
    """
    cases = len(study.specimens) * (1 + len(study.variations))
    if cases > _MOST_CASES:
        problem = f"{len(study.variations)} variations of {len(study.specimens)} specimens are {cases} cases"
        raise InputError("variations", problem, f"at most {_MOST_CASES} cases, full resolution counted")
    runs = 0
    for k, entry in enumerate(study.specimens):
        own, seeds = _seeds(study, entry)
        runs += len(set().union(*seeds.values())) + sum(map(len, seeds.values()))
        if runs > MOST_RUNS:
            key = "seeds" if entry.seeds is None else f"specimens[{k}].seeds"
            what = f"{len(study.specimens)} specimens, {len(own)} seeds and {len(study.variations)} variations"
            raise InputError(key, f"{what} make too many runs", f"at most {MOST_RUNS} runs, full resolution counted")


def load_study(path: str | Path) -> LoadedStudy:
    """Read and validate a study file, and all cases in it.

    Parameters
    ----------
    path : path
        TOML file, UTF-8; case files are relative to its folder.

    Raises
    ------
    InputError
        The file or a case file cannot be read, or anything in them is wrong.
    """
    path = Path(path)
    return study_from_dict(read_toml(path, "a study file (TOML, UTF-8)")[1], path.parent)


def study_from_dict(data: Mapping[str, Any], folder: str | Path = ".") -> LoadedStudy:
    """Validate a study given as nested dictionaries; see `load_study`."""
    try:
        study = Study.model_validate(dict(data))
    except ValidationError as error:
        raise input_error(error, Study, data) from None
    _check_size(study)
    cases = {}
    for k, entry in enumerate(study.specimens):
        path = Path(folder) / entry.case
        base = merged(_case_file(path, f"specimens[{k}].case"), entry.change)
        base = merged({**base, "name": entry.name}, {"output": {"vtk": 0}})
        for name, change, key in [
            (FULL, {}, f"specimens[{k}]"),
            *((v.name, v.change, f"variations[{j}] on specimens[{k}]") for j, v in enumerate(study.variations)),
        ]:
            try:
                cases[entry.name, name] = case_from_dict(merged(base, change), path.parent)
            except InputError as error:
                where = f"{key} ({entry.name}{'' if name == FULL else ', ' + name}): {error.key}"
                raise InputError(where, error.problem, error.allowed) from None
    return LoadedStudy(study, cases)


def merged(base: Mapping[str, Any], change: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of a case with some keys changed; a table is changed key by key, everything else is replaced."""
    new = dict(base)
    for key, value in change.items():
        old = new.get(key)
        new[key] = merged(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
    return new


def _case_file(path: Path, key: str) -> dict[str, Any]:
    """Tables of a case file."""
    try:
        return read_case_file(path)[1]
    except InputError as error:
        raise InputError(key, f"{path}: {error.problem}", error.allowed) from None
