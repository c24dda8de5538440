"""Cases for tests of runs that go on from a state."""

from __future__ import annotations

from typing import Any

#: Cases of which each has something else that must be remembered.
REMEMBERED: dict[str, dict[str, Any]] = {
    "refinement": {"adaptivity__r_f": 0.012},
    "full resolution": {},
    "coarsening": {
        "material__G_t": 4.0,
        "discretization__l_f": 0.006,
        "discretization__l_c": 0.02,
        "adaptivity__r_f": 0.05,
        "adaptivity__coarsen": True,
        "adaptivity__gamma_coarse": 0.7,
        "control__stop_load": 0.2,
    },
    "field": {"field": {"length": 0.03}, "adaptivity__r_f": 0.012},
    "energy": {"control__type": "dissipation", "control__stop_load": 0.3, "material__G_t": 8.0},
    "stages": {
        "control": None,
        "gravity": {"density": 2400.0},
        "loads": {"side": {"face": "right", "at": 0.03, "along": "y"}},
        "stage": [
            {"load": "side", "control": "force", "to": 50.0},
            {"load": "load", "to": [2e-5, "10 % of load", 4e-5, "50 % of peak"]},
            {"load": "load", "to": 5e-5},
        ],
        "adaptivity__r_f": 0.012,
    },
    "platens": {
        "load": {"face": "top", "at": 0.06, "width": 0.01, "platen": {"contact": "frictionless", "turning": "hinged"}},
        "supports__0__width": 0.01,
        "supports__0__platen": "glued",
        "adaptivity__r_f": 0.012,
    },
    "two levels": {"adaptivity__r_f": 0.012, "solver__linear": "two-level"},
    "blocks": {
        "discretization": {"l_f": 0.004, "l_c": 0.016, "placement": "blocks"},
        "adaptivity": {"r_f": 0.008, "r_c": 0.024},
        "control__target": 5e-5,
    },
    "closing": {"material__law": "cusatis-cedolin-closing"},
}
