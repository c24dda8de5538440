"""What may change in a case when a run of it goes on: where it ends, and nothing of what has been."""

import json
from collections.abc import Iterator, Mapping, Set
from typing import Any

from fissura.case.load import case_from_dict
from fissura.case.model import Case
from fissura.case.stages import LoadingStage
from fissura.case.units import show
from fissura.errors import InputError

#: Steps of ``[control]`` that a case file need not give: those of before stay.
_STEPS = ("max_step", "first_step", "min_step", "energy_step")

#: What may change: names, what is written, where a run ends, on how many processors, and where files lie.
_FREE = (
    "name",
    "output",
    "ensemble",
    "control.target",
    "control.stop_load",
    "solver.threads",
    "discretization.nuclei",
    "specimen.mesh",
)

#: Keys that a message names at most.
_TOLD = 8


def as_data(case: Case) -> dict[str, Any]:
    """A case as plain data, with all its defaults resolved."""
    found: dict[str, Any] = json.loads(json.dumps(case.model_dump(mode="json", exclude={"source"})))
    return found


def continued(case: Case, before: Mapping[str, Any], leg: int, begin: float, *, finished: bool) -> Case:
    """The case with which a run goes on.

    Steps that ``[control]`` does not give are those of before, although they follow from a target that may have
    changed. The target on the way to which the run is may be farther; of a programme, what comes after it may be
    anything, so long as the last stage drives and controls the same.

    Parameters
    ----------
    case : Case
        What is asked for.
    before : mapping
        The case of the run so far, from :func:`as_data`.
    leg : int
        The way that the run is on, counted over the targets of all stages from 0, with gravity as the first one where
        there is any.
    begin : float
        Value of the controlled quantity where that way began [m or N]: it says which targets are farther.
    finished : bool
        The run has reached its end: a nearer target of ``[control]`` is that one.

    Raises
    ------
    InputError
        Something differs that may not.
    """
    earlier = case_from_dict(dict(before), files_exist=False)
    given = case
    if case.control is not None and earlier.control is not None:
        old = earlier.control
        steps = {key: getattr(old, key) for key in _STEPS if key not in case.control.model_fields_set}
        target = max(case.control.target, old.target)  # with a smaller one, steps might be refused as too long
        case = case.model_copy(update={"control": case.control.model_copy(update={**steps, "target": target})})
    stage, position = _place(earlier, leg)
    free = {*_FREE, *(f"stage[{stage}].{key}" for key in ("to", "stop_load"))}
    found = list(changes(_so_far(before, stage), _so_far(as_data(case), stage), free))
    if found:
        more = f" and {len(found) - _TOLD} more" if len(found) > _TOLD else ""
        raise InputError(
            "--resume",
            f"the case is not that of the run so far: {'; '.join(found[:_TOLD])}{more}",
            "changes of name, output, solver.threads, and of where the run ends; without --resume, any",
        )
    _check_ends(case if finished else given, earlier, stage, position, begin)
    return case


def _so_far(data: Mapping[str, Any], stage: int) -> dict[str, Any]:
    """A case without the stages to come."""
    return {**data, "stage": data["stage"][: stage + 1]}


def _place(case: Case, leg: int) -> tuple[int, int]:
    """Number of the stage from 0, and of the target in it, for a way; -1 and 0 for gravity."""
    left = leg - (case.gravity is not None)
    for number, stage in enumerate(case.stages):
        if left < len(stage.targets):
            return (number, left) if left >= 0 else (-1, 0)
        left -= len(stage.targets)
    return len(case.stages) - 1, len(case.stages[-1].targets) - 1


def _check_ends(case: Case, earlier: Case, stage: int, position: int, begin: float) -> None:
    """Refuse programmes that end otherwise than farther on."""
    if _driven(case.main) != _driven(earlier.main):
        raise InputError(
            "--resume",
            f"{case.main.key} drives or controls something else than the last stage of the run so far",
            "further stages, if the last one drives and controls the same",
        )
    if stage < 0:
        return
    now, was = case.stages[stage], earlier.stages[stage]
    if len(now.targets) <= position or now.targets[:position] != was.targets[:position]:
        raise InputError(now.target_key, "targets that have been reached are not as they were", "further targets")
    old, new = was.targets[position], now.targets[position]
    if old != new and (old.of or new.of):
        raise InputError(
            now.target_key,
            f"target {position + 1}, to which the run was on the way, is a share of a load, or was one",
            "the same, with --resume",
        )
    if (new.value - old.value) * (old.value - begin) < 0.0:
        raise InputError(
            now.target_key,
            f"{show(new.value)} is not as far as {show(old.value)}, to which the run was on the way",
            "the same, or farther, with --resume",
        )


def _driven(stage: LoadingStage) -> tuple[Any, ...]:
    return stage.ratios, stage.quantity, stage.gauge


def _are_tables(*lists: list[Any]) -> bool:
    return all(isinstance(item, Mapping) for items in lists for item in items)


def changes(before: Any, now: Any, free: Set[str] = frozenset(), key: str = "") -> Iterator[str]:
    """Keys with different values, and these values."""
    if key in free or before == now:
        return
    if isinstance(before, Mapping) and isinstance(now, Mapping):
        for name in dict.fromkeys((*before, *now)):
            yield from changes(before.get(name), now.get(name), free, f"{key}.{name}" if key else name)
    elif isinstance(before, list) and isinstance(now, list) and (len(before) == len(now) or _are_tables(before, now)):
        for k, (old, new) in enumerate(zip(before, now, strict=False)):
            yield from changes(old, new, free, f"{key}[{k}]")
        for k in range(len(now), len(before)):
            yield f"{key}[{k}] is gone"
        for k in range(len(before), len(now)):
            yield f"{key}[{k}] is new"
    else:
        yield f"{key} was {show(before)} and is now {show(now)}"
