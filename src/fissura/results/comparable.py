"""What two runs have in common: over what their loads can be compared, and in what their specimens differ."""

import math
from collections.abc import Iterator
from typing import Any

from fissura.case import Case, Gauge, Quantity
from fissura.errors import InputError, Notice
from fissura.results.load_path import NAMES

SPECIMEN = (
    "specimen",
    "minus",
    "notch",
    "supports",
    "load",
    "loads",
    "gravity",
    "material",
    "materials",
    "field",
    "seed",
    "discretization",
)
"""Tables and keys that make a specimen and its test."""

HOW_FINE = frozenset({"discretization.l_c"})
"""Keys in them that do not: how coarse a run begins."""

SHOWN = 4
"""Differences that a warning names."""


def common_quantity(a: Case, b: Case, key: str) -> Quantity:
    """Choose what the loads of two runs are compared over.

    It is what both control. Where one controls its gauge and the other the displacement of its load, it is the gauge if
    both have the same one, else the displacement if both have the same load.

    Parameters
    ----------
    a, b : Case
        The cases of the runs.
    key : str
        Name of the first run in messages.

    Raises
    ------
    InputError
        They have neither in common.
    """
    if a.quantity == b.quantity:
        return a.quantity
    if _gauge(a) is not None and _gauge(b) is not None and not _different(_plain(_gauge(a)), _plain(_gauge(b))):
        return "gauge"
    if not _different(_driven(a), _driven(b)):
        return "displacement"
    raise InputError(
        key,
        f"nothing can be compared: it is controlled by its {NAMES[a.quantity]}, the other run by its"
        f" {NAMES[b.quantity]}, and they have neither the gauge nor the load in common",
        "runs with the same gauge, or with the same load, or both controlled alike",
    )


def comparison_notices(a: Case, b: Case, quantity: Quantity) -> tuple[Notice, ...]:
    """Warnings about runs of different specimens, or about values that do not mean the same in both.

    Parameters
    ----------
    a, b : Case
        The cases of the runs.
    quantity : str
        What their loads are compared over.
    """
    found = []
    different = {
        name: values
        for part in SPECIMEN
        for name, values in _different(_plain(getattr(a, part)), _plain(getattr(b, part)), part).items()
        if name not in HOW_FINE
    }
    if different:
        found.append(
            Notice(
                next(iter(different)),
                f"A and B broke different specimens: {_list(different)}",
                "read the differences as those of the specimens; how far off an adaptive run is, only a run of the same"
                " specimen tells",
            )
        )
    gauges = _different(_plain(_gauge(a)), _plain(_gauge(b)), "gauge")
    if quantity == "gauge" and gauges:
        found.append(
            Notice(
                next(iter(gauges)),
                f"A and B have different gauges, and loads are compared over the gauge: {_list(gauges)}",
                "compare loads and energies only, or runs with the same gauge",
            )
        )
    if a.quantity != b.quantity:
        found.append(
            Notice(
                "control.type",
                f"A is controlled by its {NAMES[a.quantity]} and B by its {NAMES[b.quantity]}: loads are compared over"
                f" the {NAMES[quantity]}, and initial stiffness is not",
                "differences where either of them jumps may come from the control",
            )
        )
    return tuple(found)


def _gauge(case: Case) -> Gauge | None:
    """The gauge of the last stage."""
    return next((gauge.part for gauge in case.named_gauges if gauge.name == case.main.gauge), None)


def _driven(case: Case) -> Any:
    """The loads that the last stage drives, as plain data with their ratios."""
    loads = {load.name: load.part for load in case.named_loads}
    return [{"ratio": ratio, "load": _plain(loads.get(name, name))} for name, ratio in case.main.ratios]


def _plain(part: Any) -> Any:
    """A part of a case as plain data."""
    if isinstance(part, dict):
        return {name: _plain(item) for name, item in part.items()}
    if isinstance(part, tuple):
        return [_plain(item) for item in part]
    return part.model_dump(mode="json") if hasattr(part, "model_dump") else part


def _different(a: Any, b: Any, name: str = "") -> dict[str, tuple[Any, Any]]:
    """Dotted keys whose values differ, with both values; of a part that only one has, its name."""
    if (a in (None, [])) != (b in (None, [])):
        return {name: (None, "given") if a in (None, []) else ("given", None)}
    of_a, of_b = dict(_leaves(a, name)), dict(_leaves(b, name))
    names = [*of_a, *(name for name in of_b if name not in of_a)]
    pairs = {name: (of_a.get(name), of_b.get(name)) for name in names}
    return {name: values for name, values in pairs.items() if not _same(*values)}


def _leaves(data: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Values of nested tables by dotted key; those of a list of numbers stay together."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, f"{name}.{key}" if name else key)
    elif isinstance(data, list) and any(isinstance(item, dict | list) for item in data):
        for k, value in enumerate(data):
            yield from _leaves(value, f"{name}[{k}]")
    elif data is not None and data != []:
        yield name, data


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=1e-9)  # the same value written in another unit
    return bool(a == b)


def _list(different: dict[str, tuple[Any, Any]]) -> str:
    """The first differences in words, and how many more there are."""
    words = [f"{name} {_show(a)} and {_show(b)}" for name, (a, b) in list(different.items())[:SHOWN]]
    more = len(different) - len(words)
    return ", ".join(words) + (f", and {more} more" if more else "")


def _show(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, list):
        return f"[{', '.join(_show(item) for item in value)}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
