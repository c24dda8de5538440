"""How a case is computed, and what a run of it writes: spacing of nuclei, solver, output."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from fissura.case.named import NameIn
from fissura.case.part import Part
from fissura.case.ranges import LONGEST, derived
from fissura.case.registry import SOLVERS
from fissura.case.report import fail
from fissura.case.types import Duration, File, PositiveLength, Thousands


class Discretization(Part):
    """Spacing of the nuclei."""

    l_f: PositiveLength = Field(description='a length such as "10 mm"')
    l_c: PositiveLength = Field(default_factory=derived(lambda l_f: min(4.0 * l_f, LONGEST), "l_f"))
    nuclei: File | None = None
    placement: Literal["saturated", "blocks"] = "saturated"

    @model_validator(mode="after")
    def _fine_below_coarse(self) -> Self:
        if self.l_f > self.l_c:
            fail(f"{self.l_f:g} m is larger than l_c = {self.l_c:g} m", "l_f at most l_c", "l_f")
        return self

    @model_validator(mode="after")
    def _given_to_one_placement(self) -> Self:
        if self.nuclei is not None and self.placement == "blocks":
            fail('a file of nuclei needs placement = "saturated"', "no nuclei from a file in blocks", "nuclei")
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
