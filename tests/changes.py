"""Cases with values replaced, as tests write them."""

from __future__ import annotations

import copy
from typing import Any

#: Stands for a key to be removed.
ABSENT = object()


def replaced(base: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Copy of a case's data with values replaced or removed; keys are paths such as ``supports__1__at``."""
    data = copy.deepcopy(base)
    for path, value in changes.items():
        *outer, last = path.split("__")
        table: Any = data
        for part in outer:
            table = table[int(part)] if part.isdigit() else table.setdefault(part, {})
        if value is ABSENT:
            del table[last]
        else:
            table[int(last) if last.isdigit() else last] = value
    return data
