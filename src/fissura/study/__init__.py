"""Studies: many adaptive runs against the same specimens at full resolution, and what they say together."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING

from fissura.machine.threads import side_by_side
from fissura.study.plan import LoadedPlan, load_plan, plan_from_dict

if TYPE_CHECKING:
    from fissura.study.outcome import Outcome
    from fissura.study.plan import Task
    from fissura.study.record import Record

__all__ = ["LoadedPlan", "load_plan", "plan_from_dict", "run_study", "write_outcome"]


def run_study(
    plan: LoadedPlan,
    folder: str | Path,
    *,
    workers: int = 1,
    again: Collection[str] = (),
    run: bool = True,
    on_start: Callable[[LoadedPlan, int, int], None] | None = None,
    on_done: Callable[[Task, Record, int], None] | None = None,
) -> Outcome:
    """Run what is left to do of a study, and compare all there is.

    A run is done when the folder has a record of the very same case; runs at full resolution do not depend on
    ``[adaptivity]`` and ``l_c``. Runs that did not finish are done, too, and are counted.

    Parameters
    ----------
    plan : LoadedPlan
        The study.
    folder : path
        Where records are kept; made if needed. It may hold nothing else.
    workers : int, optional
        Processes that run at the same time.
    again : collection of str, optional
        Variations to run once more, for example after a change of the program; ``"full"`` and ``"failures"``, too.
    run : bool, optional
        False only compares what was done before.
    on_start : callable, optional
        Told before the first run: the plan, the number of runs to do, and of those done before.
    on_done : callable, optional
        Told of every run that was saved, and how many are left.

    Raises
    ------
    InputError
        A name in `again` is not known, there are too many workers, or the folder cannot be written.
    KeyboardInterrupt, StudyStopped
        The user interrupts, or no process can be started; all finished runs are saved, and the same call goes on.
    """
    from fissura.files.folder import Folder, prepare_folder
    from fissura.study.outcome import outcome_of
    from fissura.study.pool import run_tasks
    from fissura.study.store import check_names, split

    workers = side_by_side("--workers", workers)
    check_names(plan, again)
    folder = prepare_folder(folder, "study", go_on=True)
    own = Folder.kept(folder, "study")
    tasks = list(plan.tasks())
    done, left = split(tasks, folder, again)
    if run and left:
        count = len(left)
        if on_start is not None:
            on_start(plan, count, len(done))
        own.add(*(task.path.as_posix() for task in left))
        for task in left:  # what is to be run again must not count as done after an interruption
            (folder / task.path).unlink(missing_ok=True)

        def told(task: Task, record: Record) -> None:
            nonlocal count
            count -= 1
            if on_done is not None:
                on_done(task, record, count)

        run_tasks(left, folder, workers, told)
        done, left = split(tasks, folder)
    return outcome_of(plan.plan, done, len(left))


def write_outcome(outcome: Outcome, folder: str | Path) -> list[Path]:
    """Write tables and pictures of a study; returns the files.

    Raises
    ------
    InputError
        The folder holds something else, or cannot be written.
    """
    from fissura.files.folder import Folder, prepare_folder
    from fissura.study.pictures import PICTURES, draw
    from fissura.study.report import write_tables

    folder = prepare_folder(folder, "study", go_on=True)
    Folder.kept(folder, "study").add("runs.csv", "study.md", *PICTURES)
    return [*write_tables(outcome, folder), *draw(outcome, folder)]
