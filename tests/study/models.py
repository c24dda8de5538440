"""A tiny study on disk, and synthetic records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fissura.results.curve import COLUMNS, columns
from fissura.study.definition import FULL
from fissura.study.indicators import OBSERVED
from fissura.study.record import Energies, Record

CASE = """
specimen.size = [0.1, 0.05, 0.02]
notch = { face = "bottom", position = 0.05, depth = 0.02 }
supports = [{ type = "pin", face = "bottom", at = 0.01 }, { type = "roller", face = "bottom", at = 0.09 }]
load = { face = "top", at = 0.05 }
gauge = { a = { face = "bottom", at = 0.045 }, b = { face = "bottom", at = 0.055 } }
material = { E = 60e9, alpha = 0.29, f_t = 2.2e6, G_t = 35.0 }
discretization = { l_f = 0.01, l_c = 0.02 }
adaptivity.r_f = 0.015
control = { target = 3e-5 }
"""

STUDY = """
seeds = [1, 2]
[[specimens]]
name = "beam"
case = "beam.toml"
type = "notched"
[[specimens]]
name = "deep"
case = "beam.toml"
seeds = [1]
change.notch.depth = "25 mm"
[[variations]]
name = "default"
[[variations]]
name = "wide"
seeds = [2, 3]
change.adaptivity.r_f = "20 mm"
"""


def write_study(folder: Path, text: str = STUDY, case: str = CASE) -> Path:
    """Study file of two small beams; returns its path."""
    (folder / "beam.toml").write_text(case)
    path = folder / "study.toml"
    path.write_text(text)
    return path


def energies(values: Any, centroids: Any, first: int = 0) -> Energies:
    """Contacts of nuclei (k, k + 1) from the first on."""
    k = first + np.arange(len(values))
    return Energies(np.stack([k, k + 1], axis=1), np.array(values, float), np.array(centroids, float))


def record(
    case: dict[str, Any],
    load: Any,
    *,
    gauge: Any = None,
    dissipated: Any = None,
    variation: str = FULL,
    specimen: str = "beam",
    seed: int = 1,
    status: str = "finished",
    spent: Energies | None = None,
    stiffness: float = 1e8,
    cpu: float = 1.0,
    indicators: dict[str, float] | None = None,
) -> Record:
    """A run with given loads at evenly spaced gauges up to the target."""
    load = np.array(load, float)
    n = len(load)
    rows = columns([])
    if n:
        step = np.arange(1, n + 1)
        rows = {name: np.zeros(n) for name in COLUMNS} | {
            "step": step,
            "bodies": np.full(n, 10),
            "load_N": load,
            "gauge_m": case["control"]["target"] * step / n if gauge is None else np.array(gauge, float),
            "dissipated_J": 1e-3 * step if dissipated is None else np.array(dissipated, float),
            "cpu_s": cpu * step / n,
            "linear_iterations": np.full(n, round(10 * cpu)),
            "control": np.full(n, "gauge"),
        }
    summary = {
        "full": variation == FULL,
        "initial_stiffness_N_per_m": stiffness,
        "bodies_start": 5,
        "bodies_end": 10,
        "bodies_full": 20,
        "refinements": 2,
        "cpu_s": cpu,
        "elastic_scale": 1.03,
        "cpu_repeated_s": 0.1 * cpu,
        "cpu_refining_s": 0.2 * cpu,
    }
    known = dict.fromkeys(OBSERVED, 0.5) | (indicators or {})
    return Record(
        specimen,
        seed,
        variation,
        case,
        status,
        "" if status == "finished" else "why",
        summary if n else {},
        rows,
        energies([3.0, 1.0], [[0.05, 0.02, 0.01], [0.05, 0.03, 0.01]]) if spent is None else spent,
        {} if variation == FULL else {name: np.full(n, value) for name, value in known.items()},
    )
