"""Tessellation: nuclei (placement, selection), Voronoi bodies and their contacts."""

from __future__ import annotations

from fissura.tessellation.discretize import discretize, tessellate
from fissura.tessellation.mirror import MirrorZones, mirror_zones
from fissura.tessellation.nuclei import Nuclei, nuclei_from_case
from fissura.tessellation.placement import expected_count
from fissura.tessellation.selection import select
from fissura.tessellation.structure import Contacts, Polygons, SurfaceFacets, Tessellation

__all__ = [
    "Contacts",
    "MirrorZones",
    "Nuclei",
    "Polygons",
    "SurfaceFacets",
    "Tessellation",
    "discretize",
    "expected_count",
    "mirror_zones",
    "nuclei_from_case",
    "select",
    "tessellate",
]
