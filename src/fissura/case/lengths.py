"""Points, lines, names of surfaces, and units that are given once for a whole table."""

from collections.abc import Mapping
from numbers import Real
from typing import Annotated, Any

from pydantic import BeforeValidator

from fissura.case.accepted import accepting, one_or_list
from fissura.case.report import fail
from fissura.case.types import Length, Point, list_of, listed
from fissura.case.units import LENGTH, show, to_si

#: Description of the key `unit`.
UNIT = 'the unit of the plain numbers in this table, such as "mm"'

_LONGEST_NAME = 60
_NOTCH = "notch"  # as `fissura.specimen.notches` calls what notches leave


def _surface(value: Any) -> str:
    allowed = f"text of 1 to {_LONGEST_NAME} characters"
    if not isinstance(value, str):
        fail(f"{show(value)} is not text", allowed)
    if not value.strip() or len(value) > _LONGEST_NAME or not value.isprintable():
        fail(f"{show(value)} is no name of a surface", allowed)
    return value


def _new_surface(value: Any) -> str:
    if value == _NOTCH:
        fail(f'"{_NOTCH}" is the surface of notches', "another name")
    return _surface(value)


@accepting(one_or_list)
def _surfaces(value: Any) -> Any:
    """Take one name where several may stand as a list of one."""
    value = listed(value)
    if isinstance(value, str):
        return (value,)
    if not isinstance(value, list):
        fail(f"{show(value)} is not a name", "the name of a surface, or a list of names")
    if not value:
        fail("the list is empty", "the name of a surface, or a list of names")
    return value


def in_unit(data: Any, *keys: str) -> Any:
    """A table whose plain numbers are in its own `unit`, as one in SI units without it.

    Parameters
    ----------
    data : object
        What the file says; only a table with the key ``unit`` is changed.
    *keys : str
        Keys whose values are lengths, or lists or tables of lengths.
    """
    if not isinstance(data, Mapping) or data.get("unit") is None:
        return data
    unit = data["unit"]
    allowed = 'a unit of length such as "mm", for the plain numbers in this table'
    if not isinstance(unit, str):
        fail(f"{show(unit)} is not text", allowed, "unit")
    try:
        to_si(f"1 {unit}", LENGTH)
    except ValueError:
        fail(f"{show(unit)} is not a unit of length", allowed, "unit")

    def scaled(value: Any) -> Any:
        value = listed(value)
        if isinstance(value, list):
            return [scaled(item) for item in value]
        if isinstance(value, Mapping):
            return {key: scaled(item) for key, item in value.items()}
        if isinstance(value, bool) or not isinstance(value, Real):
            return value
        try:
            return to_si(f"{float(value)!r} {unit}", LENGTH)
        except (ValueError, OverflowError):
            return value  # not finite: whoever validates it says so

    return {key: scaled(value) if key in keys else value for key, value in data.items() if key != "unit"}


Pair = Annotated[tuple[Length, Length], BeforeValidator(list_of(2, "lengths"))]
Line = Annotated[tuple[Point, Point], BeforeValidator(list_of(2, "points"))]
SurfaceName = Annotated[str, BeforeValidator(_surface)]
SurfaceNames = Annotated[tuple[SurfaceName, ...], BeforeValidator(_surfaces)]
NewSurface = Annotated[str, BeforeValidator(_new_surface)]
