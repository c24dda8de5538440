"""Running a case from Python."""

import logging
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from pathlib import Path
from typing import Any

from rich.console import Console

from fissura.case import Case, case_of
from fissura.case.continued import continued
from fissura.case.types import whole
from fissura.case.units import show
from fissura.errors import FissuraError, InputError, RunStopped
from fissura.files.folder import prepare_folder
from fissura.files.lock import locked
from fissura.kernels import prepare_cache
from fissura.machine.interrupts import shielded
from fissura.progress.live import RunProgress
from fissura.results.measured import read_measured
from fissura.results.result import Result
from fissura.results.summary import read_summary
from fissura.running.checkpoint import Checkpoint, checkpoint_in, read_checkpoint
from fissura.running.recorder import Recorder
from fissura.running.resuming import Begun, begun
from fissura.simulation.loop import Simulation
from fissura.simulation.memory import require_memory
from fissura.simulation.observer import Observer, watched
from fissura.simulation.state import State
from fissura.simulation.step import Step

logger = logging.getLogger(__name__)


def run(
    case: Case | Mapping[str, Any] | str | Path,
    *,
    full: bool = False,
    output: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    seed: int | None = None,
    on_start: Callable[[Simulation], None] | None = None,
    on_step: Callable[[Step], None] | None = None,
    observers: Iterable[Observer] = (),
    progress: bool | None = None,
) -> Result:
    """Run a case until its control target is reached.

    Parameters
    ----------
    case : Case, mapping or path
        Case; tables and keys as in a case file, as nested dictionaries; or the TOML file that describes it.
    full : bool, optional
        Full resolution everywhere from the start instead of adaptive refinement.
    output : path, optional
        Folder for the results; None keeps them in memory only.
    overwrite : bool, optional
        Whether the folder may hold an earlier run, whose files are replaced; nothing else in it is touched.
    resume : bool, optional
        Go on with the run in the folder, from its latest checkpoint, to the target of this case; all but name, output,
        targets and threads must be as it was. A run that has reached the target is left as it is, and loaded.
    seed : int, optional
        Replaces the seed of the case.
    on_start : callable, optional
        Called with the simulation before its first step here; not at all if there is nothing to do.
    on_step : callable, optional
        Called with every accepted step, after it was recorded.
    observers : iterable of callable, optional
        Called with the state of the run and the step, likewise.
    progress : bool, optional
        Whether a line tells how far the run is; by default in notebooks only. Elsewhere it goes to standard error.

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

    Examples
    --------
    >>> result = fissura.run(case, output="results/run")
    >>> result.status
    'finished'
    >>> loads = []
    >>> other = fissura.run(case, seed=2, on_step=lambda step: loads.append(step.load))
    >>> loads == other.load_values.tolist()
    True
    """
    case = case_of(case)
    if seed is not None:
        case = with_seed(case, seed)

    prepare_cache()
    if resume:
        if output is None or overwrite:
            raise InputError(
                "--resume", "goes on with the run in a folder, and does not replace it", "output, and no --overwrite"
            )

        checkpoint_in(Path(output))
    folder = None if output is None else prepare_folder(output, "run", overwrite=overwrite, go_on=resume)
    with locked(folder), _shown(case, progress) as shown:
        checkpoint: Checkpoint | None = None
        if resume and folder is not None:
            case, checkpoint = _begins_from(folder, case, full=full)
        require_memory(case, full=full)

        if case.output.measured is not None:
            read_measured(case.output.measured)  # the pictures need it at the end: say now if it is wrong
        simulation = Simulation(case, full=full)
        before = None if checkpoint is None else begun(simulation, checkpoint)
        if before is not None and folder is not None and simulation.ended and _is_finished(folder):
            return Result.load(folder)
        for notice in simulation.notices:
            logger.warning(notice)
        if shown is not None:
            shown.start(simulation)
        if on_start is not None:
            on_start(simulation)
        told: list[Observer] = [
            lambda _, step, tell=tell: tell(step)  # type: ignore[misc]
            for tell in (None if shown is None else shown.step, on_step)
            if tell is not None
        ]
        return _recorded(simulation, folder, before, (*told, *observers))


def _shown(case: Case, progress: bool | None) -> AbstractContextManager[RunProgress | None]:
    """What shows the progress of a run, if anything does; a notebook has IPython loaded."""
    if progress is False or (progress is None and "IPython" not in sys.modules):
        return nullcontext()

    console = Console(stderr=True)
    return RunProgress(console, case) if progress or console.is_jupyter else nullcontext()


def _begins_from(folder: Path, case: Case, *, full: bool) -> tuple[Case, Checkpoint]:
    """The case with which a run goes on, and the checkpoint from which it does."""
    found = read_checkpoint(folder)
    if found.full != full:
        kind = "at full resolution" if found.full else "adaptive"
        raise InputError("--full", f"the run in {folder} is {kind}", "the same, with --resume")
    return continued(case, found.case, found.leg, found.begin, finished=_is_finished(folder)), found


def _is_finished(folder: Path) -> bool:
    """Whether a run has written all that belongs to its end."""
    try:
        return read_summary(folder / "summary.json").get("status") == "finished"
    except InputError:
        return False


def _recorded(
    simulation: Simulation, folder: Path | None, before: Begun | None, observers: tuple[Observer, ...]
) -> Result:
    """Step to the end, recording; save whatever there is when the run ends early."""
    number = 0 if before is None else before.last.number
    controlled = 0.0 if before is None else before.last.controlled
    recorder: Recorder | None = None

    def count(_: State, step: Step) -> None:
        nonlocal number, controlled
        number, controlled = step.number, step.controlled

    try:
        with shielded():
            recorder = Recorder(simulation, folder, before)
        watched(simulation, recorder.watch, count, *observers)
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
