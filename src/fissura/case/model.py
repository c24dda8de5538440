"""A case as a whole: what a case file may say, validated, in SI units."""

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from fissura.case.adaptivity import Adaptivity
from fissura.case.changed import changed
from fissura.case.conditions import Gauge, Load, Named, Support, Tables, named
from fissura.case.ensemble import Ensemble
from fissura.case.field import Field as RandomField
from fissura.case.material import Material
from fissura.case.materials import MaterialRegion
from fissura.case.part import Part
from fissura.case.place import Notch
from fissura.case.programme import GRAVITY, Control, Gravity, Stage
from fissura.case.ranges import unless
from fissura.case.report import fail
from fissura.case.settings import Discretization, Output, Solver
from fissura.case.shape import Specimen, Voids
from fissura.case.stages import LoadingStage, Quantity, resolved_stages
from fissura.case.types import Count, as_tuple, at_most
from fissura.case.units import show
from fissura.files.folder import folder_name


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

    stays: ClassVar = ("source",)

    name: str = "case"
    seed: Count = 1
    specimen: Specimen = Field(description="a table [specimen] with size, outline, cylinder or mesh")
    minus: Annotated[Voids, at_most(100)] = ()
    notch: Annotated[tuple[Notch, ...], BeforeValidator(as_tuple), at_most(100)] = ()
    supports: Annotated[tuple[Support, ...], BeforeValidator(as_tuple), at_most(50)] = Field(
        description="at least one table [[supports]] with type, and face or on"
    )
    loads: Tables[Load] = Field(default_factory=dict, description="tables [loads.NAME]")
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
    gauges: Tables[Gauge] = Field(default_factory=dict, description="tables [gauges.NAME]")
    output: Output = Output()
    solver: Solver = Solver()
    field: RandomField | None = None
    ensemble: Ensemble | None = None

    @cached_property
    def source(self) -> str | None:
        """Text of the case file; None for a case that was not read from one."""
        return None  # `load_case` puts the text in its place

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
        return named("load", self.load, self.loads)

    @cached_property
    def named_gauges(self) -> tuple[Named[Gauge], ...]:
        """All gauges; that of the table ``[gauge]`` is called "gauge"."""
        return named("gauge", self.gauge, self.gauges)

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

    @model_validator(mode="after")
    def _controlled(self) -> Self:
        for one, many in (("load", "loads"), ("gauge", "gauges")):
            if getattr(self, one) is not None and one in getattr(self, many):
                fail("has the name that the table without a name has", f"another name than {one}", (many, one))
        if self.control is not None and self.stage:
            fail("is given together with [[stage]]", "either a table [control], or tables [[stage]]", "control")
        _ = self.stages  # refuses names that are not known
        return self
