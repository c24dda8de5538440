"""Material: parameters of the contact law, regions that stay elastic, the random field."""

from fissura.material.field import field_from_case
from fissura.material.parameters import Material, material_from_case
from fissura.material.regions import Regions, check_not_everywhere, elastic_from_case
from fissura.material.several import Materials, materials_from_case

__all__ = [
    "Material",
    "Materials",
    "Regions",
    "check_not_everywhere",
    "elastic_from_case",
    "field_from_case",
    "material_from_case",
    "materials_from_case",
]
