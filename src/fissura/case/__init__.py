"""Cases: what to break, how, and of what material, read from a TOML file."""

from fissura.case.field import EnergyField, Field
from fissura.case.load import case_from_dict, load_case
from fissura.case.model import (
    Adaptivity,
    BallRegion,
    BoxRegion,
    Case,
    Control,
    Discretization,
    Gauge,
    Load,
    Macro,
    Material,
    MaterialRegion,
    Notch,
    Output,
    Part,
    Patch,
    Quantity,
    Specimen,
    Support,
)
from fissura.case.plausible import case_notices

__all__ = [
    "Adaptivity",
    "BallRegion",
    "BoxRegion",
    "Case",
    "Control",
    "Discretization",
    "EnergyField",
    "Field",
    "Gauge",
    "Load",
    "Macro",
    "Material",
    "MaterialRegion",
    "Notch",
    "Output",
    "Part",
    "Patch",
    "Quantity",
    "Specimen",
    "Support",
    "case_from_dict",
    "case_notices",
    "load_case",
]
