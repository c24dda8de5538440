"""Material: parameters of the contact law, regions that stay elastic, the random field."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fissura.material.parameters import Material, material_from_case
from fissura.material.regions import Regions, check_not_everywhere, elastic_from_case
from fissura.material.several import Materials, joined, materials_from_case

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.material.field import RandomField

__all__ = [
    "Material",
    "Materials",
    "Regions",
    "check_not_everywhere",
    "elastic_from_case",
    "field_from_case",
    "joined",
    "material_from_case",
    "materials_from_case",
]


def field_from_case(case: Case) -> RandomField | None:
    """The realisation of a case's random field; None, and nothing loaded, for a case without one.

    Raises
    ------
    InputError
        See :func:`fissura.material.field.field_from_case`.
    """
    if case.field is None:
        return None
    from fissura.material import field

    return field.field_from_case(case)
