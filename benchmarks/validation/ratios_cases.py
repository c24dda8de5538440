"""Prisms in direct tension, beams in bending and discs that split, of the material of Grégoire's beam: `ratios.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import above  # noqa: F401
import numpy as np
from numpy.typing import NDArray

from common import example
from fissura import Case
from fissura.case import case_from_dict

FloatArray = NDArray[np.float64]

#: Depths of beams [m], their thickness and that of prisms and discs [m], diameter of discs [m].
DEPTHS, SIDE, DIAMETER = (0.05, 0.1, 0.2), 0.06, 0.15
#: Bodies of the main runs [m].
L_F = 0.01
#: Loads of discs: strips over the diameter, depth of the elastic zones under them, half of their width [m], that of
#: the template first; a peak is followed by such a fall [1].
STRIP, ZONES, FALL = 0.1, (0.02, 0.012), 0.02
#: Widening of the disc at which its run ends [m].
WIDENED = 60e-6


@dataclass(frozen=True)
class Test:
    """A specimen: its case, and its strength [Pa] from loads [N] of its curve."""

    name: str
    case: Case
    strength: Callable[[FloatArray], float]


def _case(
    specimen: dict[str, Any], toughness: float, l_f: float, elastic: list[dict[str, Any]], depth: float = 0.1
) -> Case:
    fitted = example("gregoire_d50_halfnotch", 1).material
    return case_from_dict(
        {
            "material": {
                "E": fitted.E,
                "alpha": fitted.alpha,
                "f_t": fitted.f_t,
                "G_t": toughness * fitted.G_t,
                "elastic": elastic,
            },
            "discretization": {"l_f": l_f, "l_c": min(4.0 * l_f, 0.4 * depth)},
            "output": {"vtk": 0},
            **specimen,
        }
    )


def pulled(toughness: float = 1.0, l_f: float = L_F) -> Test:
    """A prism in direct tension; its ends are elastic."""
    end, length = 0.5 * SIDE, 3.0 * SIDE
    boxes = [([0.0, 0.0, 0.0], [end, SIDE, SIDE]), ([length - end, 0.0, 0.0], [length, SIDE, SIDE])]
    specimen = {
        "specimen": {"size": [length, SIDE, SIDE]},
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "right", "direction": [1, 0, 0]},
        "gauge": {"a": {"face": "top", "at": end}, "b": {"face": "top", "at": length - end}},
        "control": {"type": "dissipation", "target": 1e-3, "max_step": 2e-6, "energy_step": 0.01, "stop_load": 0.8},
    }
    elastic = [{"type": "box", "lower": lower, "upper": upper} for lower, upper in boxes]
    return Test("direct tension", _case(specimen, toughness, l_f, elastic), lambda load: load.max() / SIDE**2)


def bent(depth: float, toughness: float = 1.0, l_f: float = L_F) -> Test:
    """A beam with loads at the third points of a span of three depths."""
    span, rest = 3.0 * depth, 0.25 * depth
    middle, half = rest + 0.5 * span, 0.6 * depth
    specimen = {
        "specimen": {"size": [3.5 * depth, depth, SIDE]},
        "supports": [
            {"type": "pin", "face": "bottom", "at": rest},
            {"type": "roller", "face": "bottom", "at": rest + span},
        ],
        "loads": {
            "left": {"face": "top", "at": rest + span / 3.0},
            "right": {"face": "top", "at": rest + 2.0 * span / 3.0},
        },
        "gauges": {
            "lower": {"a": {"face": "bottom", "at": middle - half}, "b": {"face": "bottom", "at": middle + half}}
        },
        "stage": [
            {
                "load": {"left": 0.5, "right": 0.5},
                "control": "dissipation",
                "to": 1e-3,
                "max_step": 2e-6 * (depth / 0.05) ** 0.5,
                "energy_step": 0.01,
                "stop_load": 0.9,
            }
        ],
    }
    return Test(
        f"bending, {1e3 * depth:g} mm deep",
        _case(specimen, toughness, l_f, [], depth),
        lambda load: load.max() * span / (SIDE * depth**2),
    )


def split(toughness: float = 1.0, zone: float = ZONES[0]) -> Test:
    """A disc between strips: the first peak, after which the load falls; what the halves carry later is left out."""
    radius = 0.5 * DIAMETER
    zones = [([-zone, -1.0, -1.0], [zone, zone - radius, 1.0]), ([-zone, radius - zone, -1.0], [zone, 1.0, 1.0])]
    specimen = {
        "specimen": {"cylinder": {"diameter": DIAMETER, "length": SIDE, "axis": "z"}},
        "supports": [{"type": "clamp", "on": "lateral", "toward": [0, -1, 0], "width": STRIP * DIAMETER}],
        "load": {"on": "lateral", "toward": [0, 1, 0], "width": STRIP * DIAMETER, "direction": [0, -1, 0]},
        "gauge": {
            "a": {"on": "lateral", "toward": [-1, 0, 0], "width": 0.02},
            "b": {"on": "lateral", "toward": [1, 0, 0], "width": 0.02},
        },
        "control": {
            "type": "dissipation",
            "target": WIDENED,
            "max_step": 1e-6,
            "energy_step": 0.01,
            "stop_load": 0.9,
        },
    }
    elastic = [{"type": "box", "lower": lower, "upper": upper} for lower, upper in zones]
    return Test(
        f"splitting, elastic to a depth of {1e3 * zone:g} mm",
        _case(specimen, toughness, L_F, elastic),
        lambda load: 2.0 * first_peak(load) / (np.pi * DIAMETER * SIDE),
    )


def first_peak(load: FloatArray) -> float:
    """Largest load before it falls by `FALL` for the first time; not a number where it never does."""
    peaks = np.maximum.accumulate(load)
    fallen = np.flatnonzero(load < (1.0 - FALL) * peaks)
    return float(peaks[fallen[0]]) if len(fallen) else float("nan")
