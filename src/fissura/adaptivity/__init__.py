"""Adaptivity: refinement criterion, refined region, transfer of history."""

from __future__ import annotations

from fissura.adaptivity.calibration import calibrated, gauge_compliance
from fissura.adaptivity.criterion import CRITERIA, ElasticState, criterion_named
from fissura.adaptivity.region import RefinedRegion, region_from_case
from fissura.adaptivity.transfer import transfer_history

__all__ = [
    "CRITERIA",
    "ElasticState",
    "RefinedRegion",
    "calibrated",
    "criterion_named",
    "gauge_compliance",
    "region_from_case",
    "transfer_history",
]
