"""Cases with some values changed: by dotted keys, defaults derived anew."""

import re
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from fissura.case.material import Material
from fissura.case.own_table import WithOwnTable
from fissura.case.part import Part
from fissura.case.units import show
from fissura.errors import InputError

P = TypeVar("P", bound=Part)

Tree = dict[str | int, Any]
"""Changes by the first part of their keys; a `_Value` where a key ends."""

_PART = re.compile(r"([A-Za-z0-9_-]+)((?:\[[0-9]{1,6}\])*)")
_ALLOWED = 'a key such as "material.f_t", "supports[0].at" or "loads.left.at"'


class _Value:
    """A new value, which is told from further changes inside a table."""

    def __init__(self, value: Any) -> None:
        self.value = value


def changed(part: P, changes: Mapping[str, Any]) -> P:
    """A copy of a case, or of a part of one, with some values changed.

    All changes are made together, then each table is validated and its defaults are derived anew, as by
    :meth:`~fissura.case.part.Part.model_copy`.

    Parameters
    ----------
    part : Case or other Part
        What is copied.
    changes : mapping of str to value
        New values by dotted key, as a case file gives them.

    Raises
    ------
    InputError
        A key is not known, or a new value is wrong or does not go with the others; its key is the whole one.
    """
    tree: Tree = {}
    for key, value in changes.items():
        _plant(tree, key, value)
    return _copied(part, tree, "") if tree else part


def parts_of_key(key: Any) -> list[str | int]:
    """Names and indices in a dotted key."""
    out: list[str | int] = []
    for word in key.split(".") if isinstance(key, str) else [""]:
        found = _PART.fullmatch(word)
        if not found:
            raise InputError(show(key), "is no key of a case", _ALLOWED)
        out += [found[1], *map(int, re.findall(r"[0-9]+", found[2]))]
    return out


def _plant(tree: Tree, key: str, value: Any) -> None:
    """Enter a change into a tree of changes."""
    *outer, last = parts_of_key(key)
    if last == "unit":
        raise InputError(key, "changes what numbers mean, not a value", 'a text with a unit, such as "5 mm", for each')
    for part in outer:
        tree = tree.setdefault(part, {})
        if isinstance(tree, _Value):
            raise InputError(key, "is changed together with the table it is in", "one of them")
    if last in tree:
        raise InputError(key, "is changed together with values in it", "one of them")
    tree[last] = _Value(value)


def _copied(part: P, tree: Tree, path: str) -> P:
    """A part with the changes of a tree made; the path leads there."""
    update = {}
    for key, change in tree.items():
        now = _now(part, str(key))
        update[str(key)] = _new(now, change, _joined(path, key))
    try:
        return part.model_copy(update=update)
    except InputError as error:
        raise InputError(_joined(path, error.key), error.problem, error.allowed) from None


def _now(part: Part, key: str) -> Any:
    """The value that a part has; None where it has none."""
    if isinstance(part, Material) and key == "macro":
        return part.whole
    if key in type(part).model_fields:
        return getattr(part, key)
    # Constants of a region are beside the fields.
    return part.own(key) if isinstance(part, WithOwnTable) else None


def value_at(part: Part, key: str) -> Any:
    """The value that a dotted key has in a case; None where it has none.

    Examples
    --------
    >>> value_at(case, "supports[0].type")
    'pin'
    """
    now: Any = part
    for word in parts_of_key(key):
        if isinstance(now, tuple) and isinstance(word, str):
            now = now[0] if len(now) == 1 else None  # keys without an index mean the only table of a list
        if isinstance(now, tuple):
            now = now[int(word)] if int(word) < len(now) else None
        elif isinstance(now, Mapping):
            now = now.get(word)
        else:
            now = _now(now, str(word)) if isinstance(now, Part) else getattr(now, str(word), None)
    return now


def _new(now: Any, change: Any, path: str) -> Any:
    """What a value becomes."""
    if isinstance(change, _Value):
        return change.value
    if isinstance(now, Part):
        return _copied(now, change, path)
    if isinstance(now, BaseModel):  # of another package
        now = now.model_dump(exclude_unset=True)
    if isinstance(now, tuple):
        return _changed_list(now, change, path)
    if now is not None and not isinstance(now, Mapping):
        raise InputError(path, f"{show(now)} is neither a table nor a list", f"{path} itself as a key")
    table = dict(now or {})
    for key, inner in change.items():
        if isinstance(key, int):
            raise InputError(path, "has no entries by number", f"{path}.NAME")
        value = _new(table.get(key), inner, _joined(path, key))
        if value is None:
            table.pop(key, None)
        else:
            table[key] = value
    return table


def _changed_list(now: tuple[Any, ...], change: Tree, path: str) -> Any:
    """What a list becomes; keys without an index mean the only table in it."""
    named = [key for key in change if isinstance(key, str)]
    if named:
        if len(named) < len(change):
            raise InputError(path, "is changed both with and without an index", f"{path}[0] for each")
        if not now:
            return _new(None, change, path)
        if len(now) > 1:
            raise InputError(path, f"is a list of {len(now)}", f"{path}[0] to {path}[{len(now) - 1}]")
        return (_new(now[0], change, path),)
    entries = list(now)
    for key, inner in change.items():
        if not 0 <= int(key) < len(now):
            allowed = f"{path}[0] to {path}[{len(now) - 1}]" if now else f"{path} as a whole"
            raise InputError(f"{path}[{key}]", f"there are {len(now)}", allowed)
        entries[int(key)] = _new(entries[int(key)], inner, f"{path}[{key}]")
    return tuple(entries)


def _joined(path: str, key: str | int) -> str:
    if not path or isinstance(key, int) or key.startswith("["):
        return f"{path}[{key}]" if isinstance(key, int) else f"{path}{key}"
    return f"{path}.{key}"
