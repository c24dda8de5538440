"""Quantities with units: text such as ``"50 mm"`` turned into SI numbers."""

from __future__ import annotations

import math
import re
import reprlib
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Any

from fissura.errors import one_line

if TYPE_CHECKING:
    import pint

_QUANTITY = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_LONGEST, _LONGEST_SHOWN = 80, 60

#: A unit: names of units with an exponent of one digit each, joined by signs or blanks, in brackets if need be. Nothing
#: else reaches the units library, which would compute powers of any size.
_FACTOR = r"[A-Za-zµμ]+(?:(?:\^|\*\*)?[+-]?[0-9](?![0-9])|[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹])?"
_JOINED = rf"{_FACTOR}(?: ?(?:[*·⋅/] ?)?{_FACTOR})*"
_TERM = rf"(?:{_FACTOR}|\( ?{_JOINED} ?\))"
_UNIT = re.compile(rf"{_TERM}(?: ?(?:[*·⋅/] ?)?{_TERM})*")
_EXPONENT = re.compile(r"(?<=[A-Za-zµμ])(?:\^|\*\*)?([+-]?[0-9])")
#: Moments as engineers write them; the units library would read nanometres, or nothing at all.
_MOMENT = re.compile(r"(?<![A-Za-zµμ])([kM]?N)([cm]?m)(?![A-Za-zµμ])")


@dataclass(frozen=True)
class Dimension:
    """A physical dimension that a key of the case file may ask for.

    Attributes
    ----------
    name : str
        Name with its article, ``"a length"``.
    unit : str
        SI unit of the values after validation; empty for pure numbers.
    example : str
        Text that a user may write.
    """

    name: str
    unit: str
    example: str

    @property
    def allowed(self) -> str:
        """What a user may write, in words."""
        if not self.unit:
            return f"{self.name} such as {self.example}"
        return f'{self.name} such as "{self.example}", or a plain number in {self.unit}'


LENGTH = Dimension("a length", "m", "50 mm")
STRESS = Dimension("a stress", "Pa", "2.2 MPa")
ENERGY_PER_AREA = Dimension("an energy per area", "J/m^2", "35 J/m^2")
FORCE = Dimension("a force", "N", "5 kN")
DENSITY = Dimension("a density", "kg/m^3", "2400 kg/m^3")
ACCELERATION = Dimension("an acceleration", "m/s^2", "9.81 m/s^2")
DURATION = Dimension("a duration", "s", "30 s")
NUMBER = Dimension("a number", "", "0.2")

#: SI values of the units that almost every case uses; pint, which knows all others, takes 0.3 s to load.
COMMON: dict[str, dict[str, float]] = {
    LENGTH.unit: {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9},
    STRESS.unit: {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm^2": 1e6, "N/mm²": 1e6},
    ENERGY_PER_AREA.unit: {
        "J/m^2": 1.0,
        "J/m²": 1.0,
        "J/m2": 1.0,
        "N/m": 1.0,
        "N/mm": 1e3,
        "Nm/m^2": 1.0,
        "Nm/m²": 1.0,
        "Nm/m2": 1.0,
    },
    FORCE.unit: {"N": 1.0, "kN": 1e3, "MN": 1e6},
    DENSITY.unit: {"kg/m^3": 1.0, "kg/m³": 1.0, "kg/m3": 1.0, "t/m^3": 1e3},
    ACCELERATION.unit: {"m/s^2": 1.0, "m/s²": 1.0, "m/s2": 1.0},
    DURATION.unit: {"s": 1.0, "min": 60.0, "h": 3600.0},
}


#: Units in which values are told, the largest first.
_TOLD: dict[str, tuple[str, ...]] = {
    LENGTH.unit: ("m", "mm", "um"),
    STRESS.unit: ("GPa", "MPa", "kPa", "Pa"),
    FORCE.unit: ("MN", "kN", "N"),
}


@cache
def _registry() -> pint.UnitRegistry[float]:
    """Unit registry of pint, built at first use, for a unit that is not in `COMMON`."""
    import pint

    return pint.UnitRegistry()


def plain(value: Any) -> Any:
    """Python's number or truth value for one of NumPy, or for an array of a single one without axes."""
    return value.item() if getattr(value, "ndim", None) == 0 else value


def show(value: object) -> str:
    """Return a value as it looks in a case file, shortened to one readable line; any value can be shown."""
    value = plain(value)
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, str):
        text = f'"{one_line(value, _LONGEST_SHOWN - 2)}"'
    elif isinstance(value, int) and value.bit_length() > 1000:  # Python refuses to write out the longest ones
        return f"a whole number of about {round(value.bit_length() * math.log10(2.0))} digits"
    elif isinstance(value, float):
        text = str(value)  # that of NumPy would name its type
    elif isinstance(value, (list, tuple, dict)):
        text = _SHOWN.repr(value)  # that of the value itself may be nested too deeply, or hold such numbers
    else:
        try:
            text = str(value)
        except Exception:
            text = f"an object of type {type(value).__name__}"
    return one_line(text, _LONGEST_SHOWN)


class _Shown(reprlib.Repr):
    """Representation of nested values that is short and always works."""

    def repr_int(self, x: int, level: int) -> str:
        """Write a whole number."""
        return show(x)


_SHOWN = _Shown()
_SHOWN.maxlevel = 3


def told(number: float, dimension: Dimension) -> str:
    """Return an SI number as text with a unit that suits its size, four digits.

    Examples
    --------
    >>> told(60e3, STRESS), told(0.35, LENGTH)
    ('60 kPa', '350 mm')
    """
    units = _TOLD.get(dimension.unit, (dimension.unit,))
    scales = COMMON[dimension.unit]
    unit = next((unit for unit in units if scales[unit] <= abs(number)), units[-1])
    return f"{number / scales[unit]:.4g} {unit}"


def to_si(value: Any, dimension: Dimension) -> float:
    """Turn a number or a text with a unit into an SI number.

    Parameters
    ----------
    value : object
        Number (SI), or text of a number and a unit.
    dimension : Dimension
        What is due.

    Returns
    -------
    float
        Finite value in ``dimension.unit``.

    Raises
    ------
    ValueError
        If the value is no number, has no unit, an unknown unit or a wrong dimension, or is not finite.

    Examples
    --------
    >>> to_si("50 mm", LENGTH)
    0.05
    >>> to_si(0.05, LENGTH)
    0.05
    """
    value = plain(value)
    if isinstance(value, str):
        number = _parse(value, dimension)
    elif not isinstance(value, bool) and isinstance(value, Real):  # NumPy's numbers, too
        try:
            number = float(value)
        except OverflowError:
            raise ValueError(f"{show(value)} is too large") from None
    else:
        raise ValueError(f"{show(value)} is not {dimension.name}")
    if not math.isfinite(number):
        raise ValueError(f"{show(value)} is not finite")
    return number


def _parse(text: str, dimension: Dimension) -> float:
    """Parse number and unit, check the dimension, convert to SI."""
    shown = show(text)
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if not dimension.unit:
        if match is not None and match[2] == "%":
            return float(match[1]) / 100.0
        raise ValueError(f"{shown} is text, not a plain number")
    if match is None:
        if re.fullmatch(r"\s*[+-]?(nan|inf(inity)?)\b.*", text, re.IGNORECASE | re.DOTALL):
            raise ValueError(f"{shown} is not finite")
        raise ValueError(f"{shown} is not a number with a unit")
    number, unit = float(match[1]), match[2]
    if not unit:
        raise ValueError(f"{shown} has no unit")
    if unit[0] in ",0123456789":
        raise ValueError(f"{shown} is not a number with a unit: write decimals with a point, digits unspaced")
    scale = _scale(unit, dimension.unit)
    if scale is None:
        raise ValueError(f'{shown} has a unit that is not known: "{unit}"')
    if math.isnan(scale):
        raise ValueError(f'{shown} is not {dimension.name}: "{unit}" measures something else')
    parts = round(1 / scale) if 0 < scale < 1 else 0
    if parts and math.isclose(parts * scale, 1.0, rel_tol=1e-14):
        return number / parts  # 5 um is 5e-06, not 4.9999999999999996e-06
    return number * scale


@cache
def _scale(unit: str, due: str) -> float | None:
    """SI value of one unit; nan when its dimension is wrong, None when it is not known."""
    common = COMMON.get(due, {}).get(unit)
    return _parsed_scale(unit, due) if common is None else common


def _parsed_scale(unit: str, due: str) -> float | None:
    """SI value of any unit that pint knows, in the manner of `_scale`."""
    unit = " ".join(unit.split())
    if _UNIT.fullmatch(unit) is None:
        return None
    text = _EXPONENT.sub(r"**\1", _MOMENT.sub(r"\1*\2", unit))  # J/m2, J m-2
    registry = _registry()
    try:
        parsed = registry.parse_units(text)
        right = parsed.dimensionality == registry.parse_units(due).dimensionality
        scale = float(registry.Quantity(1.0, parsed).to(due).magnitude) if right else math.nan
    except Exception:  # pint raises whatever its tokenizer meets: the user needs one message
        return None
    return scale if scale != 0.0 and not math.isinf(scale) else None
