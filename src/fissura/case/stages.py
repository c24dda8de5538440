"""Stages of a loading programme with all that a case says elsewhere filled in: names, defaults, the table [control]."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from fissura.case.programme import GRAVITY, Control, Stage, StageTarget
from fissura.case.report import fail
from fissura.case.units import show

Quantity = Literal["gauge", "displacement"]
"""What may be controlled: the gauge, or the displacement of the load."""


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
    # The weight leads only where it is asked to, or alone.
    placed = [name for name in loads if name != GRAVITY] or loads
    if control is not None:
        return (_of_control(control, placed, gauges),)
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


def _of_control(control: Control, placed: Sequence[str], gauges: Sequence[str]) -> LoadingStage:
    """The stage of the table ``[control]``."""
    by_gauge = control.type == "gauge" or (control.type == "dissipation" and bool(gauges))
    if control.type == "gauge" and not gauges:
        problem = 'missing, but control.type is "gauge"'
        fail(problem, 'a table [gauge] with a and b, or control.type = "displacement"', "gauge")
    gauge = _only(gauges, "gauge")
    for names, key, clear in ((placed, "loads", len(placed) == 1), (gauges, "gauges", gauge or not by_gauge)):
        if not clear:
            fail(f"{len(names)} are given, and [control] does not say which one it applies", "[[stage]] tables", key)
    return LoadingStage(
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
    )


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
