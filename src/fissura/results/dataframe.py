"""Curves as tables of pandas, where that is installed."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.results.curve import Curve

__all__ = ["dataframe_of", "frame"]


def dataframe_of(curve: Curve) -> Any:
    """The columns of a curve as a ``pandas.DataFrame``, steps as its index.

    Raises
    ------
    InputError
        Pandas is not installed.
    """
    return frame(curve, "step")


def frame(columns: Mapping[str, NDArray[Any]], index: str) -> Any:
    """Columns, shape (n,), as a ``pandas.DataFrame``, one of them as its index.

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
