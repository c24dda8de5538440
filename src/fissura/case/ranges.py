"""Numbers of a case: the ranges in which they must lie, and defaults that follow from other keys."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BeforeValidator, ValidationInfo
from pydantic_core import PydanticCustomError

from fissura.case.accepted import NUMBER_WITH_UNIT, accepting
from fissura.case.report import fail
from fissura.case.units import Dimension, show, to_si

#: Largest length in a case [m]. Longer defaults are cut to it, so that a case can be read again from its own values.
LONGEST = 1e4

_WAITING, _MISSING = object(), object()


@dataclass(frozen=True)
class Range:
    """Values that a key may have: wide enough for any experiment, narrow enough for products and ratios to be numbers.

    Attributes
    ----------
    least, most : float
        Both belong to it, the lower one unless it is `open`.
    text : str
        The same in words, for messages.
    open : bool
        Whether ``least`` itself is left out.
    zero : bool
        Whether 0 is allowed besides.
    """

    least: float
    most: float
    text: str
    open: bool = False
    zero: bool = False

    def what_is_wrong(self, number: float) -> str:
        """How a number misses the range; empty where it lies in it."""
        if self.least < number <= self.most or (number == self.least and not self.open) or (number == 0 and self.zero):
            return ""
        if number > self.most:
            return "too large"
        if self.least < 0.0 or number > 0.0:
            return "too small"
        return "not positive" if number == 0.0 else "negative"


COORDINATES = Range(-LONGEST, LONGEST, "-10 km to 10 km")
LENGTHS = Range(1e-9, LONGEST, "positive, 1 nm to 10 km")
#: The longest ones make a field the same everywhere.
CORRELATION = Range(1e-9, 1e9, "positive, 1 nm to 1e9 m")
WIDTHS = Range(1e-9, LONGEST, "zero or positive, 1 nm to 10 km", zero=True)
MODULI = Range(1e3, 1e14, "positive, 1 kPa to 100 TPa")
#: Those of the material as a whole are up to four times smaller.
BULK_MODULI = Range(1e3, 1e13, "positive, 1 kPa to 10 TPa")
STRENGTHS = Range(1.0, 1e12, "positive, 1 Pa to 1 TPa")
ENERGIES = Range(1e-6, 1e9, "positive, 1e-6 to 1e9 J/m^2")
FORCES = Range(-1e12, 1e12, "-1e12 N to 1e12 N")
DENSITIES = Range(1.0, 1e5, "positive, 1 to 1e5 kg/m^3")
ACCELERATIONS = Range(1e-3, 1e5, "positive, 0.001 to 1e5 m/s^2")
DURATIONS = Range(1e-3, 1e7, "0 or 1 ms to 1e7 s", zero=True)
#: For keys that are bounded by another one.
POSITIVE = Range(0.0, math.inf, "positive", open=True)


def between(least: float, most: float, *, open: bool = False, words: bool = True) -> Range:
    """Range of a pure number.

    Parameters
    ----------
    least, most : float
        Ends.
    open : bool, optional
        Whether the lower one is left out.
    words : bool, optional
        Whether it is told as ``above 0 and at most 1``; else as ``0 to 1``.
    """
    text = f"{'above' if open else 'at least'} {least:g} and at most {most:g}" if words else f"{least:g} to {most:g}"
    return Range(least, most, text, open)


def quantity(dimension: Dimension, allowed_range: Range, hint: str = "") -> Callable[[Any], float]:
    """Validator of a number, or of a text with a unit, within a range; the hint is for those outside it."""
    allowed = f"{dimension.allowed}, {allowed_range.text}"

    @accepting(lambda _: {**NUMBER_WITH_UNIT, "description": allowed})
    def validate(value: Any) -> float:
        if value is _WAITING:
            raise PydanticCustomError("waiting", "its default depends on a key that is wrong")
        if value is _MISSING:
            raise PydanticCustomError("missing", "missing")
        return number_of(value, dimension, allowed, allowed_range, hint)

    return validate


def number_of(
    value: Any,
    dimension: Dimension,
    allowed: str,
    allowed_range: Range | None = None,
    hint: str = "",
    key: tuple[int | str, ...] = (),
) -> float:
    """A number in SI units within a range, or the message for the user about what stands at a key."""
    try:
        number = to_si(value, dimension)
    except ValueError as error:
        fail(str(error), allowed, key)
    if allowed_range is not None and (wrong := allowed_range.what_is_wrong(number)):
        fail(f"{show(value)} is {wrong}", allowed + hint, key)
    return number


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

    vars(default)["follows"] = keys
    return default


def unless(*keys: str) -> BeforeValidator:
    """Validator of a field that is required unless one of some other keys, which stand before it, is given."""

    def validate(value: Any, info: ValidationInfo) -> Any:
        if value is None:
            if any(key not in info.data for key in keys):
                raise PydanticCustomError("waiting", "whether it is needed depends on a key that is wrong")
            if not any(info.data[key] for key in keys):
                raise PydanticCustomError("missing", "missing")
        return value

    return BeforeValidator(validate)


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

    vars(default)["follows"] = (key,)
    return default
