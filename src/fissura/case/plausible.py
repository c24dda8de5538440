"""Values that are allowed but look wrong: what a case alone can tell, before anything is built."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from fissura.case.model import Case
from fissura.errors import Notice

__all__ = ["CHECKS", "case_notices"]

#: Each looks at a case and returns what looks wrong; a new check is a function here.
CHECKS: tuple[Callable[[Case], Iterable[Notice]], ...] = ()


def case_notices(case: Case) -> tuple[Notice, ...]:
    """What looks wrong in a case, although it is allowed.

    Parameters
    ----------
    case : Case
        Case to look at.
    """
    return tuple(notice for check in CHECKS for notice in check(case))
