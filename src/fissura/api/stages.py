"""The stages of a case, and its ensemble, in words, for `fissura check`."""

import math

from fissura.case import Case, LoadingStage
from fissura.case.points import points_of
from fissura.case.programme import GRAVITY
from fissura.text.quantities import counted, force
from fissura.text.quantities import energy as joules

#: Targets of a stage that are told one by one, at most.
_TOLD = 6

#: Steps on the way to a share of a load that unloads, and to one that does not or to zero.
_UNLOADING_STEPS, _STEPS = 10, 50


def stages_in_words(case: Case, energy: float) -> tuple[tuple[str, str], ...]:
    """Where the stages of a case end, and their steps.

    Parameters
    ----------
    case : Case
        The case.
    energy : float
        What it takes to break the specimen, roughly [J].

    Returns
    -------
    tuple of pairs of str
        For each stage what is controlled and how far, and its steps.
    """
    return tuple(_stage(stage, _begin(case, k), energy) for k, stage in enumerate(case.stages))


def _begin(case: Case, k: int) -> float | None:
    """Value of the controlled quantity where a stage begins [m or N]; None where only the run will show it."""
    stage, before = case.stages[k], case.stages[:k]
    if stage.quantity == "force":
        own = {name for name, _ in stage.ratios}
        if own.isdisjoint({GRAVITY, *(name for one in before for name, _ in one.ratios)}):
            return 0.0
    elif not before and case.gravity is None:
        return 0.0
    if not before or before[-1].energy or before[-1].stop_load or before[-1].targets[-1].of:
        return None
    latest = before[-1]
    same = (stage.ratios, stage.quantity, stage.gauge) == (latest.ratios, latest.quantity, latest.gauge)
    return latest.targets[-1].value if same else None


def _fewest(stage: LoadingStage, begin: float | None) -> int:
    """Steps of a stage at least; ways of unknown length count as one step."""
    steps = 0
    for target in stage.targets:
        if target.of:
            steps, begin = steps + _UNLOADING_STEPS, None
            continue
        way = 0.0 if begin is None else abs(target.value - begin)
        steps, begin = steps + max(1, math.ceil(way / stage.max_step * (1 - 1e-9))), target.value
    return steps


def _stage(stage: LoadingStage, begin: float | None, energy: float) -> tuple[str, str]:
    """Where a stage ends, and its steps, in words.

    With the value where it begins [m or N], if that is known, and the energy that breaks the specimen, roughly [J].
    """
    quantity = {"gauge": "gauge", "displacement": "displacement of the load", "force": "load"}[stage.quantity]
    if stage.gauge not in (None, "gauge") and stage.quantity == "gauge":
        quantity = f"gauge {stage.gauge}"
    if (loads := [name for name, _ in stage.ratios]) != ["load"] and stage.quantity != "gauge":
        quantity = f"{quantity} ({', '.join(loads)})"
    size = force if stage.quantity == "force" else lambda value: f"{value * 1e3:.4g} mm"
    values = [f"{100 * t.value:g} % of the {t.of}" if t.of else size(t.value) for t in stage.targets]
    told = ", ".join(values if len(values) <= _TOLD else [*values[: _TOLD - 2], "...", values[-1]])
    load = f" or {100 * stage.stop_load:.3g} % of the peak load is left" if stage.stop_load else ""
    step = force(stage.max_step) if stage.quantity == "force" else f"{stage.max_step * 1e6:.4g} µm"
    largest = f"each at most {step}"
    if stage.energy:
        most = joules(energy * stage.max_step / max(abs(stage.target), 1e-300))
        return (
            f"dissipated energy, until the {quantity} is {told}{load}",
            f"{largest}, with energy in the lead {most}",
        )
    if not stage.max_step:
        unloads = all(t.of and 0.0 <= t.value <= 1.0 for t in stage.targets)
        least, part = (_UNLOADING_STEPS, "tenth") if unloads else (_STEPS, "fiftieth")
        return f"{quantity}, to {told}", f"{least} or more, each at most a {part} of its way"
    fewest = _fewest(stage, begin)
    steps = f"{fewest} or more, {largest}" if fewest > 1 else largest
    return f"{quantity}, to {told}{load and ' or until' + load.removeprefix(' or')}", steps


def study_in_words(case: Case) -> str:
    """What the table ``[ensemble]`` asks for, in words; every point of its study is validated."""
    if case.ensemble is None:
        return ""

    part = case.ensemble
    runs = len(part.seeds) or part.runs or 1
    points = len(points_of(case, part.vary, part.combine))
    keys = f" of {', '.join(part.vary)}" if part.vary else ""
    return f"{counted(runs, 'realisation')} at {counted(points, 'point')}{keys}"
