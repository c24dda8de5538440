"""Material: parameters of the contact law, regions that stay elastic, the random field."""

from __future__ import annotations

from fissura.material.field import RandomField, field_from_case
from fissura.material.parameters import Material, material_from_case
from fissura.material.regions import Regions, check_not_everywhere, elastic_from_case

__all__ = [
    "Material",
    "RandomField",
    "Regions",
    "check_not_everywhere",
    "elastic_from_case",
    "field_from_case",
    "material_from_case",
]
