"""The numbers that describe a run in short, as ``summary.json``."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import psutil

from fissura.adaptivity.estimate import load_error_bound
from fissura.errors import InputError
from fissura.files.atomic import plain, write_json
from fissura.files.tables import read_json
from fissura.results.curve import Curve, peak_position
from fissura.results.notices import curve_notices
from fissura.results.provenance import commit, machine, now, versions

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

#: Largest summary that is read.
_MOST_BYTES = 50_000_000

_SUMS = ("refinements", "coarsenings", "iterations", "linear_iterations", "factorizations")

FORMAT_VERSION = 1
"""Version of the layout of a result folder."""


def build_summary(
    simulation: Simulation,
    curve: Curve,
    *,
    status: str,
    message: str,
    cpu_s: float,
    wall_s: float,
    memory: float,
) -> dict[str, Any]:
    """Summary of a run up to now.

    Parameters
    ----------
    simulation : Simulation
        The run.
    curve : Curve
        Its curve so far, may be empty.
    status : str
        ``"running"``, ``"finished"``, ``"stopped"``, ``"interrupted"``, ``"refused"`` or ``"failed"``.
    message : str
        Why it stopped, or ``""``.
    cpu_s, wall_s : float
        Processor and wall time since the simulation was built [s].
    memory : float
        Largest memory [bytes].

    Returns
    -------
    dict
        Only strings, booleans, numbers, None (for "unknown"), lists and dicts of them. The keys are
        documented in ``docs/files.md``.
    """
    case = simulation.case
    numbers = curve_numbers(curve)
    used = numbers["max_elastic_utilisation"]
    bound, of_calibration = None, simulation.calibration_error
    if not simulation.full and used is not None:
        bound = load_error_bound(used, case.adaptivity.r_f / case.discretization.l_f, of_calibration or 0.0)
    summary = {
        "format_version": FORMAT_VERSION,
        "case": case.name,
        "status": status,
        "message": message,
        "full": simulation.full,
        "seed": case.seed,
        "criterion": case.adaptivity.criterion,
        "field": _field(simulation),
        "controlled": case.quantity,
        **numbers,
        "initial_stiffness_N_per_m": simulation.initial_stiffness if numbers["steps"] else None,
        "elastic_scale": simulation.elastic_scale,
        "calibration_error": of_calibration,
        "load_error_bound": bound,
        "tolerance": case.adaptivity.tolerance,
        "bodies_start": simulation.bodies_start,
        "bodies_full": simulation.bodies_full,
        "bodies_full_estimated": simulation.bodies_full_estimated,
        "nuclei_given": simulation.nuclei_given,
        "nuclei_added": simulation.bodies_full - simulation.nuclei_given,
        "cpu_s": cpu_s,
        "cpu_repeated_s": simulation.cpu_repeated,
        "cpu_refining_s": simulation.cpu_refining,
        "wall_s": wall_s,
        "peak_memory_MB": memory / 1e6,
        "warnings": [str(notice) for notice in (*simulation.notices, *curve_notices(case, curve, bound))],
        "versions": versions(),
        "commit": commit(),
        "machine": machine(),
        "date": now(),
    }
    return dict(plain(summary))


def curve_numbers(curve: Curve) -> dict[str, Any]:
    """What a summary tells of a curve alone, which may be empty."""
    steps = len(curve["step"])
    peak = peak_position(curve["load_N"]) if steps else None
    iterations, work = int(curve["iterations"].sum()), _last(curve, "work_J")
    stored, dissipated, exchanged = (_last(curve, f"{name}_J") for name in ("stored", "dissipated", "exchanged"))
    numbers = {
        "peak_load_N": None if peak is None else curve["load_N"][peak],
        "gauge_at_peak_m": None if peak is None else curve["gauge_m"][peak],
        "load_displacement_at_peak_m": None if peak is None else curve["load_displacement_m"][peak],
        "gauge_at_end_m": _last(curve, "gauge_m"),
        "dissipated_energy_J": dissipated,
        "stored_J": stored,
        "work_J": work,
        "exchanged_J": exchanged,
        "energy_balance_error": (work + exchanged - stored - dissipated) / work if work else None,
        "unbalanced_force": _unbalanced(curve, "unbalanced_N"),
        "unbalanced_arm_m": _unbalanced(curve, "unbalanced_Nm"),
        "max_elastic_utilisation": _largest(curve["max_elastic_utilisation"]),
        "bodies_end": _last(curve, "bodies"),
        "steps": steps,
        "steps_led_by_energy": (curve["control"] == "dissipation").sum(),
        **{name: curve[name].sum() for name in _SUMS},
        "iterations_per_step": iterations / steps if steps else None,
    }
    return dict(plain(numbers))


def _unbalanced(curve: Curve, name: str) -> float | None:
    """Largest value of a column over the largest load; None without a load."""
    load = np.abs(curve["load_N"]).max(initial=0.0)
    return float(curve[name].max() / load) if load else None


def _field(simulation: Simulation) -> dict[str, Any] | None:
    """Seed of the random field, and how well its expansion represents it; None without a field."""
    field = getattr(simulation, "field", None)
    if field is None:
        return None
    found = dataclasses.asdict(field.accuracy)
    return {
        "seed": field.seed,
        **{name: found[name] for name in ("method", "nodes", "modes")},
        "spacing_m": list(found["spacing"]),
        "variance_error": found["mean"],
        "variance_error_max": found["largest"],
    }


def peak_memory() -> float:
    """Largest resident memory of this process since it started [bytes]."""
    if sys.platform == "win32":
        return float(psutil.Process().memory_info().peak_wset)
    status = Path("/proc/self/status")
    if status.exists():  # Linux: what getrusage tells there includes the process that started this one
        peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return 1024.0 * float(peak.split()[1])
    import resource

    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # macOS counts bytes, others kibibytes.
    return float(largest) if sys.platform == "darwin" else float(largest) * 1024


def write_summary(path: Path, summary: dict[str, Any]) -> None:
    """Write strict JSON (no NaN), never leaving half a file."""
    write_json(path, summary)


def read_summary(path: str | Path) -> dict[str, Any]:
    """Read a ``summary.json`` (or that of a result folder), or another JSON file of ours.

    Raises
    ------
    InputError
        The file is missing, is not JSON, or has a layout newer than this version of Fissura.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "summary.json"
    allowed = f"the {path.name} of a Fissura {'ensemble' if path.name == 'ensemble.json' else 'run'}"
    summary = read_json(path, allowed, tables=False, most=_MOST_BYTES)
    version = summary.get("format_version") if isinstance(summary, dict) else None
    if not isinstance(version, int) or version > FORMAT_VERSION:
        raise InputError(str(path), f"format_version is {version}", f"{allowed}, of version 1 to {FORMAT_VERSION}")
    return dict(summary)


def result_folder(folder: str | Path) -> Path:
    """Folder of a run's results.

    Raises
    ------
    InputError
        There is no such folder, or no run has left anything in it. The key is a path that tells, for ``"."``, too.
    """
    folder = Path(folder)
    shown = folder.resolve() if folder.name in ("", "..") else folder
    if not folder.is_dir():
        raise InputError(str(shown), "there is no such folder", "the folder of a Fissura run")
    if not (folder / "summary.json").exists():
        raise InputError(str(shown), "holds no results of a run (no summary.json)", "the folder of a Fissura run")
    return folder


def _last(curve: Curve, name: str) -> Any:
    return curve[name][-1] if len(curve[name]) else None


def _largest(values: Any) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else None
