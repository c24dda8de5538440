"""Constants of the material, as a case gives them."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from fissura.case.macroscopic import macroscopic_elasticity
from fissura.case.named import NameIn
from fissura.case.own_table import WithOwnTable
from fissura.case.part import Part
from fissura.case.ranges import derived, instead
from fissura.case.region import Region
from fissura.case.registry import LAWS
from fissura.case.report import fail
from fissura.case.types import (
    Alpha,
    BulkModulus,
    Exponent,
    FractureEnergy,
    Modulus,
    PoissonRatio,
    PositiveEnergyPerArea,
    PositiveStress,
    Shape,
    Slope,
    Strength,
    as_tuple,
    at_most,
)
from fissura.case.units import ENERGY_PER_AREA, STRESS, told
from fissura.errors import InputError

#: Constants that are bounded by another one: that one, and the least and the largest ratio to it. Within them, and the
#: ranges of the other constants, strengths and softening moduli of the contact law are finite in all directions.
RATIOS = (
    ("f_s", "f_t", STRESS, 0.05, 20.0),
    ("f_c", "f_t", STRESS, 0.05, 1000.0),
    ("G_s", "G_t", ENERGY_PER_AREA, 0.01, 1e6),
    ("K_c", "E", STRESS, 1e-6, 100.0),
)

#: Shear strength over ``mu f_t``, at least.
_LEAST_SHEAR = 1.001


class Macro(Part):
    """Elastic constants of the material as a whole (theory section 2)."""

    E: BulkModulus = Field(description='a stress such as "38 GPa"')
    nu: PoissonRatio = Field(description="a number such as 0.18")

    @property
    def contact(self) -> tuple[float, float]:
        """``E`` [Pa] and ``alpha`` of the contacts."""
        return macroscopic_elasticity().contact(self.E, self.nu)


class Material(WithOwnTable):
    """Constants of the contact law (theory section 3); `macro` only serves to find two of them and is None then."""

    registry: ClassVar = LAWS

    law: Annotated[str, NameIn(LAWS)] = Field(default="cusatis-cedolin", description="the name of a law")
    macro: Macro | None = Field(default=None, exclude=True, description="a table with E and nu")
    E: Modulus = Field(
        default_factory=instead("macro", lambda macro: macro.contact[0]),
        description='a stress such as "60 GPa", or macro = { E, nu } instead of E and alpha',
    )
    alpha: Alpha = Field(
        default_factory=instead("macro", lambda macro: macro.contact[1]),
        description="a number from 0.001 to 1, or macro = { E, nu } instead of E and alpha",
    )
    f_t: Strength = Field(description='a stress such as "2.2 MPa"')
    G_t: FractureEnergy = Field(description='an energy per area such as "35 J/m^2"')
    f_s: PositiveStress = Field(default_factory=derived(lambda f_t: 3.0 * f_t, "f_t"))
    f_c: PositiveStress = Field(default_factory=derived(lambda f_t: 16.0 * f_t, "f_t"))
    G_s: PositiveEnergyPerArea = Field(default_factory=derived(lambda G_t: 16.0 * G_t, "G_t"))
    K_c: PositiveStress = Field(default_factory=derived(lambda E: 0.26 * E, "E"))
    mu: Slope = 0.2
    beta: Shape = 1.0
    n_c: Exponent = 2.0
    elastic: Annotated[tuple[Region, ...], BeforeValidator(as_tuple), at_most(10_000)] = ()

    @classmethod
    def tables(cls) -> list[str]:
        """None: the table of a law goes with that law only."""
        return []

    @property
    def whole(self) -> Macro | None:
        """Elastic constants of the material as a whole that the contacts give; None where their table ends."""
        try:
            E, nu = macroscopic_elasticity().macroscopic(self.E, self.alpha)
            return Macro(E=E, nu=nu)
        except (InputError, ValidationError):
            return None

    @classmethod
    def named_in(cls, data: Mapping[str, Any]) -> str | None:
        """Name of the law."""
        name: str | None = data.get("law", cls.model_fields["law"].default)
        return name

    @model_validator(mode="after")
    def _ratios(self) -> Self:
        for name, other, dimension, least, most in RATIOS:
            value, reference = getattr(self, name), getattr(self, other)
            if not least * reference * (1 - 1e-9) <= value <= most * reference * (1 + 1e-9):
                side = f"less than {least:g}" if value < reference else f"more than {most:g}"
                fail(
                    f"{told(value, dimension)} is {side} times {other} = {told(reference, dimension)}",
                    f"{told(least * reference, dimension)} to {told(most * reference, dimension)};"
                    f" numbers without a unit are in {dimension.unit}",
                    name,
                )
        least = _LEAST_SHEAR * self.mu * self.f_t
        if self.f_s < least:  # the hyperbola of the strengths would cut the axis below f_t, or have its apex there
            if "f_s" in self.model_fields_set:
                fail(f"{told(self.f_s, STRESS)} is not above mu f_t", f"at least {told(least, STRESS)}", "f_s")
            most = self.f_s / (_LEAST_SHEAR * self.f_t)
            fail(f"{self.mu:g} leaves mu f_t not below f_s", f"at most {most:.4g}, f_s/f_t", "mu")
        return self

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
