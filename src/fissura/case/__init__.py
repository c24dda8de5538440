"""Cases: what to break, how, and of what material, read from a TOML file."""

from fissura.case.conditions import Gauge, Load
from fissura.case.ensemble import Ensemble
from fissura.case.field import Field
from fissura.case.load import case_from_dict, case_of, load_case
from fissura.case.material import Material
from fissura.case.model import Case
from fissura.case.part import Part
from fissura.case.place import Notch, Patch
from fissura.case.plausible import case_notices
from fissura.case.region import BallRegion, BoxRegion
from fissura.case.settings import Discretization
from fissura.case.shape import Specimen
from fissura.case.stages import LoadingStage, Quantity

__all__ = [
    "BallRegion",
    "BoxRegion",
    "Case",
    "Discretization",
    "Ensemble",
    "Field",
    "Gauge",
    "Load",
    "LoadingStage",
    "Material",
    "Notch",
    "Part",
    "Patch",
    "Quantity",
    "Specimen",
    "case_from_dict",
    "case_notices",
    "case_of",
    "load_case",
]
