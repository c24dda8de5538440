"""Other materials in parts of a specimen, as a case lists them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from fissura.case.material import Material
from fissura.case.part import Part
from fissura.case.region import Region
from fissura.case.report import fail
from fissura.case.types import as_tuple, at_most
from fissura.errors import InputError

#: Keys of [material] that hold for all of a specimen.
_COMMON = ("law", "elastic")


class MaterialRegion(Part):
    """Part of a specimen with another material: any constants of ``[material]`` that differ there."""

    model_config = ConfigDict(extra="allow")

    region: Annotated[tuple[Region, ...], BeforeValidator(as_tuple), at_most(10_000)] = Field(
        description="a region, or a list of them"
    )

    _differing: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _somewhere(self) -> MaterialRegion:
        if not self.region:
            fail("the list is empty", "at least one region", "region")
        return self

    @property
    def constants(self) -> dict[str, Any]:
        """What differs, by key."""
        return dict(self.__pydantic_extra__ or {})

    def resolved(self, material: Material) -> Material:
        """The material with what differs; defaults that were not given follow.

        Raises
        ------
        InputError
            A value is wrong, or does not go with the others.
        """
        return material.model_copy(update=self.constants)

    def settle(self, material: Material, key: str) -> None:
        """See whether the constants are right, and keep them as numbers in SI units.

        Parameters
        ----------
        material : Material
            The one from which this one differs.
        key : str
            Where this one stands, for messages.

        Raises
        ------
        InputError
            See :meth:`resolved`.
        """
        given = self.constants
        for name in _COMMON:
            if name in given:
                raise InputError(f"{key}.{name}", "holds for the whole specimen", f"material.{name}")
        try:
            found = self.resolved(material)
        except InputError as error:
            raise InputError(f"{key}.{error.key}", error.problem, error.allowed) from None
        if given.pop("macro", None) is not None:
            given.update(E=found.E, alpha=found.alpha)
        constants, common = found.model_dump(), material.model_dump()
        object.__setattr__(self, "__pydantic_extra__", {name: constants[name] for name in given})
        # A case read again has all constants of its material given, so that no default follows there.
        self._differing = {
            name: value for name, value in constants.items() if name in given or value != common.get(name)
        }

    def _given(self, update: Mapping[str, Any]) -> dict[str, Any]:
        given = self.constants
        if update.get("macro") is not None:
            given = {name: value for name, value in given.items() if name not in ("E", "alpha")}
        return {"region": self.region, **given}

    @model_serializer(mode="wrap")
    def _dumped(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {**handler(self), **self._differing}
