"""Tessellation: nuclei (placement, selection), Voronoi bodies and their contacts."""

from fissura.tessellation.discretize import discretize
from fissura.tessellation.footprint import footprint
from fissura.tessellation.levels import needed_spacing
from fissura.tessellation.nuclei import Nuclei, nuclei_from_case
from fissura.tessellation.owners import Bodies, owners
from fissura.tessellation.selection import select
from fissura.tessellation.tessellation import Contacts, SurfaceFacets, Tessellation

__all__ = [
    "Bodies",
    "Contacts",
    "Nuclei",
    "SurfaceFacets",
    "Tessellation",
    "discretize",
    "footprint",
    "needed_spacing",
    "nuclei_from_case",
    "owners",
    "select",
]
