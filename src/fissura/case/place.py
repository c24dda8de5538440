"""Places on the surface, and notches, as a case gives them."""

from typing import Any, Self

from pydantic import Field, model_validator

from fissura.case.lengths import UNIT, Line, SurfaceName, SurfaceNames, in_unit
from fissura.case.part import Part
from fissura.case.report import fail
from fissura.case.types import Axis, Direction, Length, Point, PositiveLength, Thickness

#: Axis along which positions on a face of a box are given unless the case says otherwise.
FACE_AXIS: dict[str, Axis] = {"left": "y", "right": "y", "bottom": "x", "top": "x", "front": "x", "back": "x"}

_NAME = "the name of a face, such as bottom or top"


def _axis_of_face(data: dict[str, Any]) -> Axis | None:
    return FACE_AXIS.get(data.get("face") or "")


class Box(Part):
    """Box along the axes that picks what of a surface lies in it."""

    lower: Point = Field(description="three lengths")
    upper: Point = Field(description="three lengths")

    @model_validator(mode="after")
    def _lower_below_upper(self) -> Self:
        if any(low > high for low, high in zip(self.lower, self.upper, strict=True)):
            fail("is below lower", "three lengths, none below that of lower", "upper")
        return self


class Patch(Part):
    """Place on the surface: all of one or more surfaces, or a line, strip, point or part of them."""

    face: str | None = Field(default=None, description=_NAME)
    on: SurfaceNames | None = Field(default=None, description="the name of a surface, or a list of names")
    unit: None = Field(default=None, exclude=True, description=UNIT)
    at: Length | None = Field(default=None, description="a length, the coordinate on the face along `along`")
    along: Axis | None = Field(default_factory=_axis_of_face, description='"x", "y" or "z"')
    width: Thickness = Field(default=0.0, description="a length; zero for a line")
    point: Point | None = Field(default=None, description="three lengths")
    line: Line | None = Field(default=None, description="two points, each three lengths")
    toward: Direction | None = Field(default=None, description="three numbers, a direction")
    box: Box | None = Field(default=None, description="a table with lower and upper")

    @model_validator(mode="before")
    @classmethod
    def _in_unit(cls, data: Any) -> Any:
        return in_unit(data, "at", "width", "point", "line", "box")

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if not self._at_most_one(("face", "on"), "either face or on, which may name several"):
            fail("missing", _NAME, "face")
        allowed = "one of at, point, line and box, or none of them for the whole face"
        given = self._at_most_one(("at", "point", "line", "box"), allowed)
        if self.width > 0 and given != ["at"] and (given or self.toward is None):
            allowed = "a width only with at, or with toward alone: it is the width of the platen there"
            fail("is given without at", allowed, "width")
        return self

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of the surfaces on which the place is."""
        return (self.face,) if self.face is not None else self.on or ()

    @property
    def told(self) -> str:
        """The same for messages."""
        return ", ".join(repr(name) for name in self.surfaces)

    @property
    def naming(self) -> str:
        """The key that names them."""
        return "face" if self.face is not None else "on"


def _is_short(data: dict[str, Any]) -> bool:
    return data.get("on") is None and data.get("at") is None


def _face_of_notch(data: dict[str, Any]) -> str | None:
    return "bottom" if _is_short(data) else None


def _normal_of_notch(data: dict[str, Any]) -> Axis | None:
    return FACE_AXIS.get(data.get("face") or "", "x") if _is_short(data) else None


class Notch(Part):
    """Straight notch: across a face along an axis, or from any point of a surface in any direction."""

    on: SurfaceName | None = Field(default=None, description="the name of a surface")
    unit: None = Field(default=None, exclude=True, description=UNIT)
    at: Point | None = Field(default=None, description="three lengths, a point of the mouth")
    face: str | None = Field(default_factory=_face_of_notch, description="the name of a face")
    normal: Axis | None = Field(default_factory=_normal_of_notch, description='"x", "y" or "z"')
    position: Length | None = Field(default=None, description='a length such as "50 mm", the coordinate along normal')
    direction: Direction | None = Field(default=None, description="three numbers, the way into the specimen")
    along: Direction | None = Field(default=None, description="three numbers, the direction of the front")
    depth: PositiveLength = Field(description='a length such as "50 mm"')
    width: Thickness = Field(default=0.0, description="a length; zero for an ideal cut")

    @model_validator(mode="before")
    @classmethod
    def _in_unit(cls, data: Any) -> Any:
        return in_unit(data, "at", "position", "depth", "width")

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        surface = self._at_most_one(("face", "on"), "either face or on")
        if self.at is None and self.position is None:
            if self.on is not None:
                fail("missing", "three lengths, a point of the mouth; or face and position", "at")
            fail("missing", 'a length such as "50 mm", the coordinate along normal; or on and at', "position")
        if self.at is not None:
            self._refuse_beside("at", ("position", "normal"), "position and normal, or at, direction and along")
            if not surface:
                fail("missing", "the name of a surface", "on")
        else:
            if self.on is not None:
                fail("is given without at", "on and at, or face and position", "on")
            for key in ("direction", "along"):
                if getattr(self, key) is not None:
                    fail("is given without at", "only with on and at", key)
        return self

    @property
    def surface(self) -> str:
        """Name of the surface from which it is cut."""
        return self.face or self.on or ""

    @property
    def naming(self) -> str:
        """The key that names it."""
        return "face" if self.face is not None else "on"
