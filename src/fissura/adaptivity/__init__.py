"""Adaptivity: refinement criterion, refined region, transfer of history."""

from __future__ import annotations

from fissura.adaptivity.calibration import calibrated, gauge_compliance
from fissura.adaptivity.coarsening import Coarsening, needed_contacts
from fissura.adaptivity.criterion import CRITERIA, ElasticState, criterion_named
from fissura.adaptivity.region import RefinedRegion, region_from_case
from fissura.adaptivity.transfer import transfer_history

__all__ = [
    "CRITERIA",
    "Coarsening",
    "ElasticState",
    "RefinedRegion",
    "calibrated",
    "criterion_named",
    "gauge_compliance",
    "needed_contacts",
    "region_from_case",
    "transfer_history",
]
