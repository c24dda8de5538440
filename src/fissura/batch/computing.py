"""Tasks computed side by side, and kept one by one as they end."""

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from typing import TypeVar

from fissura.batch.cluster import LOST, on_cluster
from fissura.batch.machines import Machines
from fissura.batch.processes import computed
from fissura.errors import EnsembleStopped
from fissura.kernels import prepare_cache
from fissura.machine.threads import threads_each

T = TypeVar("T")
R = TypeVar("R")


def compute_all(
    run: Callable[[T], R],
    tasks: Iterable[T],
    count: int,
    machines: Machines,
    *,
    failed: Callable[[T, BaseException], R],
    keep: Callable[[T, R], None],
    prepare: Callable[[], None] | None = None,
) -> None:
    """Compute tasks, and keep the result of each the moment it ends.

    Parameters
    ----------
    run : callable
        Computes a task; whatever may go wrong in it should be part of its result.
    tasks : iterable
        Taken as there is room for them, so that planning many takes no time.
    count : int
        How many they are.
    machines : Machines
        Where; with a number of workers, unless there is a scheduler.
    failed : callable
        The result of a task of which nothing is left but an error.
    keep : callable
        Called in this process with every task and its result; it writes them.
    prepare : callable, optional
        Called once in each process that computes.

    Raises
    ------
    InputError
        The scheduler cannot be reached.
    EnsembleStopped
        The scheduler has gone, or no process can be started; the message says how many runs are missing.
    """
    left = count
    if machines.scheduler is None:
        prepare_cache()
    try:
        with closing(results(run, tasks, machines, failed, prepare)) as arriving:
            for task, result in arriving:
                keep(task, result)
                left -= 1
    except EnsembleStopped as error:
        raise EnsembleStopped(f"{error}; {left} of {count} runs are missing") from error


def results(
    run: Callable[[T], R],
    tasks: Iterable[T],
    machines: Machines,
    failed: Callable[[T, BaseException], R],
    prepare: Callable[[], None] | None = None,
) -> Generator[tuple[T, R]]:
    """Tasks and their results, in the order in which they end; see `compute_all`.

    Whoever does not take all of them must close this generator.

    Yields
    ------
    (task, result)
        What became of each, an error as the result that `failed` makes of it.
    """
    if machines.scheduler is not None:
        for task, result, error in on_cluster(run, tasks, machines.scheduler, prepare):
            yield task, result if error is None else failed(task, error)
        return
    assert machines.workers is not None
    with threads_each(machines.threads_per_worker):
        for task, found in computed(run, tasks, machines.workers, prepare):
            yield task, failed(task, LOST) if found is None else found
