"""Names of columns as users give them."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from fissura.errors import InputError
from fissura.results.curve import TEXTS
from fissura.text.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["column_among", "column_named"]


def column_named(columns: Iterable[str], name: str, key: str) -> str:
    """The column that is meant: its name may be without the unit.

    Parameters
    ----------
    columns : iterable of str
        Those that there are.
    name : str
        What was asked for.
    key : str
        Where, for the message.

    Raises
    ------
    InputError
        There is none, or it holds words.

    Examples
    --------
    >>> column_named(["gauge_m", "load_N"], "load", "y")
    'load_N'
    """
    if name in TEXTS:
        raise InputError(key, f"{name!r} holds words", ", ".join(column for column in columns if column not in TEXTS))
    return column_among([column for column in columns if column not in TEXTS], name, key)


def column_among(columns: Sequence[str], name: str, key: str, of: str = "the curve") -> str:
    """The column that is meant: its name may be without the unit.

    Raises
    ------
    InputError
        There is none.
    """
    found = [column for column in columns if name in (column, split_unit(column)[0])]
    if found:
        return found[0]
    near = difflib.get_close_matches(str(name), [*columns, *(split_unit(column)[0] for column in columns)], n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise InputError(key, f"{name!r} is no column of {of}{hint}", ", ".join(columns))
