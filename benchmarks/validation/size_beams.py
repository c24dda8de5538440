"""Beams of Grégoire's series, and how many of each are run: for sizes.py."""

from __future__ import annotations

from typing import Any

from fissura import Case
from fissura.case import case_from_dict

DEPTHS = (50, 100, 200, 400)
NOTCHES = (0.0, 0.2, 0.5)
#: Realisations by depth, and of those without a notch where they are fewer.
RUNS, UNNOTCHED = {50: 5, 100: 5, 200: 3, 400: 2}, {200: 2, 400: 1}
#: Span and length over depth, as in the tests; thickness [m].
SPAN, LENGTH, THICKNESS = 2.5, 3.5, 0.05
#: Runs for the strength end when the load has fallen to this part of its peak: up to 100 mm, above, largest unnotched.
STOP, STOP_LARGE, STOP_LARGEST = 0.8, 0.9, 0.95
#: Beams that run to the end of the tail, how many of each, and the part of the peak at which the tail ends.
WORK, WORK_RUNS, TAIL = ((50, 0.2), (50, 0.5), (100, 0.5), (200, 0.5)), 3, 0.01
#: Part of the peak up to which prisms in direct tension were pulled apart, in benchmarks/meaning.py.
PRISM = 0.05


def beam(depth: float, notch: float, fitted: Case, *, tail: bool = False) -> Case:
    """A beam of a depth [m] with a notch through a part of it, of the fitted material.

    Contacts within a tenth of the depth of supports and load have no damage: at 400 mm the load, which acts on a line,
    would crush what is below it. Only beams that run to the end of the tail, up to 200 mm, have damage there.
    """
    middle, rest = 0.5 * LENGTH * depth, 0.5 * (LENGTH - SPAN) * depth
    half = 0.08 * depth if notch else 0.7 * depth  # of the length of the gauge
    scale = depth / 0.05
    large = STOP_LARGEST if depth > 0.3 and not notch else STOP_LARGE
    stop = TAIL if tail else STOP if depth < 0.15 else large
    case: dict[str, Any] = {
        "name": f"depth {1e3 * depth:g} mm, notch {notch:g}",
        "specimen": {"size": [LENGTH * depth, depth, THICKNESS]},
        "supports": [
            {"type": "pin", "face": "bottom", "at": rest},
            {"type": "roller", "face": "bottom", "at": rest + SPAN * depth},
        ],
        "load": {"face": "top", "at": middle},
        "gauge": {
            "a": {"face": "bottom", "at": middle - half},
            "b": {"face": "bottom", "at": middle + half},
        },
        "material": {name: getattr(fitted.material, name) for name in ("E", "alpha", "f_t", "G_t")},
        "discretization": {"l_f": fitted.discretization.l_f, "l_c": fitted.discretization.l_c},
        "adaptivity": {"r_f": fitted.adaptivity.r_f},
        "control": {
            "type": "gauge" if notch else "dissipation",
            "target": (2e-3 if tail else 0.19e-3) * scale,
            "max_step": (4e-6 if tail else 2e-6) * scale**0.5,
            "stop_load": stop,
        },
        "output": {"vtk": 0},
    }
    if notch:
        case["notch"] = {"face": "bottom", "position": middle, "depth": notch * depth, "width": 0.002}
    if not tail:
        places = ((middle, 0.9 * depth), (rest, 0.0), (rest + SPAN * depth, 0.0))
        case["material"]["elastic"] = [
            {"type": "box", "lower": [x - 0.1 * depth, y, 0.0], "upper": [x + 0.1 * depth, y + 0.1 * depth, THICKNESS]}
            for x, y in places
        ]
    return case_from_dict(case)


def realisations(depth: int, notch: float) -> int:
    """How many beams of a depth [mm] are run for their strength."""
    return RUNS[depth] if notch else UNNOTCHED.get(depth, RUNS[depth])
