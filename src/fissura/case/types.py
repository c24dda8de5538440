"""Types of the fields of a case: quantities, directions, files."""

import math
from collections.abc import Callable
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ValidationInfo

from fissura.case.accepted import NUMBER_WITH_UNIT, accepting, one_or_list
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.case.ranges import (
    BULK_MODULI,
    COORDINATES,
    CORRELATION,
    DURATIONS,
    ENERGIES,
    LENGTHS,
    MODULI,
    POSITIVE,
    STRENGTHS,
    WIDTHS,
    between,
    number_of,
    quantity,
)
from fissura.case.report import fail
from fissura.case.units import DURATION, ENERGY_PER_AREA, LENGTH, NUMBER, STRESS, plain, show

Axis = Literal["x", "y", "z"]
LARGEST_INTEGER = 2**63 - 1


@accepting(lambda inner: {**NUMBER_WITH_UNIT, "description": macroscopic_elasticity().allowed})
def _poisson(value: Any) -> float:
    law = macroscopic_elasticity()
    least, most = law.range
    number = number_of(value, NUMBER, law.allowed)
    if not least <= number <= most:
        fail(f"{show(value)} cannot be reached", law.allowed)
    return number


def _integer(smallest: int, largest: int = LARGEST_INTEGER) -> Callable[[Any], int]:
    allowed = f"a whole number, {smallest} " + ("or larger" if largest == LARGEST_INTEGER else f"to {largest}")

    most = {} if largest == LARGEST_INTEGER else {"maximum": largest}

    @accepting(lambda _: {"type": "integer", "minimum": smallest, **most, "description": allowed})
    def validate(value: Any) -> int:
        number = whole(value)
        if number is None:
            fail(f"{show(value)} is not a whole number", allowed)
        if not smallest <= number <= largest:
            fail(f"{show(value)} is {'too small' if number < smallest else 'too large'}", allowed)
        return number

    return validate


def whole(value: Any) -> int | None:
    """A whole number of Python or NumPy as one of Python; None for anything else, truth values included."""
    value = plain(value)
    return int(value) if not isinstance(value, bool) and isinstance(value, Integral) else None


def listed(value: Any) -> Any:
    """A tuple or an array as a list; anything else as it is."""
    if isinstance(value, tuple):
        return list(value)
    found = value.tolist() if hasattr(value, "tolist") else value  # arrays, without loading NumPy to ask
    return found if isinstance(found, list) else value


def _flag(value: Any) -> bool:
    truth = plain(value)
    if not isinstance(truth, bool):
        fail(f"{show(value)} is neither true nor false", "true or false")
    return truth


def list_of(count: int, what: str) -> Callable[[Any], Any]:
    """Validator of a list of two or three entries of a kind, for its length."""
    allowed = f"a list of {'two' if count == 2 else 'three'} {what}"

    def validate(value: Any) -> Any:
        value = listed(value)
        if not isinstance(value, list):
            fail(f"{show(value)} is not a list", allowed)
        if len(value) != count:
            fail(f"the list has {len(value)} entries", allowed)
        return value

    return validate


@accepting(lambda inner: {**inner, "prefixItems": 3 * [NUMBER_WITH_UNIT]})
def _unit_vector(value: Any) -> tuple[float, float, float]:
    allowed = "a list of three numbers such as [0, -1, 0]"
    numbers = [number_of(item, NUMBER, allowed) for item in list_of(3, "numbers")(value)]
    if abs(math.hypot(*numbers) - 1.0) < 8e-16:  # a case read again from what it resolved is the same, bit for bit
        return numbers[0], numbers[1], numbers[2]
    largest = max(abs(number) for number in numbers)
    if largest == 0:
        fail("the direction is zero", "three numbers, not all zero")
    x, y, z = (number / largest for number in numbers)  # keeps the squares from overflow
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


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


@accepting(one_or_list)
def _one_or_three(value: Any) -> Any:
    """Take one correlation length where three may stand as a list of one."""
    value = listed(value)
    if not isinstance(value, list):
        return (value,)
    if len(value) not in (1, 3):
        fail(f"the list has {len(value)} entries", "one length, or a list of three")
    return value


@accepting(lambda inner: {**inner, "items": NUMBER_WITH_UNIT})
def _gaussian(value: Any) -> tuple[float, ...]:
    """Values of standard Gaussian variables."""
    allowed = "a list of numbers such as [0.3, -1.2], each from -10 to 10"
    value = listed(value)
    if not isinstance(value, list):
        fail(f"{show(value)} is not a list", allowed)
    within = between(-10.0, 10.0)
    return tuple(number_of(item, NUMBER, allowed, within, key=(k,)) for k, item in enumerate(value))


@accepting(one_or_list)
def as_tuple(value: Any) -> Any:
    """Take one table where a list of tables is due as a list of one."""
    return (value,) if isinstance(value, dict) else value


def at_most(number: int) -> AfterValidator:
    """Validator of a tuple that has at most so many entries."""

    def validate(value: tuple[Any, ...]) -> tuple[Any, ...]:
        if len(value) > number:
            fail(f"the list has {len(value)} entries", f"at most {number}")
        return value

    return AfterValidator(validate)


Length = Annotated[float, BeforeValidator(quantity(LENGTH, COORDINATES))]
PositiveLength = Annotated[float, BeforeValidator(quantity(LENGTH, LENGTHS))]
Target = Annotated[
    float,
    BeforeValidator(
        quantity(LENGTH, LENGTHS, "; for a gauge that gets smaller under the load, turn gauge.direction instead")
    ),
]
StepLength = Annotated[float, BeforeValidator(quantity(LENGTH, POSITIVE))]
Thickness = Annotated[float, BeforeValidator(quantity(LENGTH, WIDTHS))]
BulkModulus = Annotated[float, BeforeValidator(quantity(STRESS, BULK_MODULI))]
Modulus = Annotated[float, BeforeValidator(quantity(STRESS, MODULI))]
Strength = Annotated[float, BeforeValidator(quantity(STRESS, STRENGTHS))]
PositiveStress = Annotated[float, BeforeValidator(quantity(STRESS, POSITIVE))]
PoissonRatio = Annotated[float, BeforeValidator(_poisson)]
FractureEnergy = Annotated[float, BeforeValidator(quantity(ENERGY_PER_AREA, ENERGIES))]
PositiveEnergyPerArea = Annotated[float, BeforeValidator(quantity(ENERGY_PER_AREA, POSITIVE))]
Alpha = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.001, 1.0)))]
Slope = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.01, 10.0)))]
Shape = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.01, 100.0)))]
Exponent = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.1, 10.0)))]
Variation = Annotated[float, BeforeValidator(quantity(NUMBER, between(1e-6, 100.0)))]
WeibullShape = Annotated[float, BeforeValidator(quantity(NUMBER, between(1.0, 1000.0, open=True)))]
Order = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.01, 50.0)))]
Fraction = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.0, 1.0, open=True)))]
Share = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.0, 1.0, words=False)))]
SignedShare = Annotated[float, BeforeValidator(quantity(NUMBER, between(-1.0, 1.0, words=False)))]
Tolerance = Annotated[float, BeforeValidator(quantity(NUMBER, between(0.0, 0.1, open=True)))]
Duration = Annotated[float, BeforeValidator(quantity(DURATION, DURATIONS))]
Count = Annotated[int, BeforeValidator(_integer(0))]
Thousands = Annotated[int, BeforeValidator(_integer(0, 10_000))]
Repeats = Annotated[int, BeforeValidator(_integer(1, 100_000))]
Iterations = Annotated[int, BeforeValidator(_integer(1, 10_000))]
Flag = Annotated[bool, BeforeValidator(_flag)]
Point = Annotated[tuple[Length, Length, Length], BeforeValidator(list_of(3, "lengths"))]
Size = Annotated[tuple[PositiveLength, PositiveLength, PositiveLength], BeforeValidator(list_of(3, "lengths"))]
CorrelationLength = Annotated[float, BeforeValidator(quantity(LENGTH, CORRELATION))]
Lengths = Annotated[tuple[CorrelationLength, ...], BeforeValidator(_one_or_three)]
Gaussians = Annotated[tuple[float, ...], BeforeValidator(_gaussian)]
Direction = Annotated[tuple[float, float, float], BeforeValidator(_unit_vector)]
File = Annotated[Path, BeforeValidator(_file)]
