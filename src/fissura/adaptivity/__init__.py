"""Adaptivity: refinement criterion, refined region, transfer of history."""

from fissura.adaptivity.calibration import calibrated, gauge_compliance
from fissura.adaptivity.coarsening import Coarsening, needed_bodies
from fissura.adaptivity.criterion import ElasticState
from fissura.adaptivity.estimate import load_error_bound
from fissura.adaptivity.extrapolation import bodies_of_calibration, extrapolated_compliance
from fissura.adaptivity.layout import Layout
from fissura.adaptivity.region import RefinedRegion, region_from_case
from fissura.adaptivity.transfer import transfer_history

__all__ = [
    "Coarsening",
    "ElasticState",
    "Layout",
    "RefinedRegion",
    "bodies_of_calibration",
    "calibrated",
    "extrapolated_compliance",
    "gauge_compliance",
    "load_error_bound",
    "needed_bodies",
    "region_from_case",
    "transfer_history",
]
