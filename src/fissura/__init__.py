"""Fissura simulates the fracture of concrete: adaptive discrete models.

Public names are imported at first use, so that ``import fissura`` stays light.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fissura.api.check import CheckReport, check
    from fissura.api.pages import report
    from fissura.calibration.result import Calibration
    from fissura.calibration.runner import calibrate
    from fissura.case import Case, case_from_dict, load_case
    from fissura.ensemble.result import EnsembleResult
    from fissura.ensemble.runner import run_ensemble
    from fissura.ensemble.sweep import sweep
    from fissura.errors import InputError, RunStopped
    from fissura.results import Result
    from fissura.results.compare import compare
    from fissura.results.comparison import Comparison
    from fissura.running.run import run
    from fissura.simulation.loop import Simulation

    __version__: str

__all__ = [
    "Calibration",
    "Case",
    "CheckReport",
    "Comparison",
    "EnsembleResult",
    "InputError",
    "Result",
    "RunStopped",
    "Simulation",
    "__version__",
    "calibrate",
    "case_from_dict",
    "check",
    "compare",
    "load_case",
    "report",
    "run",
    "run_ensemble",
    "sweep",
]

_HOME = {
    "Calibration": "fissura.calibration.result",
    "Case": "fissura.case",
    "CheckReport": "fissura.api.check",
    "Comparison": "fissura.results",
    "EnsembleResult": "fissura.ensemble.result",
    "InputError": "fissura.errors",
    "Result": "fissura.results",
    "RunStopped": "fissura.errors",
    "Simulation": "fissura.simulation.loop",
    "case_from_dict": "fissura.case",
    "check": "fissura.api.check",
    "compare": "fissura.results",
    "calibrate": "fissura.calibration.runner",
    "load_case": "fissura.case",
    "report": "fissura.api.pages",
    "run": "fissura.running.run",
    "run_ensemble": "fissura.ensemble.runner",
    "sweep": "fissura.ensemble.sweep",
}


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name == "__version__":
        value: Any = _version()
    elif name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names, also those that are not imported yet: what notebooks complete."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})


def _version() -> str:
    """Version of the installed package."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("fissura")
    except PackageNotFoundError:  # run from a source tree
        return "unknown"
