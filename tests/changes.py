"""Cases with values replaced, as tests write them."""

from __future__ import annotations

import copy
from typing import Any

#: Stands for a key to be removed.
ABSENT = object()


def replaced(base: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Copy of a case's data with values replaced or removed; keys are paths such as ``supports__1__at``."""
    data = copy.deepcopy(base)
    for path, value in changes.items():
        *outer, last = path.split("__")
        table: Any = data
        for part in outer:
            table = table[int(part)] if part.isdigit() else table.setdefault(part, {})
        if value is ABSENT:
            del table[last]
        else:
            table[int(last) if last.isdigit() else last] = value
    return data


#: Tables of a tiny notched beam, to be continued; what is missing is how far to load it.
TINY_BEAM = """
specimen.size = ["80 mm", "20 mm", "10 mm"]
notch = { position = "40 mm", depth = "8 mm" }
supports = [
    { type = "pin", face = "bottom", at = "10 mm" },
    { type = "roller", face = "bottom", at = "70 mm" },
]
load = { face = "top", at = "40 mm" }
gauge.a = { face = "bottom", at = "38 mm" }
gauge.b = { face = "bottom", at = "42 mm" }
material = { E = "60 GPa", alpha = 0.29, f_t = "2.2 MPa", G_t = "35 J/m^2" }
discretization = { l_f = "5 mm", l_c = "10 mm" }
output.vtk = 0
"""
