"""Platens: rigid bodies between a specimen and what loads or supports it."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from fissura.case.accepted import accepting
from fissura.case.part import Part
from fissura.case.report import fail
from fissura.case.units import show

_CONTACTS = ("glued", "frictionless")
_ALLOWED = '"glued" or "frictionless", or a table with contact'


class Platen(Part):
    """Rigid body on a place: glued to it, or touching it without friction."""

    contact: Literal["glued", "frictionless"] = Field(description='"glued" or "frictionless"')


class GuidedPlaten(Platen):
    """A platen that a load pushes: how it is guided."""

    turning: Literal["free", "hinged", "held"] = Field(default="free", description='"free", "hinged" or "held"')

    @property
    def guided(self) -> bool:
        """Whether anything keeps it from moving as it likes."""
        return self.turning != "free"


@accepting(lambda inner: {"anyOf": [{"enum": list(_CONTACTS)}, inner]})
def _named(value: Any) -> Any:
    """A platen given by its contact alone."""
    if not isinstance(value, str):
        return value
    if value not in _CONTACTS:
        fail(f"{show(value)} is not known", _ALLOWED)
    return {"contact": value}


PlatenOfSupport = Annotated[Platen | None, BeforeValidator(_named)]
PlatenOfLoad = Annotated[GuidedPlaten | None, BeforeValidator(_named)]
