"""Material: parameters of the contact law, regions that stay elastic, later random fields."""

from __future__ import annotations

from fissura.material.parameters import Material, material_from_case
from fissura.material.regions import Regions, check_not_everywhere, elastic_from_case

__all__ = ["Material", "Regions", "check_not_everywhere", "elastic_from_case", "material_from_case"]
