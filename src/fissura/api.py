"""Running a case from Python."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from fissura.case import Case, load_case
from fissura.case.types import whole
from fissura.case.units import show
from fissura.errors import FissuraError, InputError, RunStopped
from fissura.folder import prepare_folder
from fissura.interrupts import shielded
from fissura.memory import require_memory

if TYPE_CHECKING:
    from fissura.results import Result
    from fissura.results.recorder import Recorder
    from fissura.simulation import Simulation
    from fissura.step import Step

__all__ = ["run"]

logger = logging.getLogger(__name__)


def run(
    case: Case | str | Path,
    *,
    full: bool = False,
    output: str | Path | None = None,
    overwrite: bool = False,
    seed: int | None = None,
    on_start: Callable[[Simulation], None] | None = None,
    on_step: Callable[[Step], None] | None = None,
) -> Result:
    """Run a case until its control target is reached.

    Parameters
    ----------
    case : Case or path
        Case, or the TOML file that describes it.
    full : bool, optional
        Full resolution everywhere from the start instead of adaptive refinement.
    output : path, optional
        Folder for the results; None keeps them in memory only.
    overwrite : bool, optional
        Whether the folder may hold an earlier run, whose files are replaced; nothing else in it is touched.
    seed : int, optional
        Replaces the seed of the case.
    on_start : callable, optional
        Called with the simulation before its first step.
    on_step : callable, optional
        Called with every accepted step, after it was recorded.

    Returns
    -------
    Result
        Curve, summary and snapshots.

    Raises
    ------
    InputError
        If the case, a file it names, or the output folder is wrong; nothing has been computed then.
    RunStopped
        If the run cannot go on. Everything up to then is saved; its attribute ``result`` holds it.
    KeyboardInterrupt
        If the user interrupts; saved as before, attribute ``result`` as before.
    OSError
        If a file cannot be written; what could be written is saved, attribute ``result`` as before.
    """
    if not isinstance(case, Case):
        case = load_case(case)
    if seed is not None:
        case = with_seed(case, seed)
    folder = None if output is None else prepare_folder(output, "run", overwrite=overwrite)
    require_memory(case, full=full)

    from fissura.results.measured import read_measured
    from fissura.simulation import Simulation

    if case.output.measured is not None:
        read_measured(case.output.measured)  # the pictures need it at the end: say now if it is wrong
    simulation = Simulation(case, full=full)
    for notice in simulation.notices:
        logger.warning(notice)
    if on_start is not None:
        on_start(simulation)
    return _recorded(simulation, folder, on_step)


def _recorded(simulation: Simulation, folder: Path | None, on_step: Callable[[Step], None] | None) -> Result:
    """Step to the end, recording; save whatever there is when the run ends early."""
    from fissura.results.recorder import Recorder

    number, controlled = 0, 0.0
    recorder: Recorder | None = None
    try:
        with shielded():
            recorder = Recorder(simulation, folder)
        for step in simulation.steps():
            recorder.add(step)
            number, controlled = step.number, step.controlled
            if on_step is not None:
                on_step(step)
    except (RunStopped, MemoryError) as error:
        if recorder is None:
            raise
        stop = error if isinstance(error, RunStopped) else RunStopped("out of memory", number + 1, controlled)
        stop.result = recorder.finish("stopped", str(stop))  # type: ignore[attr-defined]
        raise stop from (None if stop is error else error)
    except KeyboardInterrupt as error:
        if recorder is not None:
            error.result = recorder.finish("interrupted", f"interrupted after step {number}")  # type: ignore[attr-defined]
        raise
    except BaseException as error:
        if recorder is not None:
            status = "refused" if isinstance(error, InputError) else "failed"
            message = str(error) if isinstance(error, FissuraError) else f"{type(error).__name__}: {error}"
            if isinstance(error, OSError):
                message = f"a file could not be written: {error.strerror or error}"
            with suppress(Exception):  # the first error is the one to tell
                error.result = recorder.finish(status, message)  # type: ignore[attr-defined]
        raise
    return recorder.finish("finished")


def with_seed(case: Case, seed: int) -> Case:
    """Return the case with another seed.

    Raises
    ------
    InputError
        If the seed is not a whole number, 0 or larger.
    """
    number = whole(seed)
    if number is None or not 0 <= number < 2**63:
        raise InputError("seed", f"{show(seed)} is not possible", "a whole number, 0 or larger")
    return case.model_copy(update={"seed": number})
