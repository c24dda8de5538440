"""Regions of a specimen, as a case lists them."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from fissura.case.part import Part
from fissura.case.report import fail
from fissura.case.types import Point, PositiveLength
from fissura.case.units import show


def require_volume(lower: tuple[float, ...], upper: tuple[float, ...]) -> None:
    """Fail, for the key ``upper``, where corners of a box leave it no volume."""
    if any(low >= high for low, high in zip(lower, upper, strict=True)):
        fail("is not above lower along every axis", "three lengths, each above that of lower", "upper")


class BallRegion(Part):
    """Ball-shaped part of space."""

    type: Literal["ball"]
    center: Point = Field(description="three lengths")
    radius: PositiveLength = Field(description='a length such as "50 mm"')


class BoxRegion(Part):
    """Box-shaped part of space, its sides along the axes."""

    type: Literal["box"]
    lower: Point = Field(description="three lengths")
    upper: Point = Field(description="three lengths")

    @model_validator(mode="after")
    def _lower_below_upper(self) -> Self:
        require_volume(self.lower, self.upper)
        return self


def _named(value: Any) -> Any:
    """Refuse a type that is no text: pydantic fails on the message about a number of thousands of digits."""
    kind = value.get("type", "") if isinstance(value, Mapping) else ""
    if not isinstance(kind, str):
        fail(f"{show(kind)} is not known", '"ball" or "box"', "type")
    return value


Region = Annotated[BallRegion | BoxRegion, Field(discriminator="type"), BeforeValidator(_named)]
