"""Tessellation: nuclei (placement, selection), Voronoi bodies and their contacts."""

from __future__ import annotations

from fissura.tessellation.discretize import discretize, tessellate
from fissura.tessellation.nuclei import Nuclei, nuclei_from_case
from fissura.tessellation.owners import Bodies, owners
from fissura.tessellation.placement import place
from fissura.tessellation.selection import select
from fissura.tessellation.structure import Contacts, Polygons, SurfaceFacets, Tessellation

__all__ = [
    "Bodies",
    "Contacts",
    "Nuclei",
    "Polygons",
    "SurfaceFacets",
    "Tessellation",
    "discretize",
    "nuclei_from_case",
    "owners",
    "place",
    "select",
    "tessellate",
]
