"""What a case file says about many runs of it: how many, with which seeds, and which keys are varied."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from fissura.case.accepted import Schema, accepting
from fissura.case.part import Part
from fissura.case.report import fail
from fissura.case.types import Count, Repeats, listed
from fissura.case.units import plain, show

Varied = dict[str, tuple[Any, ...]]
"""Values by dotted key, as a case file gives them."""

Combine = Literal["grid", "together"]
"""Whether every value meets every value of the other keys, or the first values go together, then the second, ..."""

COMBINE = '"grid" (all combinations) or "together" (the first value of each key, then the second, ...)'

_ALLOWED = 'lists of values by key, such as vary = { "material.f_t" = ["2.5 MPa", "3 MPa"] }'


def lists_of_values(vary: Any) -> Varied:
    """Lists of values by dotted key; tables may be nested instead of keys with dots.

    Raises
    ------
    PydanticCustomError
        Something is no list of values, or a key is there twice.

    Examples
    --------
    >>> lists_of_values({"material": {"f_t": ["2 MPa", "3 MPa"]}})
    {'material.f_t': ('2 MPa', '3 MPa')}
    """
    if not isinstance(vary, Mapping):
        fail(f"{show(vary)} is not a table", _ALLOWED)
    found: Varied = {}
    for key, values in _leaves(vary, ()):
        if key in found:
            fail(f"{key} is there twice", _ALLOWED)
        found[key] = values
    return found


def _leaves(table: Mapping[Any, Any], outer: tuple[str, ...]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    for name, value in table.items():
        path = (*outer, *str(name).split("."))
        value = listed(value)
        if isinstance(value, Mapping):
            yield from _leaves(value, path)
        elif not isinstance(value, list):
            fail(f"{show(value)} is not a list", _ALLOWED, path)
        elif not value:
            fail("the list is empty", _ALLOWED, path)
        else:
            yield ".".join(path), tuple(plain(listed(item)) for item in value)


@accepting(lambda _: _SCHEMA)
def _varied(value: Any) -> Varied:
    return lists_of_values(value)


_SCHEMA: Schema = {"type": "object", "description": _ALLOWED}


class Ensemble(Part):
    """Table ``[ensemble]``: what ``fissura ensemble`` runs unless its options say something else."""

    runs: Repeats | None = None
    seeds: tuple[Count, ...] = Field(default=(), description="a list of whole numbers, 0 or larger")
    vary: Annotated[Varied, BeforeValidator(_varied)] = Field(default={}, description=_ALLOWED)
    combine: Combine = "grid"

    @model_validator(mode="after")
    def _either(self) -> Self:
        if self.runs is not None and self.seeds:
            fail("is given together with runs", "either runs, their number, or seeds, a list", "seeds")
        return self
