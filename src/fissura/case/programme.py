"""Loading programmes as a case file writes them: gravity, control, stages; see `stages.py` for what follows."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from fissura.case.accepted import NUMBER_WITH_UNIT, accepting, one_or_list
from fissura.case.part import Part
from fissura.case.ranges import ACCELERATIONS, COORDINATES, DENSITIES, FORCES, POSITIVE, derived, number_of, quantity
from fissura.case.report import fail
from fissura.case.types import Direction, Flag, Fraction, Iterations, Share, StepLength, Target, Tolerance, listed
from fissura.case.units import ACCELERATION, DENSITY, FORCE, LENGTH, NUMBER, show

GRAVITY = "gravity"
"""Name of the load that is the specimen's own weight."""

#: Targets relative to a load: that at which the way to the target begins, or the largest one so far.
_RELATIVE = re.compile(r"\s*([+-]?[0-9.]+)\s*%\s+of\s+(load|peak)\s*")

#: Steps of a way that a force leads, at least, and what is left of the first step when a run is given up.
_FORCE_STEPS, _LEAST_FORCE = 20, 1e-4

#: Most targets of a stage.
_MOST_TARGETS = 1000


class Gravity(Part):
    """The specimen's own weight, applied before anything else and kept."""

    density: Annotated[float, BeforeValidator(quantity(DENSITY, DENSITIES))] = Field(
        description='a density such as "2400 kg/m^3"'
    )
    direction: Direction = Field(default=(0.0, -1.0, 0.0), description="three numbers")
    acceleration: Annotated[float, BeforeValidator(quantity(ACCELERATION, ACCELERATIONS))] = 9.81


class Control(Part):
    """How far and in what steps the specimen is deformed, where one load does it in one go."""

    type: Literal["gauge", "displacement", "dissipation"] = "gauge"
    target: Target = Field(description='a length such as "0.1 mm"')
    max_step: StepLength = Field(default_factory=derived(lambda target: target / 50, "target"))
    first_step: StepLength = Field(
        default_factory=derived(lambda target, step: min(target / 200, step), "target", "max_step")
    )
    min_step: StepLength = Field(
        default_factory=derived(lambda target, step: min(target / 1e5, step), "target", "first_step")
    )
    energy_step: Fraction = Field(
        default_factory=derived(lambda target, step: min(step / target, 1.0), "target", "max_step")
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
        _check_steps(self.max_step, self.first_step, self.min_step, self.target, "target", "m")
        return self


def _check_steps(longest: float, first: float, least: float, span: float, name: str, unit: str) -> None:
    """Refuse steps in the wrong order, more of them than anyone waits for, and ones that round-off swallows."""
    if first > longest:
        fail(f"{first:g} {unit} is larger than max_step", f"at most {longest:g} {unit}", "first_step")
    if least > first:
        fail(f"{least:g} {unit} is larger than first_step", f"at most {first:g} {unit}", "min_step")
    for key, value, share in (("max_step", longest, 1e-6), ("min_step", least, 1e-12)):
        if value < share * span * (1 - 1e-9):
            problem = f"{value:g} {unit} is less than {share:g} of {name} = {span:g} {unit}"
            fail(problem, f"at least {share * span:g} {unit}", key)


@dataclass(frozen=True)
class StageTarget:
    """Where a way of a stage ends.

    Attributes
    ----------
    value : float
        Value of the controlled quantity [m or N], or a share of a load.
    of : str
        Of which load it is a share: of that where the way begins, "load", or of the largest one so far, "peak"; empty
        for a value.
    """

    value: float
    of: Literal["", "load", "peak"] = ""


@accepting(one_or_list)
def _as_list(value: Any) -> Any:
    found = listed(value)
    return found if isinstance(found, list) else [found]


class Stage(Part):
    """A part of a loading programme: a load, or several in fixed ratio, taken to one target after another."""

    load: str | dict[str, float] | None = Field(
        default=None, description="the name of a load, or ratios by name such as { left = 0.5, right = 0.5 }"
    )
    control: Literal["gauge", "displacement", "force", "dissipation"] = "gauge"
    gauge: str | None = Field(default=None, description="the name of a gauge")
    to: Annotated[tuple[float | str, ...], BeforeValidator(_as_list)] = Field(
        description='a target such as "20 um", or a list of them'
    )
    max_step: float | None = None
    first_step: float | None = None
    min_step: float | None = None
    energy_step: Fraction | None = None
    tolerance: Tolerance = 1e-4
    max_iterations: Iterations = 30
    switch: Flag = True
    stop_load: Share = Field(default_factory=derived(lambda kind: 0.05 if kind == "dissipation" else 0.0, "control"))

    @field_validator("load", mode="before")
    @classmethod
    @accepting(lambda _: {"anyOf": [{"type": "string"}, {"type": "object", "additionalProperties": NUMBER_WITH_UNIT}]})
    def _names_or_ratios(cls, value: Any) -> Any:
        allowed = "the name of a load, or ratios by name such as { left = 0.5, right = 0.5 }"
        if value is None or isinstance(value, str):
            return value
        if not isinstance(value, Mapping) or not value:
            fail(f"{show(value)} is neither a name nor a table", allowed)
        found = {}
        for name, ratio in value.items():
            found[str(name)] = number_of(ratio, NUMBER, "a number", key=(str(name),))
            if not 1e-6 <= abs(found[str(name)]) <= 1e6:
                fail(
                    f"{show(ratio)} is no ratio of loads", "a number, 1e-6 to 1e6 or the negative of one", (str(name),)
                )
        return found

    @field_validator("to", mode="before")
    @classmethod
    def _targets(cls, value: Any, info: ValidationInfo) -> list[float | str]:
        kind = info.data.get("control", "gauge")
        dimension, within = (FORCE, FORCES) if kind == "force" else (LENGTH, COORDINATES)
        found: list[float | str] = []
        items = _as_list(value)
        if not items:
            fail("the list is empty", 'a target such as "20 um", or a list of them')
        if len(items) > _MOST_TARGETS:
            fail(f"the list has {len(items)} entries", f"at most {_MOST_TARGETS}")
        where: tuple[int, ...]
        for k, item in enumerate(items):
            where = (k,) if len(items) > 1 else ()
            if isinstance(item, str) and "%" in item:
                if not (match := _RELATIVE.fullmatch(item)) or not _is_share(match[1]):
                    fail(f"{show(item)} is not clear", 'a share such as "5 % of load" or "50 % of peak"', where)
                found.append(f"{float(match[1]):g} % of {match[2]}")
                continue
            allowed = f'{dimension.allowed}, {within.text}, or a share of a load such as "5 % of load"'
            number = number_of(item, dimension, allowed, within, key=where)
            if found and found[-1] == number:
                fail(f"{show(item)} is the target before it, too", "a target that differs from the one before", where)
            found.append(number)
        return found

    @field_validator("max_step", "first_step", "min_step", mode="before")
    @classmethod
    @accepting(lambda _: {**NUMBER_WITH_UNIT, "description": 'a length such as "2 um", or under force a force'})
    def _step(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        kind = info.data.get("control", "gauge")
        return quantity(FORCE if kind == "force" else LENGTH, POSITIVE)(value)

    @property
    def targets(self) -> tuple[StageTarget, ...]:
        """The targets, shares told apart from values."""
        return tuple(_target(item) for item in self.to)

    @property
    def span(self) -> float:
        """The longest way between two values in `to`, the first one from zero; 0 where there is none [m or N]."""
        values = [0.0, *(target.value for target in self.targets if not target.of)]
        return max((abs(b - a) for a, b in pairwise(values)), default=0.0)

    @model_validator(mode="after")
    def _steps_in_order(self) -> Self:
        unit = "N" if self.control == "force" else "m"
        span = self.span
        longest, first, least = self.steps
        if span == 0.0:
            given = [key for key in ("max_step", "first_step", "min_step") if getattr(self, key) is not None]
            if given and all(target.of for target in self.targets):
                fail(
                    "is given, but no target is a value",
                    "none: ways to shares of a load have steps of their own",
                    given[0],
                )
            if given:
                _check_steps(longest or first, first, least, longest or first, "max_step", unit)
            return self
        if longest > span * (1 + 1e-9):
            fail(
                f"{longest:g} {unit} is more than the longest way, {span:g} {unit}",
                f"at most {span:g} {unit}",
                "max_step",
            )
        _check_steps(longest, first, least, span, "the longest way", unit)
        return self

    @property
    def steps(self) -> tuple[float, float, float]:
        """Longest, first and smallest step on ways between values; 0 where there is none, but zero [m or N]."""
        force, span = self.control == "force", self.span
        longest = self.max_step or span / (_FORCE_STEPS if force else 50)
        first = self.first_step or (min(span / (_FORCE_STEPS if force else 200), longest) if span else longest)
        return longest, first, self.min_step or min(span / 1e5 if span and not force else _LEAST_FORCE * first, first)


def _is_share(text: str) -> bool:
    try:
        return -1e4 <= float(text) <= 1e4
    except ValueError:
        return False


def _target(item: float | str) -> StageTarget:
    if not isinstance(item, str):
        return StageTarget(item)
    match = _RELATIVE.fullmatch(item)
    assert match is not None
    return StageTarget(float(match[1]) / 100.0, "load" if match[2] == "load" else "peak")
