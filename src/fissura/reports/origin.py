"""What a page says of where a run comes from, of its error, and of how to cite it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fissura.text import quantities as text

if TYPE_CHECKING:
    from fissura.results.result import Result

NOT_RECORDED = "not recorded"

_CUSATIS = (
    ", and the contact law of G. Cusatis, L. Cedolin, Two-scale study of concrete fracturing behavior, Eng. Fract."
    " Mech. 74 (2007) 3–17"
)
_LAWS = {"cusatis-cedolin": _CUSATIS, "cusatis-cedolin-closing": _CUSATIS}

STATUS = {
    "running": "The run goes on, or was killed: the page shows what it has left so far.",
    "stopped": "The run stopped early.",
    "interrupted": "The run was interrupted.",
    "refused": "The run was refused after its start.",
    "failed": "The run failed.",
}


def status_told(result: Result) -> str | None:
    """What to say of a run that did not finish; None of one that did."""
    status, message = result.summary.get("status"), result.summary.get("message")
    if status == "finished":
        return None
    told = STATUS.get(str(status), f"The status of the run is {status}.")
    return f"{told} {message}" if message else told


def origin_rows(summary: Mapping[str, Any], seed: str) -> list[tuple[str, str]]:
    """Names and values of seed, program, machine and date.

    Parameters
    ----------
    summary : mapping
        Content of a ``summary.json``; that of a realisation that was refused lacks some of them.
    seed : str
        What to say of the seed.
    """
    versions = dict(summary.get("versions") or {})
    fissura = versions.pop("fissura", "unknown")
    return [
        ("seed", seed),
        ("Fissura", fissura),
        ("commit", _commit(summary)),
        ("libraries", ", ".join(f"{name} {number}" for name, number in versions.items()) or NOT_RECORDED),
        ("machine", _machine(summary.get("machine"))),
        ("date", str(summary.get("date") or NOT_RECORDED).replace("T", " ").replace("Z", " UTC")),
    ]


def seed_told(result: Result) -> str:
    """Seed of a run, and of its random field."""
    field = result.summary.get("field") or {}
    seed = str(result.summary.get("seed", result.case.seed))
    return f"{seed}, of the field {field['seed']}" if "seed" in field else seed


def bound_told(result: Result) -> list[str]:
    """What is known of the difference from full resolution, and what that means."""
    if result.full:
        return ["The run is at full resolution from the start, so adaptivity adds no error."]
    bound = result.summary.get("load_error_bound")
    if bound is None:
        return ["No bound is known: the run has no step."]
    return [
        f"At most {text.per_cent(float(bound))} of the peak load from a run of the same specimen at full resolution, at"
        " any gauge: in 9 of 10 runs of the study that the bound comes from, the difference was smaller. In the median"
        " it was a fifth of the bound.",
        "This is the error of adaptivity alone, found from how near to their strength contacts without damage came. It"
        " tells nothing of how well law, constants and size of the bodies suit the material, and it does not hold where"
        " the crack takes another way than at full resolution, which the run cannot know.",
    ]


def cited(result: Result) -> list[str]:
    """Sentences by which a reader finds program, model and run again."""
    versions = result.summary.get("versions") or {}
    commit = _commit(result.summary)
    which = f", commit {commit}" if commit != NOT_RECORDED else ""
    kind = "at full resolution" if result.full else "adaptive"
    return [
        f"The Fissura developers, Fissura {versions.get('fissura', 'unknown')}{which}: adaptive discrete models of"
        f" fracture. Name the case, the seed ({result.summary.get('seed', result.case.seed)}) and that the run is"
        f" {kind}: with them, the same program gives the same numbers on the same kind of machine.",
        "The model follows J. Eliáš, Adaptive technique for discrete models of fracture, Int. J. Solids Struct. 100–101"
        f" (2016) 376–387{_LAWS.get(result.case.material.law, '')}.",
    ]


def bibtex(result: Result) -> str:
    """An entry for a bibliography."""
    summary = result.summary
    version = str((summary.get("versions") or {}).get("fissura", "unknown"))
    commit, date = _commit(summary), str(summary.get("date") or "")
    note = f"seed {summary.get('seed', result.case.seed)}" + (f", commit {commit}" if commit != NOT_RECORDED else "")
    lines = [
        "@misc{fissura,",
        "  author  = {{The Fissura developers}},",
        "  title   = {Fissura: adaptive discrete models of fracture},",
        f"  version = {{{version}}},",
        *([f"  year    = {{{date[:4]}}},"] if date else []),
        f"  note    = {{Computer program; {note}}}",
        "}",
    ]
    return "\n".join(lines)


def _commit(summary: Mapping[str, Any]) -> str:
    commit = summary.get("commit")
    if not commit:
        return NOT_RECORDED
    return str(commit).replace("-dirty", ", with changes that are not committed")


def _machine(found: Any) -> str:
    if not isinstance(found, dict):
        return NOT_RECORDED
    memory = float(found.get("memory_bytes") or 0.0)
    told = [str(found.get("processor")), f"{found.get('processors')} processors", str(found.get("system"))]
    return ", ".join([*told, *([f"{memory / 1e9:.0f} GB"] if memory else [])])
