"""The parts of a case: what a case file may say, validated, in SI units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Generic, Literal, Self, TypeVar

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from fissura.case.adaptivity import Adaptivity
from fissura.case.ensemble import Ensemble
from fissura.case.field import Field as RandomField
from fissura.case.material import Macro, Material
from fissura.case.materials import MaterialRegion
from fissura.case.own_table import WithOwnTable
from fissura.case.part import Part
from fissura.case.place import Notch, Patch
from fissura.case.platen import PlatenOfLoad, PlatenOfSupport
from fissura.case.programme import GRAVITY, Control, Gravity, Stage
from fissura.case.ranges import LONGEST, unless
from fissura.case.region import BallRegion, BoxRegion
from fissura.case.registry import GAUGES, SOLVERS, SUPPORTS, NameIn
from fissura.case.shape import Specimen, Voids
from fissura.case.stages import LoadingStage, resolved_stages
from fissura.case.types import (
    Count,
    Direction,
    Duration,
    File,
    PositiveLength,
    Thousands,
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
    "Ensemble",
    "Gauge",
    "Gravity",
    "Load",
    "LoadingStage",
    "Macro",
    "Material",
    "MaterialRegion",
    "Notch",
    "Output",
    "Part",
    "Patch",
    "Quantity",
    "Specimen",
    "Stage",
    "Support",
]

P = TypeVar("P", bound=Part)

#: Names of loads and gauges, and how many of each there may be.
_NAME, _MOST_NAMES = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}"), 50

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

    type: Annotated[str, NameIn(SUPPORTS)]
    platen: PlatenOfSupport = None


class Load(Patch):
    """Patch of the surface that is loaded; direction None: into the specimen."""

    direction: Direction | None = Field(default=None, description="three numbers")
    platen: PlatenOfLoad = None


_PLACE = 'a place such as { face = "bottom", at = "%s" }'


class Gauge(WithOwnTable):
    """Mean displacement of patch b minus that of patch a; direction None: from a to b. Other kinds have own tables."""

    registry: ClassVar = GAUGES

    a: Patch | None = Field(default=None, description=_PLACE % "170 mm")
    b: Patch | None = Field(default=None, description=_PLACE % "180 mm")
    direction: Direction | None = Field(default=None, description="three numbers")

    @property
    def kind(self) -> str:
        """Name of what it measures."""
        return self.own_name or "opening"

    @model_validator(mode="after")
    def _places(self) -> Self:
        for key in ("a", "b", "direction"):
            given = getattr(self, key) is not None
            if self.own_name and given:
                fail(f"is given together with {self.own_name}", f"either a and b, or {self.own_name}", key)
            if not (self.own_name or given or key == "direction"):
                fail("missing", f"{type(self).model_fields[key].description}", key)
        return self


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


class Solver(Part):
    """How linear equations are solved."""

    linear: Annotated[str, NameIn(SOLVERS, "auto")] = "auto"
    threads: Thousands = 0


class Output(Part):
    """What a run writes besides its curve and summary, and how often it saves how to go on."""

    vtk: Thousands = 5
    measured: File | None = None
    checkpoint: Duration = 30.0


@dataclass(frozen=True)
class Named(Generic[P]):
    """A load or a gauge with its name.

    Attributes
    ----------
    name : str
        Its name in stages and results.
    key : str
        Where the case has it, for messages.
    part : Load or Gauge
        The table.
    """

    name: str
    key: str
    part: P


def _named(name: str, one: P | None, many: Mapping[str, P]) -> tuple[Named[P], ...]:
    first = () if one is None else (Named(name, name, one),)
    return (*first, *(Named(key, f"{name}s.{key}", part) for key, part in many.items()))


class Case(Part):
    """A whole case: specimen, conditions, material, discretization and control.

    Quantities are SI numbers; every default that depends on other keys is resolved. Attributes are the keys of a case
    file (docs/case-file.md); a case is frozen, and `with_` makes another one.

    Attributes
    ----------
    name : str
        Name of the case, and of its folder of results.
    seed : int
        Seed of the random structure.
    specimen, minus, notch
        Shape of the specimen, what is taken away from it, and notches.
    supports, load, loads, gravity
        What holds it; the load, loads by name, and its weight.
    gauge, gauges
        The gauge, and gauges by name.
    control, stage
        How far it is loaded; or stages, one after another.
    material, materials, field, ensemble
        Constants of the contacts, those of regions, the random field, and what differs in an ensemble.
    discretization, adaptivity
        Sizes of bodies, and how the run refines itself.
    solver, output
        How equations are solved, and what is written.

    Examples
    --------
    >>> case.material.f_t
    2200000.0
    >>> case.supports[0].type
    'pin'
    """

    name: str = "case"
    seed: Count = 1
    specimen: Specimen = Field(description="a table [specimen] with size, outline, cylinder or mesh")
    minus: Annotated[Voids, at_most(100)] = ()
    notch: Annotated[tuple[Notch, ...], BeforeValidator(as_tuple), at_most(100)] = ()
    supports: Annotated[tuple[Support, ...], BeforeValidator(as_tuple), at_most(50)] = Field(
        description="at least one table [[supports]] with type, and face or on"
    )
    loads: dict[str, Load] = Field(default_factory=dict, description="tables [loads.NAME]")
    gravity: Gravity | None = None
    stage: Annotated[tuple[Stage, ...], BeforeValidator(as_tuple), at_most(100)] = ()
    load: Annotated[Load | None, unless("loads", "gravity")] = Field(
        default=None, description="a table [load] with face or on, or tables [loads.NAME]"
    )
    material: Material = Field(description="a table [material] with E, alpha, f_t, G_t")
    materials: Annotated[tuple[MaterialRegion, ...], BeforeValidator(as_tuple), at_most(1000)] = ()
    discretization: Discretization = Field(description="a table [discretization] with l_f")
    adaptivity: Adaptivity = Adaptivity()
    control: Annotated[Control | None, unless("stage")] = Field(
        default=None, description="a table [control] with target, or tables [[stage]] with to"
    )
    gauge: Gauge | None = None
    gauges: dict[str, Gauge] = Field(default_factory=dict, description="tables [gauges.NAME]")
    output: Output = Output()
    solver: Solver = Solver()
    field: RandomField | None = None
    ensemble: Ensemble | None = None

    @cached_property
    def source(self) -> str | None:
        """Text of the case file; None for a case that was not read from one."""
        return None  # `load_case` puts the text in its place

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy with other values at the top; `with_` also reaches into tables.

        The copy is validated, and defaults that were not given follow. The text of the case file stays with it.

        Parameters
        ----------
        update : mapping, optional
            New values by key, as a case file or a part of a case gives them.
        deep : bool, optional
            Whether parts that stay are copied, too.

        Returns
        -------
        Case
            The copy.

        Raises
        ------
        InputError
            A new value is wrong, or does not go with the others.

        Examples
        --------
        >>> case.model_copy(update={"seed": 7}).seed
        7
        """
        found = super().model_copy(update=update, deep=deep)
        if "source" in self.__dict__:
            found.__dict__["source"] = self.source
        return found

    def with_(self, changes: Mapping[str, Any]) -> Self:
        """Copy with other values by dotted key; defaults that were not given follow them.

        All changes are made together. A case read from a ``case.json`` has all its values given, so that none follows.

        Parameters
        ----------
        changes : mapping of str to value
            New values as a case file gives them. Entries of lists have an index; a table that is not there yet is
            made; None takes away what has no default. Files are relative to the working directory.

        Returns
        -------
        Case
            The other case; its text is still that of the case file.

        Raises
        ------
        InputError
            A key is not known, or a value is wrong or does not go with the others.

        Examples
        --------
        >>> stronger = case.with_({"material.f_t": "3 MPa", "supports[0].at": "11 mm"})
        >>> stronger.material.f_s / 1e6  # three times f_t, as before
        9.0
        """
        from fissura.case.changed import changed

        return changed(self, changes)

    def _given(self, update: Mapping[str, Any]) -> dict[str, Any]:
        given = super()._given(update)
        if "materials" in given:  # validation settles them with this copy's material, not with that of the first case
            given["materials"] = tuple(part.model_copy() for part in self.materials)
        return given

    @cached_property
    def resolved_materials(self) -> tuple[Material, ...]:
        """Materials of the regions in `materials`, with the constants that they share with `material`."""
        return tuple(part.resolved(self.material) for part in self.materials)

    @cached_property
    def named_loads(self) -> tuple[Named[Load], ...]:
        """All loads but gravity; that of the table ``[load]`` is called "load"."""
        return _named("load", self.load, self.loads)

    @cached_property
    def named_gauges(self) -> tuple[Named[Gauge], ...]:
        """All gauges; that of the table ``[gauge]`` is called "gauge"."""
        return _named("gauge", self.gauge, self.gauges)

    @property
    def load_names(self) -> list[str]:
        """Names of all loads, that of the weight last."""
        return [load.name for load in self.named_loads] + ([] if self.gravity is None else [GRAVITY])

    @property
    def held_names(self) -> list[str]:
        """Names in results of all that is held: the supports, then what guides the platens of loads."""
        guided = [f"platen_{load.name}" for load in self.named_loads if load.part.platen and load.part.platen.guided]
        return [*(f"support_{k}" for k in range(len(self.supports))), *guided]

    @cached_property
    def stages(self) -> tuple[LoadingStage, ...]:
        """What is done, one stage after another; the last one is the one that a run is told by."""
        gauges = [gauge.name for gauge in self.named_gauges]
        return resolved_stages(self.control, self.stage, self.load_names, gauges)

    @property
    def main(self) -> LoadingStage:
        """The last stage: load, gauge and displacement without a name of their own are those that it drives."""
        return self.stages[-1]

    @property
    def quantity(self) -> Quantity:
        """What the loads of the main stage are told over: the gauge, or the displacement of the load."""
        main = self.main
        if main.quantity == "force":
            return "displacement" if main.gauge is None else "gauge"
        return main.quantity

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

    @field_validator("loads", "gauges", mode="before")
    @classmethod
    def _names(cls, value: Any, info: ValidationInfo) -> Any:
        kind = f"{info.field_name}".removesuffix("s")
        tables = f"tables with names, such as [{kind}s.left]; one without a name is [{kind}]"
        if isinstance(value, list):
            fail("is a list of tables", tables)
        if not isinstance(value, dict):
            fail(f"{show(value)} is not a table", tables)
        if len(value) > _MOST_NAMES:
            fail(f"{len(value)} are given", f"at most {_MOST_NAMES}")
        for name in value:
            if not isinstance(name, str) or not _NAME.fullmatch(name):
                allowed = "a letter, then letters, digits, - and _, up to 40 of them"
                fail("is no name for a load or a gauge", allowed, (str(name),))
            if not isinstance(value[name], Mapping | Part):
                fail(f"{name} = {show(value[name])} stands where tables with names do", tables)
            if name == GRAVITY:
                fail("is the name of the specimen's own weight", "a table [gravity], or another name", (name,))
        return value

    @model_validator(mode="after")
    def _controlled(self) -> Self:
        for one, many in (("load", "loads"), ("gauge", "gauges")):
            if getattr(self, one) is not None and one in getattr(self, many):
                fail("has the name that the table without a name has", f"another name than {one}", (many, one))
        if self.control is not None and self.stage:
            fail("is given together with [[stage]]", "either a table [control], or tables [[stage]]", "control")
        _ = self.stages  # refuses names that are not known
        return self
