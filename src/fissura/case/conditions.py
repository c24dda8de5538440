"""Supports, loads and gauges of a case, and the names of the latter two."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, Self, TypeVar

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from fissura.case.named import NameIn
from fissura.case.own_table import WithOwnTable
from fissura.case.part import Part
from fissura.case.place import Patch
from fissura.case.platen import PlatenOfLoad, PlatenOfSupport
from fissura.case.programme import GRAVITY
from fissura.case.registry import GAUGES, SUPPORTS
from fissura.case.report import fail
from fissura.case.types import Direction
from fissura.case.units import show

P = TypeVar("P", bound=Part)

#: Names of loads and gauges, and how many of each there may be.
_NAME, _MOST_NAMES = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}"), 50


class Support(Patch):
    """Patch of the surface that is held."""

    type: Annotated[str, NameIn(SUPPORTS)]
    platen: PlatenOfSupport = None


class Load(Patch):
    """Patch of the surface that is loaded; direction None: into the specimen."""

    direction: Direction | None = Field(default=None, description="three numbers")
    platen: PlatenOfLoad = None


_PLACE = 'a place such as { face = "bottom", at = "%s" }'


class Gauge(WithOwnTable):
    """Mean displacement of patch b minus that of patch a; direction None: from a to b. Other kinds have own tables."""

    registry: ClassVar = GAUGES

    a: Patch | None = Field(default=None, description=_PLACE % "170 mm")
    b: Patch | None = Field(default=None, description=_PLACE % "180 mm")
    direction: Direction | None = Field(default=None, description="three numbers")

    @property
    def kind(self) -> str:
        """Name of what it measures."""
        return self.own_name or "opening"

    @model_validator(mode="after")
    def _places(self) -> Self:
        if self.own_name:
            self._refuse_beside(self.own_name, ("a", "b", "direction"), f"either a and b, or {self.own_name}")
            return self
        for key in ("a", "b"):
            if getattr(self, key) is None:
                fail("missing", f"{type(self).model_fields[key].description}", key)
        return self


@dataclass(frozen=True)
class Named(Generic[P]):
    """A load or a gauge with its name.

    Attributes
    ----------
    name : str
        Its name in stages and results.
    key : str
        Where the case has it, for messages.
    part : Load or Gauge
        The table.
    """

    name: str
    key: str
    part: P


def named(name: str, one: P | None, many: Mapping[str, P]) -> tuple[Named[P], ...]:
    """All of a kind: the table without a name, which is called after the kind, then those with names."""
    first = () if one is None else (Named(name, name, one),)
    return (*first, *(Named(key, f"{name}s.{key}", part) for key, part in many.items()))


def _with_names(value: Any, info: ValidationInfo) -> Any:
    """See whether tables have names that may be used."""
    kind = f"{info.field_name}".removesuffix("s")
    tables = f"tables with names, such as [{kind}s.left]; one without a name is [{kind}]"
    if isinstance(value, list):
        fail("is a list of tables", tables)
    if not isinstance(value, dict):
        fail(f"{show(value)} is not a table", tables)
    if len(value) > _MOST_NAMES:
        fail(f"{len(value)} are given", f"at most {_MOST_NAMES}")
    for name in value:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            allowed = "a letter, then letters, digits, - and _, up to 40 of them"
            fail("is no name for a load or a gauge", allowed, (str(name),))
        if not isinstance(value[name], Mapping | Part):
            fail(f"{name} = {show(value[name])} stands where tables with names do", tables)
        if name == GRAVITY:
            fail("is the name of the specimen's own weight", "a table [gravity], or another name", (name,))
    return value


Tables = Annotated[dict[str, P], BeforeValidator(_with_names)]
"""Loads or gauges by name."""
