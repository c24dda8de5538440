"""Material: parameters of the contact law, later random fields."""

from __future__ import annotations

from fissura.material.parameters import Material, material_from_case

__all__ = ["Material", "material_from_case"]
