"""A calibration from what a user asks for: a file of tests and unknowns, or a case with measured curves."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationError

from fissura.calibration.problem import Problem, Test, Unknown, dimension_of, number_of
from fissura.case import Case, case_of, load_case
from fissura.case.changed import value_at
from fissura.case.load import read_case_file
from fissura.case.part import Part
from fissura.case.report import fail, input_error
from fissura.case.stages import Quantity
from fissura.case.types import Repeats, Target
from fissura.case.units import NUMBER, show, to_si
from fissura.errors import InputError
from fissura.files.folder import folder_name
from fissura.results.measured import read_measured

DEFAULT_UNKNOWNS = ("material.f_t", "material.G_t")

#: Bounds of a positive unknown over its start, where they are not given: the widest of these that is allowed.
_WIDE = (4.0, 3.0, 2.0, 1.5, 1.2)

#: Specimens behind a curve, and behind a band, where it is not said.
_OF_CURVE, _OF_BAND = 1, 2

#: Most tests, curves and unknowns.
_MOST = 50
_MOST_UNKNOWNS = 12


def _texts(value: Any) -> Any:
    return (value,) if isinstance(value, str | Path) else value


def _weight(value: Any) -> float:
    try:
        number = to_si(value, NUMBER)
    except ValueError as error:
        fail(str(error), "a positive number")
    if not 0.0 < number <= 1e6:
        fail(f"{show(value)} is not possible", "a positive number, 1e6 at most")
    return number


Texts = Annotated[tuple[str | Path, ...], BeforeValidator(_texts)]


class UnknownEntry(Part):
    """Start and bounds of an unknown; those that are missing follow from the case."""

    start: Any = None
    lower: Any = None
    upper: Any = None


class TestEntry(Part):
    """A test: a case, and files with its measured curves."""

    __test__ = False

    case: Any = Field(description="the path of a case file")
    measured: Texts = Field(description="the path of a CSV file, or a list of them, one for each specimen")
    name: str | None = None
    weight: Annotated[float, BeforeValidator(_weight)] = 1.0
    specimens: Repeats | None = None
    over: Quantity | None = None
    units: Texts = ()
    columns: Texts = ()
    until: Target | None = None


class Request(Part):
    """What a calibration asks for.

    Attributes
    ----------
    name : str
        Names the folder of results.
    unknowns : dict of str to UnknownEntry
        By key of the cases.
    fixed : dict of str to value
        Values by key that all cases get before.
    test : tuple of TestEntry
    seeds, runs : int
        Random structures of a full round, and runs at most.
    seed : int
        From which those of the structures are spawned.
    """

    name: str = "calibration"
    unknowns: dict[str, UnknownEntry | None] = Field(default=dict.fromkeys(DEFAULT_UNKNOWNS))
    fixed: dict[str, Any] = Field(default={})
    test: tuple[TestEntry, ...] = Field(description="at least one table [[test]] with case and measured")
    seeds: Repeats = 6
    runs: Repeats | None = None
    seed: int = Field(default=1, ge=0)


def is_request(path: Path) -> bool:
    """Whether a file is one of tests and unknowns, and no case."""
    return path.suffix.lower() == ".toml" and "test" in read_case_file(path)[1]


def read_request(path: str | Path) -> tuple[Request, Path]:
    """Read a file of tests and unknowns; paths in it are relative to its folder, which comes along.

    Raises
    ------
    InputError
        The file cannot be read, or anything in it is wrong.
    """
    path = Path(path)
    tables = read_case_file(path)[1]
    tables.setdefault("name", folder_name(path.stem))
    return request_of(tables), path.parent


def request_of(tables: Mapping[str, Any]) -> Request:
    """Validate a request given as nested dictionaries; keys of unknowns may be nested tables, too."""
    data = dict(tables)
    for name in ("unknowns", "fixed"):
        if isinstance(data.get(name), Mapping):
            data[name] = dict(_flat(data[name], ends=("start", "lower", "upper") if name == "unknowns" else ()))
    try:
        return Request.model_validate(data)
    except ValidationError as error:
        raise input_error(error, Request, data) from None


def _flat(table: Mapping[str, Any], ends: Sequence[str], outer: str = "") -> Iterable[tuple[str, Any]]:
    """Dotted keys of nested tables; a table with one of some names, or without tables, is a value of unknowns."""
    for name, value in table.items():
        key = f"{outer}{name}"
        if isinstance(value, Mapping) and value and not set(value) & set(ends):
            yield from _flat(value, ends, f"{key}.")
        else:
            yield key, value


def problem_of(request: Request, folder: Path = Path()) -> Problem:
    """The calibration that is asked for, with its cases and measured curves.

    Parameters
    ----------
    request : Request
    folder : Path, optional
        To which its paths are relative.

    Raises
    ------
    InputError
        A case, a curve, a key or a bound is wrong; the message names it.
    """
    if not request.test:
        raise InputError("test", "there is none", "at least one table [[test]] with case and measured")
    if len(request.test) > _MOST or not 1 <= len(request.unknowns) <= _MOST_UNKNOWNS:
        problem = f"{len(request.test)} tests and {len(request.unknowns)} unknowns are given"
        raise InputError("unknowns", problem, f"1 to {_MOST} tests and 1 to {_MOST_UNKNOWNS} unknowns")
    if request.seeds < 2:
        raise InputError("seeds", f"{request.seeds} says nothing about scatter", "at least 2")
    tests = tuple(_test(entry, request, folder, k) for k, entry in enumerate(request.test))
    names = [test.name for test in tests]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError("test", f"two are called {twice!r}", "a name for each")
    first = tests[0].case
    unknowns = tuple(_unknown(first, key, entry or UnknownEntry()) for key, entry in request.unknowns.items())
    for test in tests[1:]:
        for unknown in unknowns:
            number_of(test.case, unknown.key, unknown.start, f"test {test.name}, unknown")
    return Problem(request.name, unknowns, tests)


def _test(entry: TestEntry, request: Request, folder: Path, number: int) -> Test:
    key = f"test[{number}]"
    case = _case(entry.case, folder, f"{key}.case")
    if request.fixed:
        try:
            case = case.with_(request.fixed)
        except InputError as error:
            raise InputError(f"fixed {error.key}", error.problem, error.allowed) from None
    if not entry.measured:
        raise InputError(f"{key}.measured", "the list is empty", "the path of a CSV file, or a list of them")
    bands = tuple(
        read_measured(
            folder / path,
            units=tuple(map(str, entry.units)),
            columns=tuple(map(str, entry.columns)),
            key=f"{key}.measured",
            plain=False,
        )
        for path in entry.measured
    )
    if len(bands) > 1 and not all(band.is_curve for band in bands):
        raise InputError(f"{key}.measured", "a band is among several files", "one band, or one curve for each specimen")
    if len(bands) > 1 and entry.specimens not in (None, len(bands)):
        problem = f"{entry.specimens} specimens, and {len(bands)} curves"
        raise InputError(f"{key}.specimens", problem, "as many, or none given; of a mean curve, one file")
    of_one = _OF_CURVE if bands[0].is_curve else _OF_BAND
    specimens = len(bands) if len(bands) > 1 else entry.specimens or of_one
    over = entry.over or ("displacement" if case.main.gauge is None else "gauge")
    name = folder_name(entry.name or case.name)
    return Test(name, case, bands, entry.weight, specimens, over, math.inf if entry.until is None else entry.until)


def _case(given: Any, folder: Path, key: str) -> Case:
    if isinstance(given, Case | Mapping):
        return case_of(given)
    if not isinstance(given, str | Path):
        raise InputError(key, f"{show(given)} is not a path", "the path of a case file")
    return load_case(folder / given)


def _unknown(case: Case, key: str, entry: UnknownEntry) -> Unknown:
    where = "unknown"
    start = _start(case, key) if entry.start is None else number_of(case, key, entry.start, where)
    if start is None:
        raise InputError(f"{where} {key}", "has no number in the case to start from", "start = ...")
    lower = None if entry.lower is None else number_of(case, key, entry.lower, where)
    upper = None if entry.upper is None else number_of(case, key, entry.upper, where)
    if (lower is None or upper is None) and not start > 0.0:
        raise InputError(f"{where} {key}", f"starts at {start:g} and has no bounds", "lower and upper")
    lower = _bound(case, key, start, -1) if lower is None else lower
    upper = _bound(case, key, start, 1) if upper is None else upper
    found = Unknown(key, start, lower, upper, dimension_of(case, key, start))
    if not lower < upper:
        problem = f"lower = {found.told(lower)} is not below upper = {found.told(upper)}"
        raise InputError(f"{where} {key}", problem, "lower below upper")
    if not lower <= start <= upper:
        problem = f"start = {found.told(start)} is outside of {found.told(lower)} to {found.told(upper)}"
        raise InputError(f"{where} {key}", problem, "a start between the bounds")
    return found


def _start(case: Case, key: str) -> float | None:
    """The number that a key has in the case."""
    try:
        value = value_at(case, key)
    except InputError as error:
        raise InputError(f"unknown {key}", error.problem, error.allowed) from None
    if isinstance(value, tuple) and len(value) == 1:
        (value,) = value
    if isinstance(value, bool) or not isinstance(value, int | float):
        number_of(case, key, 1.0, "unknown")  # tells a key that is not known
        return None
    return number_of(case, key, value, "unknown")


def _bound(case: Case, key: str, start: float, side: int) -> float:
    """A bound that is not given: as wide as the key allows."""
    for factor in _WIDE:
        value = start * factor**side
        try:
            number_of(case, key, value, "unknown")
        except InputError:
            continue
        return value
    return start


_RANGE = re.compile(r"\s*\.\.\.?\s*")


def unknown_option(text: str) -> tuple[str, dict[str, Any]]:
    """Key, and start and bounds of an unknown from a text: ``KEY``, ``KEY=LOWER..UPPER``, ``KEY=LOWER..START..UPPER``.

    Raises
    ------
    InputError
        The text is something else.

    Examples
    --------
    >>> unknown_option("material.f_t=1 MPa..6 MPa")
    ('material.f_t', {'lower': '1 MPa', 'upper': '6 MPa'})
    """
    key, sign, values = (part.strip() for part in text.partition("="))
    parts = [_plain(part) for part in _RANGE.split(values)] if sign else []
    names = {0: (), 2: ("lower", "upper"), 3: ("lower", "start", "upper")}.get(len(parts))
    if not key or names is None or "" in parts:
        allowed = '"KEY", "KEY=LOWER..UPPER" or "KEY=LOWER..START..UPPER", such as "material.f_t=1 MPa..6 MPa"'
        raise InputError("--unknown", f"{text!r} is no key with bounds", allowed)
    return key, dict(zip(names, parts, strict=True))


def _plain(text: str) -> Any:
    """A number where a text is one."""
    try:
        return float(text)
    except ValueError:
        return text
