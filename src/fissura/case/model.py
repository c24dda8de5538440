"""The parts of a case: what a case file may say, validated, in SI units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from fissura.case.adaptivity import Adaptivity
from fissura.case.field import Field as RandomField
from fissura.case.material import Macro, Material
from fissura.case.materials import MaterialRegion
from fissura.case.part import Part
from fissura.case.place import Notch, Patch
from fissura.case.ranges import LONGEST
from fissura.case.region import BallRegion, BoxRegion
from fissura.case.shape import Specimen, Voids
from fissura.case.types import (
    Count,
    Direction,
    File,
    Flag,
    Iterations,
    PositiveLength,
    Share,
    StepLength,
    Target,
    Thousands,
    Tolerance,
    as_tuple,
    at_most,
    derived,
    fail,
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
    "MaterialRegion",
    "Notch",
    "Output",
    "Part",
    "Patch",
    "Quantity",
    "Specimen",
    "Support",
]

Quantity = Literal["gauge", "displacement"]
"""What may be controlled: the gauge, or the displacement of the load."""

#: What names of folders cannot hold: signs of paths and shells, control characters, bytes that are not UTF-8.
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f\x7f-\x9f<>:"/\\|?*\u2028\u2029\ud800-\udfff]')

#: Longest name of a folder, in characters and, since file systems count these, in bytes.
_LONGEST_NAME, _LONGEST_BYTES = 100, 240


def folder_name(text: str) -> str:
    """The nearest text that can name a folder on any machine; the same if it can."""
    clean = _NOT_IN_NAMES.sub("_", text)[:_LONGEST_NAME]
    clean = clean.encode()[:_LONGEST_BYTES].decode(errors="ignore")
    return clean if clean.strip(". ") else "case"


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


class Discretization(Part):
    """Spacing of the nuclei."""

    l_f: PositiveLength = Field(description='a length such as "10 mm"')
    l_c: PositiveLength = Field(default_factory=derived(lambda l_f: min(4.0 * l_f, LONGEST), "l_f"))
    nuclei: File | None = None

    @model_validator(mode="after")
    def _fine_below_coarse(self) -> Self:
        if self.l_f > self.l_c:
            fail(f"{self.l_f:g} m is larger than l_c = {self.l_c:g} m", "l_f at most l_c", "l_f")
        return self


class Control(Part):
    """How far and in what steps the specimen is deformed."""

    type: Literal["gauge", "displacement", "dissipation"] = "gauge"
    target: Target = Field(description='a length such as "0.1 mm"')
    max_step: StepLength = Field(default_factory=derived(lambda target: target / 50, "target"))
    first_step: StepLength = Field(
        default_factory=derived(lambda target, step: min(target / 200, step), "target", "max_step")
    )
    min_step: StepLength = Field(
        default_factory=derived(lambda target, step: min(target / 1e5, step), "target", "first_step")
    )
    tolerance: Tolerance = 1e-4
    max_iterations: Iterations = 30
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
        # More steps than anyone waits for, and steps that round-off would swallow.
        for key, share in (("max_step", 1e-6), ("min_step", 1e-12)):
            if getattr(self, key) < share * self.target * (1 - 1e-9):
                problem = f"{getattr(self, key):g} m is less than {share:g} of target = {self.target:g} m"
                fail(problem, f"at least {share * self.target:g} m", key)
        return self


class Solver(Part):
    """How linear equations are solved."""

    linear: Literal["auto", "direct", "two-level", "amg"] = "auto"
    threads: Thousands = 0


class Output(Part):
    """What a run writes besides its curve and summary."""

    vtk: Thousands = 5
    measured: File | None = None


class Case(Part):
    """A whole case: specimen, conditions, material, discretization and control.

    Quantities are SI numbers; every default that depends on other keys is resolved.
    """

    name: str = "case"
    seed: Count = 1
    specimen: Specimen = Field(description="a table [specimen] with size, outline, cylinder or mesh")
    minus: Annotated[Voids, at_most(100)] = ()
    notch: Annotated[tuple[Notch, ...], BeforeValidator(as_tuple), at_most(100)] = ()
    supports: Annotated[tuple[Support, ...], BeforeValidator(as_tuple), at_most(50)] = Field(
        description="at least one table [[supports]] with type, and face or on"
    )
    load: Load = Field(description="a table [load] with face or on")
    material: Material = Field(description="a table [material] with E, alpha, f_t, G_t")
    materials: Annotated[tuple[MaterialRegion, ...], BeforeValidator(as_tuple), at_most(1000)] = ()
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

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy with other values, see :meth:`Part.model_copy`; the text of the case file stays with it."""
        found = super().model_copy(update=update, deep=deep)
        if "source" in self.__dict__:
            found.__dict__["source"] = self.source
        return found

    @cached_property
    def resolved_materials(self) -> tuple[Material, ...]:
        """Materials of the regions in `materials`, with the constants that they share with `material`."""
        return tuple(part.resolved(self.material) for part in self.materials)

    @property
    def quantity(self) -> Quantity:
        """The controlled quantity: the gauge, or the displacement of the load."""
        if self.control.type == "dissipation":
            return "displacement" if self.gauge is None else "gauge"
        return self.control.type

    @field_validator("name")
    @classmethod
    def _name_of_a_folder(cls, value: str) -> str:
        if value != folder_name(value):
            fail(f"{show(value)} cannot name a folder", 'up to 100 characters, none of < > : " / \\ | ? *')
        return value

    @field_validator("supports")
    @classmethod
    def _held(cls, value: tuple[Support, ...]) -> tuple[Support, ...]:
        if not value:
            fail("the list is empty", "at least one table [[supports]] with type, and face or on")
        return value

    @field_validator("adaptivity")
    @classmethod
    def _radii(cls, value: Adaptivity, info: ValidationInfo) -> Adaptivity:
        spacing = info.data.get("discretization")
        # A spacing that is itself wrong is reported so.
        return value if spacing is None else value.resolved(spacing.l_f, spacing.l_c)

    @model_validator(mode="after")
    def _materials_resolved(self) -> Self:
        for k, part in enumerate(self.materials):
            part.settle(self.material, f"materials[{k}]")
        return self

    @model_validator(mode="after")
    def _controlled(self) -> Self:
        if self.gauge is None and self.control.type == "gauge":
            fail(
                'missing, but control.type is "gauge"',
                'a table [gauge] with a and b, or control.type = "displacement"',
                "gauge",
            )
        return self
