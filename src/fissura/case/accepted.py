"""What a validator takes beyond what it returns, for the JSON schema of case files."""

from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

Schema: TypeAlias = dict[str, Any]
F = TypeVar("F", bound=Callable[..., Any])

NUMBER_WITH_UNIT: Schema = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": r"^\s*[+-]?\.?[0-9]"}]}
"""A plain number, or a text that begins with one."""


def accepting(change: Callable[[Schema], Schema]) -> Callable[[F], F]:
    """Mark a validator with how the schema of what it takes follows from that of what comes after it.

    Parameters
    ----------
    change : callable
        From one JSON schema to the other.

    Examples
    --------
    >>> @accepting(lambda inner: {"type": "boolean"})
    ... def flag(value): ...
    """

    def mark(function: F) -> F:
        vars(function)["accepts"] = change
        return function

    return mark


def change_of(function: Any) -> Callable[[Schema], Schema] | None:
    """The mark of a validator; None where it takes what it returns."""
    found: Callable[[Schema], Schema] | None = getattr(function, "accepts", None)
    return found


def one_or_list(inner: Schema) -> Schema:
    """One entry of a list instead of the list, or the list."""
    return {"anyOf": [inner["items"], inner]}
