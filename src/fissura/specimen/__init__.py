"""Specimens: convex cells with named surfaces, notches, and the places of supports, loads and gauges."""

from fissura.specimen.build import domain_from_case
from fissura.specimen.complex import Complex
from fissura.specimen.conditions import (
    Conditions,
    Drive,
    Platen,
    Weight,
    conditions_from_case,
    load_direction,
)
from fissura.specimen.domain import Domain
from fissura.specimen.edges import edge_notices
from fissura.specimen.functional import Functional, mean_displacement
from fissura.specimen.gauge import backward_gauge, gauge_notices
from fissura.specimen.gauge_kinds import Places, gauge_from_part
from fissura.specimen.notches import Notch
from fissura.specimen.place import Place, place_from_part
from fissura.specimen.solid import Solid
from fissura.specimen.surface_part import SurfacePart
from fissura.specimen.thin import thin_notices, thin_parts

__all__ = [
    "Complex",
    "Conditions",
    "Domain",
    "Drive",
    "Functional",
    "Notch",
    "Place",
    "Places",
    "Platen",
    "Solid",
    "SurfacePart",
    "Weight",
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
