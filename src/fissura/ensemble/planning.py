"""The plan of an ensemble from what a user asks for: arguments first, then the table ``[ensemble]`` of the case."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from fissura.case import Case, Ensemble
from fissura.case.ensemble import Combine, Varied
from fissura.case.report import input_error
from fissura.ensemble.plan import LEADING_MODES, Plan
from fissura.ensemble.task import Companions, Mode, Sampling
from fissura.errors import InputError
from fissura.material import field_from_case


def planned(
    case: Case,
    runs: int | None = None,
    *,
    vary: Mapping[str, Any] | None = None,
    combine: Combine | None = None,
    seeds: Iterable[int] | None = None,
    mode: Mode | None = None,
    sampling: Sampling = "monte-carlo",
    leading_modes: int | None = None,
    seed: int | None = None,
    full: bool = False,
    companions: Companions | None = None,
    keep: bool = False,
) -> Plan:
    """The plan of an ensemble; arguments are those of `fissura.run_ensemble`.

    Raises
    ------
    InputError
        An argument or a value of a varied key is wrong, or it is not said how many runs are wanted.
    """
    table = case.ensemble or Ensemble()
    values = table.vary if vary is None else _lists(vary)
    if runs is not None and seeds is not None:
        raise InputError("--runs", "is given together with seeds", "one of them")
    chosen = table.seeds if seeds is None and runs is None else tuple(seeds or ())
    if seeds is not None and not chosen:
        raise InputError("seeds", "the list is empty", "at least one whole number")
    if chosen and seed is not None:
        raise InputError("--seed", "is given together with seeds", "one of them")
    if runs is None and not chosen and table.runs is None and values:
        chosen, seed = (case.seed if seed is None else seed,), None  # the case as it is, at each point
    if runs is None:
        runs = len(chosen) or table.runs
    if runs is None:
        raise InputError("--runs", "is missing", "a whole number, or runs or vary in the table [ensemble] of the case")
    plan = Plan(
        case,
        runs,
        ("both" if case.field is not None else "geometry") if mode is None else mode,
        sampling,
        case.seed if seed is None else seed,
        full,
        ("none" if values else "one") if companions is None else companions,
        LEADING_MODES if leading_modes is None else leading_modes,
        keep,
        values,
        table.combine if combine is None else combine,
        chosen,
    )
    return replace(plan, leading_modes=_leading_modes(plan, leading_modes))


def _lists(vary: Mapping[str, Any]) -> Varied:
    data = {"vary": vary}
    try:
        return Ensemble.model_validate(data).vary
    except ValidationError as error:
        raise input_error(error, Ensemble, data) from None


def _leading_modes(plan: Plan, asked: int | None) -> int:
    """Number of modes to stratify; finds out on the way whether the field is possible, before many runs fail of it."""
    if asked is not None and plan.sampling != "latin-hypercube":
        raise InputError("--leading-modes", f"has no effect on {plan.sampling}", "only with --sampling latin-hypercube")
    if plan.mode == "geometry":
        return plan.leading_modes

    modes = 0
    for case in _with_different_fields(plan):
        field = field_from_case(case)
        assert field is not None
        modes = min(modes or field.accuracy.modes, field.accuracy.modes)
    if asked is not None and asked > modes:
        raise InputError("--leading-modes", f"{asked} is more than the {modes} modes of the field", f"1 to {modes}")
    return min(plan.leading_modes, modes) if plan.sampling == "latin-hypercube" else plan.leading_modes


def _with_different_fields(plan: Plan) -> list[Case]:
    """One case for each specimen and field among the points."""
    found: dict[str, Case] = {}
    for point in plan.points:
        what = point.case.model_dump_json(include={"field", "specimen", "minus", "notch", "discretization"})
        found.setdefault(what, point.case)
    return list(found.values())
