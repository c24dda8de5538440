"""Shapes of specimens, and what is taken away from them, as a case gives them."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from fissura.case.accepted import NUMBER_WITH_UNIT, Schema, accepting
from fissura.case.lengths import UNIT, NewSurface, Pair, in_unit
from fissura.case.named import NameIn
from fissura.case.own_table import WithOwnTable
from fissura.case.part import Part
from fissura.case.region import require_volume
from fissura.case.registry import SHAPES
from fissura.case.report import fail
from fissura.case.types import Axis, File, Length, Point, PositiveLength, Size, StepLength, as_tuple, listed
from fissura.case.units import show

#: Most entries of an outline; each of them becomes a cell or more.
MOST_CORNERS = 2000


_CORNER: Schema = {"type": "array", "items": NUMBER_WITH_UNIT, "minItems": 2, "maxItems": 2}
"""A corner as a list of two lengths."""


class Corner(Part):
    """Corner of an outline, and how the side that ends there comes to it."""

    to: Pair = Field(description="two lengths")
    radius: Length | None = Field(default=None, description="a length, positive where the arc bulges outwards")

    @model_validator(mode="after")
    def _round(self) -> Self:
        if self.radius == 0.0:
            fail(
                "is zero",
                "a length, positive where the arc bulges outwards, negative where it bulges inwards",
                "radius",
            )
        return self


@accepting(lambda inner: {**inner, "items": {"anyOf": [_CORNER, inner["items"]]}, "minItems": 3})
def _corners(value: Any) -> Any:
    """Take a list of two lengths as a corner."""
    allowed = "a list of corners [x, y] and arcs { to = [x, y], radius = r }"
    value = listed(value)
    if not isinstance(value, list):
        fail(f"{show(value)} is not a list", allowed)
    if len(value) < 3:
        fail(f"the list has {len(value)} entries", f"{allowed}, three or more")
    if len(value) > MOST_CORNERS:
        fail(
            f"the list has {len(value)} entries", f"at most {MOST_CORNERS}; arcs can be given as arcs, anything as mesh"
        )
    out: list[Any] = []
    for k, item in enumerate(value):
        pair = listed(item)
        if isinstance(pair, list):
            if len(pair) != 2:
                fail(
                    f"the list has {len(pair)} entries", "a corner [x, y], or an arc { to = [x, y], radius = r }", (k,)
                )
            out.append({"to": pair})
        else:
            out.append(item)
    return tuple(out)


Outline = Annotated[tuple[Corner, ...], BeforeValidator(_corners)]


_BOX = 'three lengths [length x, depth y, thickness z], each such as "50 mm"'

#: Shapes of Fissura, and keys that have another name than their shape.
_SHAPES, _KEYS = ("box", "outline", "cylinder", "mesh"), {"box": "size"}


class Cylinder(Part):
    """Cylinder whose axis goes through the origin, from there along its axis."""

    diameter: PositiveLength = Field(description='a length such as "150 mm"')
    length: PositiveLength = Field(description='a length such as "300 mm"')
    axis: Axis = "z"


class Specimen(WithOwnTable):
    """Body of material: a box in ``[0, size]``, an extruded outline, a cylinder, a mesh, or a shape by its name."""

    registry: ClassVar = SHAPES

    shape: Annotated[str, NameIn(SHAPES, "")] = Field(default="", description="the name of a shape")
    unit: None = Field(default=None, exclude=True, description=UNIT)
    size: Size | None = Field(default=None, description=_BOX)
    outline: Outline | None = Field(default=None, description="a list of corners [x, y]")
    names: tuple[NewSurface, ...] | None = Field(default=None, description="a list of names, one for each side")
    thickness: PositiveLength | None = Field(default=None, description='a length such as "100 mm"')
    cylinder: Cylinder | None = Field(default=None, description="a table with diameter and length")
    mesh: File | None = Field(default=None, description="a file with tetrahedra")
    scale: StepLength = Field(default=1.0, description="length of the mesh's unit in m; unit gives it")

    @model_validator(mode="before")
    @classmethod
    def _in_unit(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and "mesh" in data and "unit" in data and "scale" not in data:
            data = {**data, "scale": 1.0}
        return in_unit(data, "size", "outline", "thickness", "cylinder", "scale")

    @classmethod
    def named_in(cls, data: Mapping[str, Any]) -> str | None:
        """Name of a shape that has a table of its own."""
        name = super().named_in(data) or data.get("shape")
        if isinstance(name, str) and name in data and data.get("unit") is not None:
            fail(f"does not reach into the table {name}", 'a unit for each length there, such as "5 mm"', "unit")
        return None if name in _SHAPES else name

    @property
    def key(self) -> str:
        """The key that gives its dimensions."""
        return f"specimen.{_KEYS.get(self.shape, self.shape)}"

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> Self:
        kinds = {"box": self.size, "outline": self.outline, "cylinder": self.cylinder, "mesh": self.mesh}
        given = [kind for kind, value in kinds.items() if value is not None]
        given += [] if self.own_name is None else [self.own_name]
        elsewhere = not (info.context or {}).get("files_exist", True) and self.shape not in (*kinds, "")
        if not given and elsewhere:
            return self  # a case that was run where the shape is known, and is only looked at here
        if not given:
            fail("missing", f"{_BOX}; or instead of it outline and thickness, cylinder, or mesh", "size")
        if len(given) > 1:
            first, second = (_KEYS.get(kind, kind) for kind in given[:2])
            fail(f"is given together with {first}", "one of size, outline, cylinder, mesh", second)
        kind = given[0]
        if self.shape and self.shape != kind:
            fail(f"{show(self.shape)} goes with {_KEYS.get(self.shape, self.shape)}", f'"{kind}", or nothing', "shape")
        self.__dict__["shape"] = kind
        for key in ("names", "thickness"):
            if getattr(self, key) is not None and kind != "outline":
                fail("is given without outline", "only with outline", key)
        if kind == "outline":
            if self.thickness is None:
                fail("missing", 'a length such as "100 mm": the outline is extruded by it along z', "thickness")
            _check_names(self.outline or (), self.names)
        return self

    @property
    def largest(self) -> float | None:
        """Largest dimension [m]; None where only a file knows it."""
        if self.size is not None:
            return max(self.size)
        if self.outline is not None and self.thickness is not None:
            across = (max(c.to[a] for c in self.outline) - min(c.to[a] for c in self.outline) for a in range(2))
            return max(*across, self.thickness)
        return None if self.cylinder is None else max(self.cylinder.diameter, self.cylinder.length)


def _check_names(outline: tuple[Corner, ...], names: tuple[str, ...] | None) -> None:
    if names is not None and len(names) != len(outline):
        fail(
            f"the list has {len(names)} entries, the outline {len(outline)} sides",
            "one name for each side, that from the first corner to the second first",
            "names",
        )


class Block(Part):
    """Box-shaped void, its sides along the axes."""

    lower: Point = Field(description="three lengths")
    upper: Point = Field(description="three lengths")

    @model_validator(mode="after")
    def _lower_below_upper(self) -> Self:
        require_volume(self.lower, self.upper)
        return self


class Bore(Part):
    """Round hole: through everything along an axis, or from one point to another."""

    diameter: PositiveLength = Field(description='a length such as "60 mm"')
    through: Point | None = Field(default=None, description="three lengths, a point of its axis")
    axis: Axis | None = Field(default=None, description='"x", "y" or "z"')
    start: Point | None = Field(default=None, description="three lengths, the middle of one end")
    end: Point | None = Field(default=None, description="three lengths, the middle of the other end")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.through is not None:
            self._refuse_beside("through", ("start", "end"), "through and axis, or start and end")
            if self.axis is None:
                self.__dict__["axis"] = "z"
        else:
            if self.axis is not None:
                fail("is given without through", "through and axis, or start and end", "axis")
            for key in ("start", "end"):
                if getattr(self, key) is None:
                    missing = "through" if self.start is None and self.end is None else key
                    fail("missing", "three lengths: through = a point of the axis, or start and end", missing)
            if self.start is not None and self.end is not None and math.dist(self.start, self.end) == 0.0:
                fail("is the same as start", "another point", "end")
        return self


class Prism(Part):
    """Prism-shaped void: an outline across an axis, through everything or between two coordinates."""

    corners: Outline = Field(description="a list of corners, the two coordinates across the axis")
    axis: Axis = "z"
    lower: Length | None = Field(default=None, description="a length: where it begins along the axis")
    upper: Length | None = Field(default=None, description="a length: where it ends along the axis")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.lower is not None and self.upper is not None and self.lower >= self.upper:
            fail(f"{self.upper:g} m is not above lower", f"more than {self.lower:g} m", "upper")
        return self


@accepting(lambda inner: {"anyOf": [{"type": "array", "items": {"anyOf": [_CORNER, {"type": "object"}]}}, inner]})
def _prism(value: Any) -> Any:
    """Take a list of corners as an outline along z through everything."""
    return {"corners": value} if isinstance(listed(value), list) else value


class Void(Part):
    """What is taken away from the specimen."""

    name: NewSurface = "hole"
    unit: None = Field(default=None, exclude=True, description=UNIT)
    box: Block | None = Field(default=None, description="a table with lower and upper")
    cylinder: Bore | None = Field(default=None, description="a table with diameter, and through, or start and end")
    outline: Annotated[Prism, BeforeValidator(_prism)] | None = Field(
        default=None, description="a list of corners, or a table with corners, axis, lower, upper"
    )

    @model_validator(mode="before")
    @classmethod
    def _in_unit(cls, data: Any) -> Any:
        return in_unit(data, "box", "cylinder", "outline")

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = ("box", "cylinder", "outline")
        if not self._at_most_one(kinds, "one of box, cylinder, outline in each table"):
            fail("missing", "a table; or cylinder, or outline", "box")
        return self


Voids = Annotated[tuple[Void, ...], BeforeValidator(as_tuple)]
