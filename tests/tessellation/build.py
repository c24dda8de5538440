"""Specimens and nuclei for the tests of tessellations."""

from __future__ import annotations

from typing import Any

import numpy as np

from fissura.adaptivity import RefinedRegion
from fissura.case import Notch as NotchPart
from fissura.specimen import Box
from fissura.specimen.notch import notch_from_part
from fissura.tessellation import Nuclei, Tessellation, discretize, mirror_zones

SIZE = (0.12, 0.06, 0.04)
L_F = 0.008
L_C = 4 * L_F

#: Notches by a name for the test's report; the values are those of a case file.
NOTCHES: dict[str, tuple[dict[str, Any], ...]] = {
    "none": (),
    "cut": ({"position": 0.06, "depth": 0.03},),
    "saw": ({"position": 0.06, "depth": 0.03, "width": 0.004},),
    "wide": ({"position": 0.06, "depth": 0.03, "width": 0.02},),
    "asymmetric": ({"position": 0.047, "depth": 0.011},),
    "deep": ({"position": 0.06, "depth": 0.0595},),
    "shallow saw": ({"position": 0.06, "depth": 0.0005, "width": 0.004},),
    "left": ({"face": "left", "position": 0.03, "depth": 0.015},),
    "left saw": ({"face": "left", "position": 0.03, "depth": 0.015, "width": 0.004},),
    "right along z": ({"face": "right", "normal": "z", "position": 0.02, "depth": 0.05, "width": 0.002},),
    "top": ({"face": "top", "position": 0.06, "depth": 0.02},),
    "top saw": ({"face": "top", "position": 0.06, "depth": 0.02, "width": 0.004},),
    "front": ({"face": "front", "position": 0.06, "depth": 0.015},),
    "back saw along y": ({"face": "back", "normal": "y", "position": 0.03, "depth": 0.015, "width": 0.003},),
    "double edge": (
        {"position": 0.06, "depth": 0.01, "width": 0.003},
        {"face": "top", "position": 0.06, "depth": 0.01},
    ),
}


def box_with(*notches: dict[str, Any], size: tuple[float, float, float] = SIZE) -> Box:
    parts = [NotchPart.model_validate(part) for part in notches]
    return Box(size, tuple(notch_from_part(part, size, f"notch[{k}]") for k, part in enumerate(parts)))


def nuclei_in(box: Box, seed: int, l_f: float = L_F, l_c: float = L_C, given: Any = None) -> Nuclei:
    return Nuclei.placed(box, l_f, mirror_zones(box, l_f), np.random.default_rng(seed), given)


def region(box: Box, centers: Any = (), *, everywhere: bool = False, r_f: float = 2 * L_F) -> RefinedRegion:
    """Fine at the tips of all notches and around centres."""
    lines = [notch.tip_lines() for notch in box.notches]
    return RefinedRegion(
        L_F,
        L_C,
        r_f,
        2 * L_C,
        centers=np.asarray(centers, float).reshape(-1, 3),
        lines=np.concatenate([np.empty((0, 2, 3)), *lines]),
        everywhere=everywhere,
    )


def discretized(nuclei: Nuclei, box: Box, where: RefinedRegion) -> Tessellation:
    return discretize(nuclei, box, where.spacing(nuclei.x))
