"""Loading programmes: what is driven, how far, and in what order."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from fissura.case.part import Part
from fissura.case.ranges import ACCELERATIONS, COORDINATES, DENSITIES, FORCES, POSITIVE, derived, quantity
from fissura.case.types import Direction, Flag, Fraction, Iterations, Share, StepLength, Target, Tolerance, fail, listed
from fissura.case.units import ACCELERATION, DENSITY, FORCE, LENGTH, NUMBER, show, to_si

__all__ = ["GRAVITY", "Control", "Gravity", "LoadingStage", "Stage", "StageTarget", "resolved_stages"]

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
    def _names_or_ratios(cls, value: Any) -> Any:
        allowed = "the name of a load, or ratios by name such as { left = 0.5, right = 0.5 }"
        if value is None or isinstance(value, str):
            return value
        if not isinstance(value, Mapping) or not value:
            fail(f"{show(value)} is neither a name nor a table", allowed)
        found = {}
        for name, ratio in value.items():
            try:
                found[str(name)] = to_si(ratio, NUMBER)
            except ValueError as error:
                fail(str(error), "a number", (str(name),))
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
            try:
                number = to_si(item, dimension)
            except ValueError as error:
                fail(str(error), allowed, where)
            if wrong := within.what_is_wrong(number):
                fail(f"{show(item)} is {wrong}", allowed, where)
            if found and found[-1] == number:
                fail(f"{show(item)} is the target before it, too", "a target that differs from the one before", where)
            found.append(number)
        return found

    @field_validator("max_step", "first_step", "min_step", mode="before")
    @classmethod
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


@dataclass(frozen=True)
class LoadingStage:
    """A stage with all that a case says elsewhere filled in.

    Attributes
    ----------
    key : str
        Where the case has it, for messages.
    ratios : tuple of (str, float)
        Names of the loads that are driven, with the force of each per unit of the load factor.
    quantity : str
        What is controlled: "gauge", "displacement" of the loads, or "force", the load factor itself.
    gauge : str or None
        Name of the gauge that is controlled or watched; None where there is none.
    energy : bool
        Whether dissipated energy leads as soon as it can.
    targets : tuple of StageTarget
        Where to go, one after another.
    span, max_step, first_step, min_step : float
        Longest way between values, and steps on such ways [m or N]; 0 where the way to a target is known only when it
        begins: to zero, or to shares alone.
    tolerance, max_iterations, switch, stop_load, energy_step
        As in the case; the last one None where it follows from the longest step and the longest way.
    """

    key: str
    ratios: tuple[tuple[str, float], ...]
    quantity: Literal["gauge", "displacement", "force"]
    gauge: str | None
    energy: bool
    targets: tuple[StageTarget, ...]
    span: float
    max_step: float
    first_step: float
    min_step: float
    tolerance: float = 1e-4
    max_iterations: int = 30
    switch: bool = True
    stop_load: float = 0.0
    energy_step: float | None = None

    @property
    def target(self) -> float:
        """The largest value among the targets [m or N]; nan where all are shares."""
        values = [target.value for target in self.targets if not target.of]
        return max(values, key=abs) if values else float("nan")

    @property
    def target_key(self) -> str:
        """The key that says how far."""
        return f"{self.key}.{'target' if self.key == 'control' else 'to'}"


def resolved_stages(
    control: Control | None, stages: Sequence[Stage], loads: Sequence[str], gauges: Sequence[str]
) -> tuple[LoadingStage, ...]:
    """Stages of a case.

    Parameters
    ----------
    control : Control or None
        The table ``[control]``: one stage.
    stages : sequence of Stage
        The tables ``[[stage]]``.
    loads, gauges : sequence of str
        Names of the loads and gauges that there are.

    Raises
    ------
    PydanticCustomError
        A name is not known or missing.
    """
    placed = [
        name for name in loads if name != GRAVITY
    ] or loads  # the weight leads only where it is asked to, or alone
    if control is not None:
        by_gauge = control.type == "gauge" or (control.type == "dissipation" and bool(gauges))
        if control.type == "gauge" and not gauges:
            problem = 'missing, but control.type is "gauge"'
            fail(problem, 'a table [gauge] with a and b, or control.type = "displacement"', "gauge")
        gauge = _only(gauges, "gauge")
        for names, key, clear in ((placed, "loads", len(placed) == 1), (gauges, "gauges", gauge or not by_gauge)):
            if not clear:
                fail(f"{len(names)} are given, and [control] does not say which one leads", "[[stage]] tables", key)
        return (
            LoadingStage(
                "control",
                ((placed[0], 1.0),),
                "gauge" if by_gauge else "displacement",
                gauge,
                control.type == "dissipation",
                (StageTarget(control.target),),
                control.target,
                control.max_step,
                control.first_step,
                control.min_step,
                control.tolerance,
                control.max_iterations,
                control.switch,
                control.stop_load,
                control.energy_step,
            ),
        )
    begin = stages[0].targets[0]
    if begin.of:
        fail("begins with a share of a load, and there is none yet", "a value first", ("stage", 0, "to"))
    if begin.value == 0.0 and GRAVITY not in loads:
        fail("begins with zero, where the specimen is already", "another value first", ("stage", 0, "to"))
    resolved = tuple(_resolved(stage, k, loads, placed, gauges) for k, stage in enumerate(stages))
    for k, stage in enumerate(resolved):
        if stage.targets[0].of and not _loaded(stage, resolved[:k]):
            names = ", ".join(name for name, _ in stage.ratios)
            problem = f"begins with a share of a load that is zero there: no stage before drives {names}"
            fail(f"{problem}{' in these ratios' * (len(stage.ratios) > 1)}", "a value first", ("stage", k, "to"))
    return resolved


def _loaded(stage: LoadingStage, before: Sequence[LoadingStage]) -> bool:
    """Whether the load factor of a stage need not be zero where it begins."""
    own = dict(stage.ratios)
    if len(own) == 1:
        return GRAVITY in own or any(own.keys() & dict(one.ratios).keys() for one in before)
    latest = next((dict(one.ratios) for one in reversed(before) if own.keys() & dict(one.ratios).keys()), {})
    return latest.keys() == own.keys() and len({round(latest[name] / own[name], 9) for name in own}) == 1


def _only(names: Sequence[str], unnamed: str) -> str | None:
    """The one that is meant where none is named: that of the table without a name, or the only one."""
    return unnamed if unnamed in names else names[0] if len(names) == 1 else None


def _resolved(stage: Stage, k: int, loads: Sequence[str], placed: Sequence[str], gauges: Sequence[str]) -> LoadingStage:
    """One stage; its number is that among the tables ``[[stage]]``."""
    if stage.load is None and len(placed) > 1:
        fail(
            "missing, and there are several loads",
            f"one of {', '.join(loads)}, or ratios by name",
            ("stage", k, "load"),
        )
    given = stage.load if stage.load is not None else placed[0]
    ratios = {given: 1.0} if isinstance(given, str) else given
    for name in ratios:
        if name not in loads:
            why, more = (", since there is no [gravity]", " or a table [gravity]") if name == GRAVITY else ("", "")
            fail(f"{show(name)} is no load{why}", f"one of {', '.join(loads)}{more}", ("stage", k, "load"))
    if stage.gauge is not None and stage.gauge not in gauges:
        fail(
            f"{show(stage.gauge)} is no gauge",
            f"one of {', '.join(gauges)}" if gauges else "a table [gauges.NAME]",
            ("stage", k, "gauge"),
        )
    gauge = stage.gauge or _only(gauges, "gauge")
    if stage.control == "gauge" and gauge is None:
        allowed = f"one of {', '.join(gauges)}" if gauges else 'a table [gauge], or control = "displacement" or "force"'
        fail('missing, but control is "gauge"', allowed, ("stage", k, "gauge"))
    quantity_: Literal["gauge", "displacement", "force"]
    if stage.control == "force":
        quantity_ = "force"
    else:
        quantity_ = "displacement" if stage.control == "displacement" or gauge is None else "gauge"
    return LoadingStage(
        f"stage[{k}]",
        tuple(ratios.items()),
        quantity_,
        gauge,
        stage.control == "dissipation",
        stage.targets,
        stage.span,
        *stage.steps,
        stage.tolerance,
        stage.max_iterations,
        stage.switch and stage.control != "force",
        stage.stop_load,
        stage.energy_step,
    )
