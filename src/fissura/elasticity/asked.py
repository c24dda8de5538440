"""What the command `fissura elastic` is asked for, read from what users write."""

from collections.abc import Sequence

from fissura.case.ranges import BULK_MODULI, ENERGIES, LENGTHS, MODULI, STRENGTHS, Range, between
from fissura.case.units import ENERGY_PER_AREA, LENGTH, NUMBER, STRESS, Dimension, to_si
from fissura.elasticity import limits
from fissura.errors import InputError


def parse_numbers(text: str, key: str, low: float, high: float) -> tuple[float, ...]:
    """Numbers separated by commas.

    Parameters
    ----------
    text : str
        What the user wrote.
    key : str
        The option, for the message.
    low, high : float
        Smallest and largest number allowed.

    Raises
    ------
    InputError
        Text that is not such a list, or a list of too many.
    """
    allowed = f"at most {limits.MOST_NUMBERS} numbers from {low:g} to {high:g}, separated by commas"
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(key, f"{text!r} is not a list of numbers", allowed) from None
    if len(numbers) > limits.MOST_NUMBERS:
        raise InputError(key, f"the list has {len(numbers)} entries", allowed)
    for number in numbers:
        if not low <= number <= high:
            raise InputError(key, f"{number:g} is out of range", allowed)
    return numbers


def parse_modulus(text: str, key: str) -> float:
    """A modulus with its unit, or a plain number in Pa; in Pa.

    Raises
    ------
    InputError
        Anything else.
    """
    return _parsed(text, key, STRESS, MODULI)


def _pairs(parts: Sequence[str], names: Sequence[str], key: str, allowed: str) -> dict[str, str]:
    """What was given as ``name=value`` for each of some names, in any order."""
    found: dict[str, str] = {}
    for part in parts:
        name, sign, value = (piece.strip() for piece in part.partition("="))
        if not sign or name not in names or name in found:
            raise InputError(key, f"{part!r} is not understood", allowed)
        found[name] = value
    if set(found) != set(names):
        raise InputError(key, f"needs {', '.join(names[:-1])} and {names[-1]}", allowed)
    return found


def _parsed(text: str, key: str, dimension: Dimension, limits: Range) -> float:
    value: str | float = text
    try:
        value = float(text)
    except ValueError:
        if not dimension.unit:
            raise InputError(key, f"{text!r} is not a number", dimension.allowed) from None
    try:
        number = to_si(value, dimension)
    except ValueError as error:
        raise InputError(key, str(error), dimension.allowed) from None
    if wrong := limits.what_is_wrong(number):
        raise InputError(key, f"{text!r} is {wrong}", f"{dimension.allowed}, {limits.text}")
    return number


def parse_inverse(parts: Sequence[str]) -> tuple[float, float]:
    """Modulus of elasticity [Pa] and Poisson's ratio from ``E=38GPa`` and ``nu=0.18``, in any order.

    Raises
    ------
    InputError
        Anything else.
    """
    found = _pairs(parts, ("E", "nu"), "--inverse", "E=38GPa nu=0.18")
    return (
        _parsed(found["E"], "--inverse E", STRESS, BULK_MODULI),
        _parsed(found["nu"], "--inverse nu", NUMBER, between(0.0, 0.5, words=False)),
    )


def parse_tension(parts: Sequence[str]) -> tuple[float, float, float]:
    """Strength [Pa], fracture energy [J/m^2] and size of bodies [m] from ``f=3MPa``, ``G_F=100J/m^2``, ``l_f=10mm``.

    Raises
    ------
    InputError
        Anything else.
    """
    found = _pairs(parts, ("f", "G_F", "l_f"), "--tension", "f=3MPa G_F=100J/m^2 l_f=10mm")
    return (
        _parsed(found["f"], "--tension f", STRESS, STRENGTHS),
        _parsed(found["G_F"], "--tension G_F", ENERGY_PER_AREA, ENERGIES),
        _parsed(found["l_f"], "--tension l_f", LENGTH, LENGTHS),
    )
