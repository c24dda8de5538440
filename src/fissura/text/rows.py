"""Rows of name and value as plain lines, as commands print them and results show themselves."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["aligned"]


def aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    """One line for each row of name and value, of which there are some; the values stand one below the other.

    Examples
    --------
    >>> aligned([("case", "beam"), ("seed", "1")])
    ['case  beam', 'seed  1']
    """
    width = max(len(name) for name, _ in rows)
    return [f"{name:<{width}}  {value}" for name, value in rows]
