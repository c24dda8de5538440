"""The parts of a case: what a case file may say, validated, in SI units."""

from __future__ import annotations

import math
import re
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from fissura.bulk import bulk_law
from fissura.case.field import Field as RandomField
from fissura.case.part import Part
from fissura.case.types import (
    Axis,
    Count,
    Direction,
    Factor,
    File,
    Flag,
    Fraction,
    Length,
    Point,
    PoissonRatio,
    PositiveCount,
    PositiveEnergyPerArea,
    PositiveLength,
    PositiveStress,
    Share,
    Size,
    Thickness,
    Tolerance,
    as_tuple,
    derived,
    fail,
    instead,
)
from fissura.case.units import show

__all__ = [
    "Adaptivity",
    "BallRegion",
    "BoxRegion",
    "Case",
    "Control",
    "Discretization",
    "Gauge",
    "Load",
    "Macro",
    "Material",
    "Notch",
    "Output",
    "Part",
    "Patch",
    "Specimen",
    "Support",
]

#: Axis along which positions on a face are given unless the case says otherwise.
FACE_AXIS: dict[str, Axis] = {"left": "y", "right": "y"}


def _axis_of_face(data: dict[str, Any]) -> Axis:
    return FACE_AXIS.get(data.get("face", ""), "x")


class Specimen(Part):
    """Body of material; a box occupies ``[0, size]``."""

    shape: str = Field(default="box", description="the name of a shape")
    size: Size = Field(description='three lengths [length x, depth y, thickness z], each such as "50 mm"')


class Notch(Part):
    """Straight notch through the specimen, cut from a face inwards."""

    face: str = Field(default="bottom", description="the name of a face")
    normal: Axis = Field(default_factory=_axis_of_face, description='"x", "y" or "z"')
    position: Length = Field(description='a length such as "50 mm", the coordinate along normal')
    depth: PositiveLength = Field(description='a length such as "50 mm"')
    width: Thickness = Field(default=0.0, description="a length; zero for an ideal cut")


class Patch(Part):
    """Place on the surface: a whole face, a line or strip across it, or a point."""

    face: str = Field(description="the name of a face, such as bottom or top")
    at: Length | None = Field(default=None, description="a length, the coordinate on the face along `along`")
    along: Axis = Field(default_factory=_axis_of_face, description='"x", "y" or "z"')
    width: Thickness = Field(default=0.0, description="a length; zero for a line")
    point: Point | None = Field(default=None, description="three lengths")

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if self.at is not None and self.point is not None:
            fail("is given together with at", "either at or point, or neither for the whole face", "point")
        if self.width > 0 and self.at is None:
            fail("is given without at", "a width only with at: it is the width of the platen there", "width")
        return self


class Support(Patch):
    """Patch of the surface that is held."""

    type: Literal["pin", "roller", "clamp"] = Field(description='"pin", "roller" or "clamp"')


class Load(Patch):
    """Patch of the surface that is loaded; direction None: into the specimen."""

    direction: Direction | None = Field(default=None, description="three numbers")


class Gauge(Part):
    """Mean displacement of patch b minus that of patch a; direction None: from a to b."""

    a: Patch = Field(description='a place such as { face = "bottom", at = "170 mm" }')
    b: Patch = Field(description='a place such as { face = "bottom", at = "180 mm" }')
    direction: Direction | None = Field(default=None, description="three numbers")


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
        return self


class Discretization(Part):
    """Spacing of the nuclei."""

    l_f: PositiveLength = Field(description='a length such as "10 mm"')
    l_c: PositiveLength = Field(default_factory=derived(lambda l_f: 4.0 * l_f, "l_f"))
    nuclei: File | None = None

    @model_validator(mode="after")
    def _fine_below_coarse(self) -> Self:
        if self.l_f > self.l_c:
            fail(f"{self.l_f:g} m is larger than l_c = {self.l_c:g} m", "l_f at most l_c", "l_f")
        return self


class Adaptivity(Part):
    """When and where the discretization is refined; its radii are nan until a case resolves them."""

    criterion: str = Field(default="utilisation", description="the name of a criterion")
    gamma: Fraction = 0.75
    r_f: PositiveLength = Field(default=math.nan, validate_default=False)
    r_c: PositiveLength = Field(default=math.nan, validate_default=False)
    coarsen: Flag = False
    gamma_coarse: Fraction = 0.6
    r_w: PositiveLength = Field(default=math.nan, validate_default=False)
    notch_tips: Flag = True
    calibrate: Flag = True
    regions: Annotated[tuple[Region, ...], BeforeValidator(as_tuple)] = ()


class Control(Part):
    """How far and in what steps the specimen is deformed."""

    type: Literal["gauge", "displacement", "dissipation"] = "gauge"
    target: PositiveLength = Field(description='a length such as "0.1 mm"')
    max_step: PositiveLength = Field(default_factory=derived(lambda target: target / 50, "target"))
    first_step: PositiveLength = Field(
        default_factory=derived(lambda target, step: min(target / 200, step), "target", "max_step")
    )
    min_step: PositiveLength = Field(
        default_factory=derived(lambda target, step: min(target / 1e5, step), "target", "first_step")
    )
    tolerance: Tolerance = 1e-4
    max_iterations: PositiveCount = 30
    switch: Flag = True
    stop_load: Share = Field(default_factory=derived(lambda kind: 0.05 if kind == "dissipation" else 0.0, "type"))

    @model_validator(mode="after")
    def _steps_in_order(self) -> Self:
        limit = self.target / 50
        if self.max_step > limit * (1 + 1e-9):
            fail(f"{self.max_step:g} m is larger than target/50", f"at most {limit:g} m", "max_step")
        if self.first_step > self.max_step:
            fail(f"{self.first_step:g} m is larger than max_step", f"at most {self.max_step:g} m", "first_step")
        if self.min_step > self.first_step:
            fail(f"{self.min_step:g} m is larger than first_step", f"at most {self.first_step:g} m", "min_step")
        return self


class Solver(Part):
    """How linear equations are solved."""

    linear: Literal["auto", "direct", "two-level", "amg"] = "auto"
    threads: Count = 0


class Output(Part):
    """What a run writes besides its curve and summary."""

    vtk: Count = 5
    measured: File | None = None


class Case(Part):
    """A whole case: specimen, conditions, material, discretization and control.

    Quantities are SI numbers; every default that depends on other keys is resolved.
    """

    name: str = "case"
    seed: Count = 1
    specimen: Specimen = Field(description="a table [specimen] with size")
    notch: Annotated[tuple[Notch, ...], BeforeValidator(as_tuple)] = ()
    supports: Annotated[tuple[Support, ...], BeforeValidator(as_tuple)] = Field(
        description="at least one table [[supports]] with type and face"
    )
    load: Load = Field(description="a table [load] with face")
    material: Material = Field(description="a table [material] with E, alpha, f_t, G_t")
    discretization: Discretization = Field(description="a table [discretization] with l_f")
    adaptivity: Adaptivity = Adaptivity()
    control: Control = Field(description="a table [control] with target")
    gauge: Gauge | None = None
    output: Output = Output()
    solver: Solver = Solver()
    field: RandomField | None = None

    @cached_property
    def source(self) -> str | None:
        """Text of the case file; None for a case that was not read from one."""
        return None  # `load_case` puts the text in its place

    @property
    def quantity(self) -> Literal["gauge", "displacement"]:
        """The controlled quantity: the gauge, or the displacement of the load."""
        if self.control.type == "dissipation":
            return "displacement" if self.gauge is None else "gauge"
        return self.control.type

    @field_validator("name")
    @classmethod
    def _name_of_a_folder(cls, value: str) -> str:
        if not value.strip(". ") or len(value) > 100 or re.search(r'[\x00-\x1f<>:"/\\|?*]', value):
            fail(f"{show(value)} cannot name a folder", 'up to 100 characters, none of < > : " / \\ | ? *')
        return value

    @field_validator("supports")
    @classmethod
    def _held(cls, value: tuple[Support, ...]) -> tuple[Support, ...]:
        if not value:
            fail("the list is empty", "at least one table [[supports]] with type and face")
        return value

    @field_validator("adaptivity")
    @classmethod
    def _radii(cls, value: Adaptivity, info: ValidationInfo) -> Adaptivity:
        spacing = info.data.get("discretization")
        if spacing is None:  # itself wrong, and reported so
            return value
        r_f = 6.0 * spacing.l_f if math.isnan(value.r_f) else value.r_f
        r_c = r_f + 2.0 * spacing.l_c if math.isnan(value.r_c) else value.r_c
        if r_f > r_c:
            fail(f"{r_f:g} m is larger than r_c = {r_c:g} m", "r_f at most r_c", "r_f")
        r_w = 3.0 * spacing.l_f if math.isnan(value.r_w) else value.r_w
        return value.model_copy(update={"r_f": r_f, "r_c": r_c, "r_w": r_w})

    @model_validator(mode="after")
    def _controlled(self) -> Self:
        if self.gauge is None and self.control.type == "gauge":
            fail(
                'missing, but control.type is "gauge"',
                'a table [gauge] with a and b, or control.type = "displacement"',
                "gauge",
            )
        return self
