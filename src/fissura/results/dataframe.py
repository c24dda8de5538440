"""Curves as tables of pandas, where that is installed."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from numpy.typing import NDArray

from fissura.errors import InputError


def frame(columns: Mapping[str, NDArray[Any]], index: str) -> Any:
    """Columns as a ``pandas.DataFrame``.

    Parameters
    ----------
    columns : mapping of str to (n,) array
        Columns by name.
    index : str
        The one that becomes the index.

    Raises
    ------
    InputError
        Pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise InputError("pandas", "is not installed; tables need it", "pip install pandas") from None
    return pandas.DataFrame(dict(columns)).set_index(index)
