"""Running a study: what is left to do is computed, every record is saved the moment it ends, then all are compared."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fissura.batch.cluster import check_scheduler
from fissura.batch.computing import compute_all
from fissura.batch.machines import Machines, require_packages
from fissura.files.folder import Folder, prepare_folder
from fissura.kernels import prepare_cache
from fissura.study.definition import LoadedStudy, Task
from fissura.study.execute import execute, failed, warm_up
from fissura.study.pictures import PICTURES, draw
from fissura.study.record import Record
from fissura.study.report import write_tables
from fissura.study.result import StudyResult
from fissura.study.store import check_names, split

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster

Told = Callable[[Task, Record, int], None]


def run_study(
    loaded: LoadedStudy,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | Cluster | None = None,
    again: Collection[str] = (),
    run: bool = True,
    on_start: Callable[[LoadedStudy, int, int], None] | None = None,
    on_done: Told | None = None,
) -> StudyResult:
    """Run what is left to do of a study, and compare all there is.

    A run is done when the folder has a record of the very same case; runs at full resolution do not depend on
    ``[adaptivity]`` and ``l_c``. Runs that did not finish are done, too, and are counted.

    Parameters
    ----------
    loaded : LoadedStudy
        The study.
    folder : path
        Where records are kept; made if needed. It may hold nothing else.
    workers : int, optional
        Processes of one thread each, unless environment variables say otherwise; by default 1, which is this one. A run
        whose process dies is computed again in another one, and has failed after several such deaths.
    scheduler : str or Cluster, optional
        Address of a Dask scheduler whose workers are used instead, or a cluster object of Dask.
    again : collection of str, optional
        Variations to run once more, for example after a change of the program; ``"full"`` and ``"failures"``, too.
    run : bool, optional
        False only compares what was done before.
    on_start : callable, optional
        Told before the first run: the study, the number of runs to do, and of those done before.
    on_done : callable, optional
        Told of every run that was saved, and how many are left.

    Raises
    ------
    InputError
        A name in `again` is not known, there are too many workers, the scheduler cannot be reached, or the folder
        cannot be written.
    KeyboardInterrupt, EnsembleStopped
        The user interrupts, the scheduler has gone, or no process can be started; all finished runs are saved, and the
        same call goes on.
    """
    require_packages("fissura study", scheduler)
    machines = Machines(workers, 1, scheduler)
    check_names(loaded, again)
    if scheduler is not None:
        check_scheduler(scheduler)
    folder = prepare_folder(folder, "study", go_on=True)
    own = Folder.kept(folder, "study")
    tasks = list(loaded.tasks())
    done, left = split(tasks, folder, again)
    if run and left:
        if on_start is not None:
            on_start(loaded, len(left), len(done))
        own.add(*(task.path.as_posix() for task in left))
        for task in left:  # what is to be run again must not count as done after an interruption
            (folder / task.path).unlink(missing_ok=True)
        _compute(left, folder, machines, on_done)
        done, left = split(tasks, folder)
    return StudyResult.comparing(loaded.study, done, len(left))


def _compute(tasks: Sequence[Task], folder: Path, machines: Machines, on_done: Told | None) -> None:
    """Run tasks, and save the record of each at once: in this process, if there is to be one only."""
    left = len(tasks)

    def keep(task: Task, record: Record) -> None:
        nonlocal left
        left -= 1
        record.save(folder / task.path)
        if on_done is not None:
            on_done(task, record, left)

    if machines.scheduler is None and machines.workers in (None, 1):
        prepare_cache()
        warm_up()
        for task in tasks:
            keep(task, execute(task))
        return
    if machines.workers is not None:
        machines = replace(machines, workers=min(machines.workers, len(tasks)))
    compute_all(execute, tasks, len(tasks), machines, failed=failed, keep=keep, prepare=warm_up)


def write_result(result: StudyResult, folder: str | Path) -> list[Path]:
    """Write tables and pictures of a study; returns the files.

    Raises
    ------
    InputError
        The folder holds something else, or cannot be written.
    """
    folder = prepare_folder(folder, "study", go_on=True)
    Folder.kept(folder, "study").add("runs.csv", "study.md", *PICTURES)
    return [*write_tables(result, folder), *draw(result, folder)]
