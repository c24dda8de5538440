"""Rows of name and value as plain lines, as commands print them and results show themselves."""

from collections.abc import Sequence


def aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    """One line for each row, the values one below the other.

    Parameters
    ----------
    rows : sequence of (str, str)
        Names and values, at least one.

    Returns
    -------
    list of str
        The lines.

    Examples
    --------
    >>> aligned([("case", "beam"), ("seed", "1")])
    ['case  beam', 'seed  1']
    """
    width = max(len(name) for name, _ in rows)
    return [f"{name:<{width}}  {value}" for name, value in rows]


class Described:
    """What is described by rows of name and value, and shows itself by them."""

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value that describe it.

        Returns
        -------
        list of (str, str)
            As the command prints them.

        Examples
        --------
        >>> dict(result.table())["status"]
        'finished'
        """
        return self._rows()

    def _rows(self) -> list[tuple[str, str]]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return "\n".join(aligned(self.table()))
