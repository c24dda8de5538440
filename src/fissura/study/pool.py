"""Runs the tasks of a study that are not done yet, in this process or in several."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path

from fissura.batch.processes import ProcessesLost, computed
from fissura.errors import StudyStopped
from fissura.kernels import prepare_cache
from fissura.machine.threads import threads_each
from fissura.study.execute import execute, head_of, warm_up
from fissura.study.plan import Task
from fissura.study.record import Record

__all__ = ["run_tasks"]

Told = Callable[[Task, Record], None]


def run_tasks(tasks: Sequence[Task], folder: Path, workers: int = 1, on_done: Told | None = None) -> None:
    """Run tasks, and save the record of each at once.

    Parameters
    ----------
    tasks : sequence of Task
        What to run, in this order.
    folder : Path
        Folder of the study; only this process writes to it.
    workers : int
        Processes, of one thread each unless environment variables say otherwise; 1 runs in this one. A task whose
        process dies is run again in another one, and has failed after several such deaths.
    on_done : callable, optional
        Told of every record that was saved.

    Raises
    ------
    KeyboardInterrupt
        The user interrupts; what was finished is saved.
    StudyStopped
        No process can be started.
    """
    if not tasks:
        return
    prepare_cache()

    def save(task: Task, record: Record) -> None:
        record.save(folder / task.path)
        if on_done is not None:
            on_done(task, record)

    if workers == 1:
        warm_up()
        for task in tasks:
            save(task, execute(task))
        return
    with threads_each(), closing(computed(execute, tasks, min(workers, len(tasks)), warm_up)) as found:
        try:
            for task, record in found:
                save(task, _lost(task) if record is None else record)
        except ProcessesLost as error:
            raise StudyStopped(str(error)) from error


def _lost(task: Task) -> Record:
    message = "the processes that ran it died, perhaps for lack of memory"
    return Record(**head_of(task), status="failed", message=message)
