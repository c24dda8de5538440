"""Runs the tasks of a study that are not done yet, in this process or in several."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from multiprocessing.synchronize import Event
from pathlib import Path

from fissura.errors import FissuraError
from fissura.study.execute import execute, warm_up
from fissura.study.plan import Task
from fissura.study.record import Record
from fissura.threads import threads_each

__all__ = ["run_tasks"]

Told = Callable[[Task, Record], None]

_interrupted: Event | None = None


def run_tasks(tasks: Sequence[Task], folder: Path, workers: int = 1, on_done: Told | None = None) -> None:
    """Run tasks, and save the record of each at once.

    Parameters
    ----------
    tasks : sequence of Task
        What to run, in this order.
    folder : Path
        Folder of the study.
    workers : int
        Processes, of one thread each unless environment variables say otherwise; 1 runs in this one.
    on_done : callable, optional
        Told of every record that was saved.

    Raises
    ------
    KeyboardInterrupt
        The user interrupts; what was finished is saved.
    FissuraError
        A process died.
    """
    if not tasks:
        return
    if workers == 1:
        warm_up()
        for task in tasks:
            record = execute(task)
            record.save(folder / task.path)
            if on_done is not None:
                on_done(task, record)
        return
    context = get_context("spawn")  # a forked copy of threads of numerical libraries may hang
    event = context.Event()
    with (
        threads_each(),
        ProcessPoolExecutor(min(workers, len(tasks)), context, initializer=_begin, initargs=(event,)) as pool,
    ):
        waiting = {pool.submit(_run_and_save, task, folder): task for task in tasks}
        try:
            _collect(waiting, on_done)
        except BrokenProcessPool as error:
            raise FissuraError(
                "a process of the study died, perhaps for lack of memory; what was finished is saved"
            ) from error
        except BaseException:
            event.set()  # workers give up after the step they are in
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _collect(waiting: dict[Future[Record | None], Task], on_done: Told | None) -> None:
    while waiting:
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            task, record = waiting.pop(future), future.result()
            if on_done is not None and record is not None:
                on_done(task, record)


def _begin(event: Event) -> None:
    """Prepare a worker: the process that started it decides about interruptions."""
    global _interrupted
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _interrupted = event
    warm_up()


def _run_and_save(task: Task, folder: Path) -> Record | None:
    assert _interrupted is not None
    if _interrupted.is_set():
        return None
    try:
        record = execute(task, _interrupted.is_set)
    except KeyboardInterrupt:
        return None
    record.save(folder / task.path)
    return record
