"""Frozen dataclasses as text and arrays, and back, without pickles: new fields need nothing here."""

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def pack(value: Any, key: str, arrays: dict[str, NDArray[Any]]) -> Any:
    """Turn a value into what JSON can hold, its arrays apart.

    Parameters
    ----------
    value : object
        A dataclass, tuple, array, number, text or None, nested as may be.
    key : str
        Where its arrays go.
    arrays : dict
        They are put here.

    Returns
    -------
    object
        For :func:`unpack`. Numbers are kept to the last bit by JSON of Python, which has names for nan and infinity.

    Examples
    --------
    >>> pack((1, None, 0.5), "", {})
    {'tuple': [1, None, 0.5]}
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [f.name for f in dataclasses.fields(value) if f.init]
        return {
            "type": type(value).__name__,
            "fields": {name: pack(getattr(value, name), f"{key}.{name}", arrays) for name in fields},
        }
    if isinstance(value, tuple):
        return {"tuple": [pack(item, f"{key}.{k}", arrays) for k, item in enumerate(value)]}
    if isinstance(value, np.ndarray):
        if not value.size:  # many are empty, and each in a file takes its time
            return {"empty": list(value.shape), "dtype": value.dtype.str}
        arrays[key] = value
        return {"array": key}
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{key}: {type(value).__name__} cannot be packed")


def unpack(tree: Any, arrays: Mapping[str, NDArray[Any]], types: Iterable[type]) -> Any:
    """Turn what `pack` gave into the value again.

    Parameters
    ----------
    tree : object
        What it returned.
    arrays : mapping
        What it put there.
    types : iterable of type
        Dataclasses that may occur; nothing else is made. A field that is not there gets its default.

    Raises
    ------
    KeyError, TypeError, ValueError
        The tree is something else.

    Examples
    --------
    >>> unpack({"tuple": [1, None, 0.5]}, {}, ())
    (1, None, 0.5)
    """
    known = {kind.__name__: kind for kind in types}

    def made(tree: Any) -> Any:
        if not isinstance(tree, dict):
            return tree
        if "array" in tree:
            return arrays[tree["array"]]
        if "empty" in tree:
            return np.empty(tree["empty"], dtype=tree["dtype"])
        if "tuple" in tree:
            return tuple(made(item) for item in tree["tuple"])
        return known[tree["type"]](**{name: made(item) for name, item in tree["fields"].items()})

    return made(tree)
