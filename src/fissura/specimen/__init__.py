"""Specimens: shapes with named surfaces, notches, and the places of supports, loads and gauges."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fissura.errors import InputError
from fissura.specimen.box import Box
from fissura.specimen.conditions import Conditions, Functional, conditions_from_case
from fissura.specimen.gauge import backward_gauge, gauge_notices
from fissura.specimen.notch import Notch
from fissura.specimen.thin import edge_notices, thin_notices, thin_parts

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = [
    "SHAPES",
    "Box",
    "Conditions",
    "Functional",
    "Notch",
    "backward_gauge",
    "conditions_from_case",
    "edge_notices",
    "gauge_notices",
    "specimen_from_case",
    "thin_notices",
    "thin_parts",
]

#: Shapes by the name that a case file gives; each is built by its ``from_case``.
SHAPES: dict[str, type[Box]] = {"box": Box}


def specimen_from_case(case: Case) -> Box:
    """Build the specimen that the case describes.

    Raises
    ------
    InputError
        Unknown shape, or a notch that does not fit into the specimen.
    """
    shape = SHAPES.get(case.specimen.shape)
    if shape is None:
        raise InputError("specimen.shape", f"{case.specimen.shape!r} is not known", ", ".join(sorted(SHAPES)))
    return shape.from_case(case)
