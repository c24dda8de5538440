"""Specimens: convex cells with named surfaces, notches, and the places of supports, loads and gauges."""

from fissura.specimen.build import domain_from_case
from fissura.specimen.conditions import (
    Conditions,
    Drive,
    Platen,
    conditions_from_case,
    load_direction,
)
from fissura.specimen.domain import Domain
from fissura.specimen.edges import edge_notices
from fissura.specimen.functional import Functional, mean_displacement
from fissura.specimen.gauge import backward_gauge, gauge_notices
from fissura.specimen.gauge_kinds import Places, gauge_from_part
from fissura.specimen.place import Place, place_from_part
from fissura.specimen.solid import Solid
from fissura.specimen.thin import thin_notices, thin_parts

__all__ = [
    "Conditions",
    "Domain",
    "Drive",
    "Functional",
    "Place",
    "Places",
    "Platen",
    "Solid",
    "backward_gauge",
    "conditions_from_case",
    "domain_from_case",
    "edge_notices",
    "gauge_from_part",
    "gauge_notices",
    "load_direction",
    "mean_displacement",
    "place_from_part",
    "thin_notices",
    "thin_parts",
]
