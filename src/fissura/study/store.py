"""The folder of a study: what is done, what is left to do."""

import logging
from collections.abc import Collection, Iterable
from dataclasses import replace
from pathlib import Path

from fissura.errors import InputError
from fissura.study.definition import FULL, LoadedStudy, Task
from fissura.study.record import Record, case_text

_log = logging.getLogger(__name__)

FAILURES = "failures"
"""Name for all runs that did not finish, where names of variations are asked for."""


def recorded(task: Task, folder: Path) -> Record | None:
    """Record of a task, if there is one, it can be read, and it is of the case that the task means today.

    A warning tells of one that cannot be read, such as half a file of a machine that went down.
    """
    path = folder / task.path
    if not path.exists():
        return None
    try:
        record = Record.load(path)
    except InputError as error:
        _log.warning("%s: %s; this run counts as missing", path, error.problem)
        return None
    if case_text(record.case, of_full=task.full) != case_text(task.case, of_full=task.full):
        return None
    # The case decides, not the name that its variation had when it was run.
    return replace(record, specimen=task.specimen, seed=task.seed, variation=task.variation)


def split(
    tasks: Iterable[Task], folder: Path, again: Collection[str] = ()
) -> tuple[list[tuple[Task, Record]], list[Task]]:
    """Tasks that are done, with their records, and tasks to run.

    Parameters
    ----------
    tasks : iterable of Task
        All tasks of a study.
    folder : Path
        Its folder.
    again : collection of str
        Names of variations to run once more; `FULL` and `FAILURES` are possible, too.
    """
    done, left = [], []
    for task in tasks:
        record = None if task.variation in again else recorded(task, folder)
        if record is None or (FAILURES in again and record.status != "finished"):
            left.append(task)
        else:
            done.append((task, record))
    return done, left


def check_names(loaded: LoadedStudy, again: Collection[str]) -> None:
    """Refuse names of variations that the study does not have.

    Raises
    ------
    InputError
        There is one.
    """
    known = [*(variation.name for variation in loaded.study.variations), FULL, FAILURES]
    for name in again:
        if name not in known:
            raise InputError("--again", f"{name!r} is not known", ", ".join(known))
