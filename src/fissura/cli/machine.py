"""What commands write for programs instead of people: one JSON object, errors as another."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

import typer

from fissura.errors import Notice

if TYPE_CHECKING:
    from fissura.api.check import CheckReport
    from fissura.results.comparison import Comparison

_FORMAT_VERSION = 1
"""Of all of these objects; docs/command-line.md has their keys."""

_wanted: ContextVar[bool] = ContextVar("wanted", default=False)


@contextmanager
def for_programs(wanted: bool) -> Iterator[None]:
    """Errors inside are told as JSON, if that is wanted."""
    token = _wanted.set(wanted)
    try:
        yield
    finally:
        _wanted.reset(token)


def is_for_programs() -> bool:
    """Whether what is said here is for programs."""
    return _wanted.get()


def tell_error(message: str, status: int, error: BaseException | None = None) -> None:
    """Write an error to standard error: as text, or as JSON where that is wanted.

    Parameters
    ----------
    message : str
        The whole message.
    status : int
        Exit status of the command.
    error : exception, optional
        The error, whose parts are told, too, where it has any.
    """
    if not _wanted.get():
        typer.echo(message, err=True)
        return
    parts = {name: getattr(error, name, None) for name in ("key", "problem", "allowed", "reason", "step")}
    told = {"message": message.removeprefix("error: "), "exit_status": status}
    told |= {name: part for name, part in parts.items() if isinstance(part, str | int)}
    typer.echo(json.dumps({"format_version": _FORMAT_VERSION, "error": told}), err=True)


def print_json(found: Mapping[str, Any]) -> None:
    """Write an object to standard output; what is not a finite number becomes null."""
    from fissura.files.atomic import plain

    typer.echo(json.dumps(plain({"format_version": _FORMAT_VERSION, **found}), indent=1))


def check_json(found: CheckReport) -> dict[str, Any]:
    """What ``fissura check --json`` writes."""
    E, alpha = found.contact
    bulk_E, bulk_nu = found.macro or (None, None)
    return {
        "case": found.name,
        "law": found.law,
        "criterion": found.criterion,
        "counted": found.bodies_start is not None,
        "bodies_start": found.bodies_start,
        "bodies_full": found.bodies_full,
        "bodies_full_estimated": found.estimated,
        "nuclei_given": found.nuclei_given,
        "contacts_start": found.contacts,
        "fine_contacts_start": found.fine_contacts,
        "memory_start_bytes": found.memory_start,
        "memory_full_bytes": found.memory_full,
        "memory_machine_bytes": found.memory_machine,
        "longest_fine_contact_m": found.longest_contact,
        "limits_m": dict(found.limits),
        "contact_E_Pa": E,
        "contact_alpha": alpha,
        "bulk_E_Pa": bulk_E,
        "bulk_nu": bulk_nu,
        "weight_N": found.weight,
        "stages": [{"control": control, "steps": steps} for control, steps in found.stages],
        "warnings": _notices(found.warnings),
    }


def comparison_json(found: Comparison) -> dict[str, Any]:
    """What ``fissura compare --json`` writes, but for its files."""
    numbers = {
        name: dict(zip(("a", "b", "difference"), values, strict=True)) for name, values in found.numbers().items()
    }
    return {
        "over": found.over,
        "controlled": found.quantity,
        "range": [float(x) for x in found.abscissa[[0, -1]]],
        "max_load_difference": found.max_load_difference,
        "at_max_difference": found.at_max_difference,
        "numbers": numbers,
        "warnings": _notices(found.notices),
    }


def _notices(notices: Iterable[Notice]) -> list[dict[str, str]]:
    return [{"key": one.key, "problem": one.problem, "advice": one.advice} for one in notices]
