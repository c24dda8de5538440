"""Regions of a specimen, as a case lists them."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from fissura.case.part import Part
from fissura.case.types import Point, PositiveLength, fail

__all__ = ["BallRegion", "BoxRegion", "Region"]


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
        if any(low >= high for low, high in zip(self.lower, self.upper, strict=True)):
            fail("is not above lower along every axis", "three lengths, each above that of lower", "upper")
        return self


Region = Annotated[BallRegion | BoxRegion, Field(discriminator="type")]
