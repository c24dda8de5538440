"""Constants of the material, as a case gives them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from fissura.bulk import bulk_law
from fissura.case.part import Part
from fissura.case.region import Region
from fissura.case.types import (
    Factor,
    Fraction,
    PoissonRatio,
    PositiveEnergyPerArea,
    PositiveStress,
    as_tuple,
    derived,
    fail,
    instead,
)

__all__ = ["Macro", "Material"]


class Macro(Part):
    """Elastic constants of the material as a whole (theory section 2)."""

    E: PositiveStress = Field(description='a stress such as "38 GPa"')
    nu: PoissonRatio = Field(description="a number such as 0.18")

    @property
    def contact(self) -> tuple[float, float]:
        """``E`` [Pa] and ``alpha`` of the contacts."""
        return bulk_law().contact(self.E, self.nu)


class Material(Part):
    """Constants of the contact law (theory section 3); `macro` only serves to find two of them and is None then."""

    law: str = Field(default="cusatis-cedolin", description="the name of a law")
    macro: Macro | None = Field(default=None, exclude=True, description="a table with E and nu")
    E: PositiveStress = Field(
        default_factory=instead("macro", lambda macro: macro.contact[0]),
        description='a stress such as "60 GPa", or macro = { E, nu } instead of E and alpha',
    )
    alpha: Fraction = Field(
        default_factory=instead("macro", lambda macro: macro.contact[1]),
        description="a number above 0 and at most 1, or macro = { E, nu } instead of E and alpha",
    )
    f_t: PositiveStress = Field(description='a stress such as "2.2 MPa"')
    G_t: PositiveEnergyPerArea = Field(description='an energy per area such as "35 J/m^2"')
    f_s: PositiveStress = Field(default_factory=derived(lambda f_t: 3.0 * f_t, "f_t"))
    f_c: PositiveStress = Field(default_factory=derived(lambda f_t: 16.0 * f_t, "f_t"))
    G_s: PositiveEnergyPerArea = Field(default_factory=derived(lambda G_t: 16.0 * G_t, "G_t"))
    K_c: PositiveStress = Field(default_factory=derived(lambda E: 0.26 * E, "E"))
    mu: Factor = 0.2
    beta: Factor = 1.0
    n_c: Factor = 2.0
    elastic: Annotated[tuple[Region, ...], BeforeValidator(as_tuple)] = ()

    @model_validator(mode="after")
    def _either_contacts_or_whole(self) -> Self:
        if self.macro is not None:
            for key in ("E", "alpha"):
                if key in self.model_fields_set:
                    fail("is given together with macro", "either macro = { E, nu }, or E and alpha", key)
            # What was given is in `E` and `alpha` now. A case read again from its resolved values is the same case.
            self.__dict__["macro"] = None
            self.model_fields_set.update(("E", "alpha"))
        return self

    def _given(self, update: Mapping[str, Any]) -> dict[str, Any]:
        replaced = ("macro",) if update.get("macro") is None else ("E", "alpha")
        return {key: value for key, value in super()._given(update).items() if key not in replaced}
