"""Types of the fields of a case: quantities, directions, files."""

from __future__ import annotations

import math
from collections.abc import Callable
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

from pydantic import BeforeValidator, ValidationInfo
from pydantic_core import PydanticCustomError

from fissura.bulk import bulk_law
from fissura.case.units import ENERGY_PER_AREA, LENGTH, NUMBER, STRESS, Dimension, show, to_si

__all__ = [
    "Axis",
    "Count",
    "Direction",
    "Factor",
    "File",
    "Flag",
    "Fraction",
    "Length",
    "Lengths",
    "Numbers",
    "Point",
    "PoissonRatio",
    "PositiveCount",
    "PositiveEnergyPerArea",
    "PositiveLength",
    "PositiveStress",
    "Share",
    "SignedShare",
    "Size",
    "Target",
    "Thickness",
    "Tolerance",
    "as_tuple",
    "derived",
    "fail",
    "instead",
    "listed",
    "whole",
]

Axis = Literal["x", "y", "z"]
LARGEST_INTEGER = 2**63 - 1
_WAITING, _MISSING = object(), object()


def fail(problem: str, allowed: str = "", key: str | tuple[int | str, ...] = ()) -> NoReturn:
    """Raise the error that `fissura.case.report` turns into the message for the user.

    Parameters
    ----------
    problem, allowed : str
        What is wrong and what would be right.
    key : str or tuple, optional
        Key inside the model being validated, or the keys and indices that lead to it; empty for the value itself.

    Raises
    ------
    PydanticCustomError
        Always.
    """
    context = {"problem": problem, "allowed": allowed, "key": (key,) if isinstance(key, str) else key}
    raise PydanticCustomError("fissura", "{problem}", context)


def derived(function: Callable[..., float], *keys: str) -> Callable[[dict[str, Any]], Any]:
    """Default computed from other keys of the same table, which stand before it.

    Parameters
    ----------
    function : callable
        Takes the values of the keys.
    *keys : str
        Names of the keys; while one of them is wrong there is no default, and no second message about it.
    """

    def default(data: dict[str, Any]) -> Any:
        if any(key not in data for key in keys):
            return _WAITING
        return function(*(data[key] for key in keys))

    return default


def instead(key: str, function: Callable[[Any], float]) -> Callable[[dict[str, Any]], Any]:
    """Default of a field that is required unless another key of the same table, which stands before it, is given.

    Parameters
    ----------
    key : str
        Name of the other key, whose value is None when it is not given.
    function : callable
        Takes its value.
    """

    def default(data: dict[str, Any]) -> Any:
        if key not in data:
            return _WAITING
        return _MISSING if data[key] is None else function(data[key])

    return default


def _quantity(
    dimension: Dimension, above: float = -math.inf, *, equal: bool = False, below: float = math.inf, hint: str = ""
) -> Callable[[Any], float]:
    """Validator of a quantity in the interval (above, below], or [above, below] with ``equal``.

    The hint is for those who give a value on the other side.
    """
    allowed = dimension.allowed
    if below < math.inf and equal:
        allowed += f", {above:g} to {below:g}"
    elif below < math.inf:
        allowed += f", above {above:g} and at most {below:g}"
    elif above > -math.inf:
        allowed += ", zero or positive" if equal else ", positive"

    def validate(value: Any) -> float:
        if value is _WAITING:
            raise PydanticCustomError("waiting", "its default depends on a key that is wrong")
        if value is _MISSING:
            raise PydanticCustomError("missing", "missing")
        try:
            number = to_si(value, dimension)
        except ValueError as error:
            fail(str(error), allowed)
        if number < above or (number == above and not equal) or number > below:
            sign = "not positive" if number == 0 else "negative" if number < 0 else "too large"
            fail(f"{show(value)} is {sign}", allowed + hint)
        return number

    return validate


def _poisson(value: Any) -> float:
    law = bulk_law()
    least, most = law.range
    try:
        number = to_si(value, NUMBER)
    except ValueError as error:
        fail(str(error), law.allowed)
    if not least <= number <= most:
        fail(f"{show(value)} cannot be reached", law.allowed)
    return number


def _integer(smallest: int) -> Callable[[Any], int]:
    allowed = f"a whole number, {smallest} or larger"

    def validate(value: Any) -> int:
        number = whole(value)
        if number is None:
            fail(f"{show(value)} is not a whole number", allowed)
        if not smallest <= number <= LARGEST_INTEGER:
            fail(f"{show(value)} is {'too small' if number < smallest else 'too large'}", allowed)
        return number

    return validate


def whole(value: Any) -> int | None:
    """A whole number of Python or NumPy as one of Python; None for anything else, truth values included."""
    return int(value) if not isinstance(value, bool) and isinstance(value, Integral) else None


def listed(value: Any) -> Any:
    """A tuple or an array as a list; anything else as it is."""
    if isinstance(value, tuple):
        return list(value)
    found = value.tolist() if hasattr(value, "tolist") else value  # arrays, without loading NumPy to ask
    return found if isinstance(found, list) else value


def _flag(value: Any) -> bool:
    if type(value).__name__ not in ("bool", "bool_"):  # Python's and NumPy's
        fail(f"{show(value)} is neither true nor false", "true or false")
    return bool(value)


def _three(what: str) -> Callable[[Any], Any]:
    def validate(value: Any) -> Any:
        value = listed(value)
        if not isinstance(value, list):
            fail(f"{show(value)} is not a list", f"a list of three {what}")
        if len(value) != 3:
            fail(f"the list has {len(value)} entries", f"a list of three {what}")
        return value

    return validate


def _unit_vector(value: Any) -> tuple[float, float, float]:
    numbers = [to_si_or_fail(item) for item in _three("numbers")(value)]
    if abs(math.hypot(*numbers) - 1.0) < 8e-16:  # a case read again from what it resolved is the same, bit for bit
        return numbers[0], numbers[1], numbers[2]
    largest = max(abs(number) for number in numbers)
    if largest == 0:
        fail("the direction is zero", "three numbers, not all zero")
    x, y, z = (number / largest for number in numbers)  # keeps the squares from overflow
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


def to_si_or_fail(value: Any) -> float:
    """Return a pure finite number, or fail with the message for the user."""
    try:
        return to_si(value, NUMBER)
    except ValueError as error:
        fail(str(error), "a list of three numbers such as [0, -1, 0]")


def _file(value: Any, info: ValidationInfo) -> Path:
    allowed = "a file's path, relative to the case file"
    if not isinstance(value, (str, Path)) or not str(value) or "\0" in str(value):
        fail(f"{show(value)} is not a path", allowed)
    context = info.context or {}
    path: Path = context.get("folder", Path()) / value
    if not context.get("files_exist", True):
        return path.absolute()
    try:
        if not path.is_file():
            fail(f"{show(str(path))} is {'not a file' if path.exists() else 'missing'}", allowed)
        with path.open("rb"):
            pass
    except OSError as error:
        fail(f"{show(str(path))} cannot be read: {error.strerror}", allowed)
    return path.resolve()


def _one_or_three(value: Any) -> Any:
    """Take one length where three may stand as a list of one."""
    value = listed(value)
    if not isinstance(value, list):
        return (_quantity(LENGTH, 0.0)(value),)
    if len(value) not in (1, 3):
        fail(f"the list has {len(value)} entries", "one length, or a list of three")
    return value


def _numbers(value: Any) -> tuple[float, ...]:
    allowed = "a list of numbers such as [0.3, -1.2]"
    value = listed(value)
    if not isinstance(value, list):
        fail(f"{show(value)} is not a list", allowed)
    try:
        return tuple(to_si(item, NUMBER) for item in value)
    except ValueError as error:
        fail(str(error), allowed)


def as_tuple(value: Any) -> Any:
    """Take one table where a list of tables is due as a list of one."""
    return (value,) if isinstance(value, dict) else value


Length = Annotated[float, BeforeValidator(_quantity(LENGTH))]
PositiveLength = Annotated[float, BeforeValidator(_quantity(LENGTH, 0.0))]
Target = Annotated[
    float,
    BeforeValidator(
        _quantity(LENGTH, 0.0, hint="; for a gauge that gets smaller under the load, turn gauge.direction instead")
    ),
]
Thickness = Annotated[float, BeforeValidator(_quantity(LENGTH, 0.0, equal=True))]
PositiveStress = Annotated[float, BeforeValidator(_quantity(STRESS, 0.0))]
PoissonRatio = Annotated[float, BeforeValidator(_poisson)]
PositiveEnergyPerArea = Annotated[float, BeforeValidator(_quantity(ENERGY_PER_AREA, 0.0))]
Factor = Annotated[float, BeforeValidator(_quantity(NUMBER, 0.0))]
Fraction = Annotated[float, BeforeValidator(_quantity(NUMBER, 0.0, below=1.0))]
Share = Annotated[float, BeforeValidator(_quantity(NUMBER, 0.0, equal=True, below=1.0))]
SignedShare = Annotated[float, BeforeValidator(_quantity(NUMBER, -1.0, equal=True, below=1.0))]
Tolerance = Annotated[float, BeforeValidator(_quantity(NUMBER, 0.0, below=0.1))]
Count = Annotated[int, BeforeValidator(_integer(0))]
PositiveCount = Annotated[int, BeforeValidator(_integer(1))]
Flag = Annotated[bool, BeforeValidator(_flag)]
Point = Annotated[tuple[Length, Length, Length], BeforeValidator(_three("lengths"))]
Size = Annotated[tuple[PositiveLength, PositiveLength, PositiveLength], BeforeValidator(_three("lengths"))]
Lengths = Annotated[tuple[PositiveLength, ...], BeforeValidator(_one_or_three)]
Numbers = Annotated[tuple[float, ...], BeforeValidator(_numbers)]
Direction = Annotated[tuple[float, float, float], BeforeValidator(_unit_vector)]
File = Annotated[Path, BeforeValidator(_file)]
