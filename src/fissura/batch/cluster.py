"""Tasks computed on a Dask cluster."""

from __future__ import annotations

import logging
import socket
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from fissura.errors import EnsembleStopped, InputError

if TYPE_CHECKING:
    from distributed import Client
    from distributed.deploy.cluster import Cluster

_log = logging.getLogger(__name__)

T = TypeVar("T")
R = TypeVar("R")

LOST = MemoryError("the processes that computed it died, perhaps for lack of memory")
"""Why there is no result of a task whose processes died again and again."""

ADDRESS = "the address that `dask scheduler` prints, such as tcp://127.0.0.1:8786"

#: A worker with several threads would let runs share processor time and interleave.
_one_at_a_time = threading.Lock()

#: What was called in this worker before its first task.
_prepared: set[Callable[[], None]] = set()

#: How often a run is computed at most if its result is lost each time.
_ATTEMPTS = 5

#: Tasks that are handed to a cluster at a time: more than it has processors, few enough for a scheduler's memory.
_AHEAD = 2000

#: Seconds within which a scheduler must answer.
_REACH = 10.0

#: Seconds between looks for results, between looks for workers, and without any after which that is said.
_POLL, _LOOK, _ALONE = 0.02, 2.0, 60.0


def on_cluster(
    run: Callable[[T], R], tasks: Iterable[T], scheduler: str | Cluster, prepare: Callable[[], None] | None = None
) -> Generator[tuple[T, R, BaseException | None]]:
    """Compute tasks on a cluster; a task comes with its result, or with the error of which it failed.

    A task whose worker dies is computed again; the cluster gives it up after several deaths
    (``distributed.scheduler.allowed-failures``).

    Parameters
    ----------
    run : callable
        Computes a task. It, tasks and results must be picklable. A worker runs one at a time, whatever its threads.
    tasks : iterable
        Taken as there is room for them.
    scheduler : str or Cluster
        Address of a scheduler, or a cluster of Dask.
    prepare : callable, optional
        Called once in each worker.

    Yields
    ------
    (task, result, error)
        In the order in which they end; the error is None, or there is no result.

    Raises
    ------
    InputError
        The scheduler cannot be reached.
    EnsembleStopped
        It has gone.
    """
    with _connected(scheduler) as client:
        try:
            yield from _arriving(client, run, iter(tasks), prepare)
        except (OSError, RuntimeError, TimeoutError) as error:  # what connections raise
            raise EnsembleStopped(f"the scheduler or its connection has gone ({error})") from error


def _in_turn(run: Callable[[T], R], prepare: Callable[[], None] | None, task: T) -> R:
    """Compute a task in a worker."""
    with _one_at_a_time:
        if prepare is not None and prepare not in _prepared:
            prepare()
            _prepared.add(prepare)
        return run(task)


@contextmanager
def _connected(scheduler: str | Cluster) -> Iterator[Client]:
    """A client of a cluster.

    Raises
    ------
    InputError
        It cannot be reached.
    """
    from distributed import Client

    with _silent():
        try:
            client = Client(scheduler, set_as_default=False)
        except (OSError, ValueError, TypeError, TimeoutError) as error:
            raise InputError("--scheduler", f"{_address(scheduler)} cannot be reached ({error})", ADDRESS) from error
        with client:
            yield client


def _address(scheduler: str | Cluster) -> str:
    return str(getattr(scheduler, "scheduler_address", scheduler))


def check_scheduler(scheduler: str | Cluster) -> None:
    """Raise InputError if this is not a scheduler that can be reached.

    A client of Dask takes up to a minute to give up, and writes a traceback for what is no address at all; and by then
    a folder would have been begun.
    """
    from distributed.comm.addressing import parse_address, parse_host_port

    address = _address(scheduler)
    try:
        protocol, place = parse_address(address)
        if protocol not in ("tcp", "tls"):
            return
        host, port = parse_host_port(place)
        if protocol == "tls" and isinstance(scheduler, str):
            _check_credentials(address)
    except ValueError as error:
        raise InputError("--scheduler", f"{address} is not an address ({error})", ADDRESS) from error
    try:
        socket.create_connection((host, port), timeout=_REACH).close()
    except OSError as error:
        raise InputError("--scheduler", f"{address} cannot be reached ({error})", ADDRESS) from error


def _check_credentials(address: str) -> None:
    """Raise InputError without credentials for a scheduler that asks for them."""
    from distributed import Security

    allowed = "distributed.comm.tls in Dask's configuration, see docs/ensembles.md"
    try:
        known = Security().get_connection_args("client")["ssl_context"] is not None
    except OSError as error:
        raise InputError("--scheduler", f"credentials for {address} cannot be read ({error})", allowed) from error
    if not known:
        raise InputError("--scheduler", f"{address} asks for credentials, and there are none", allowed)


@contextmanager
def _silent() -> Iterator[None]:
    """Keep Dask's log from the user: what matters of it becomes an outcome or an error here."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _arriving(
    client: Client, run: Callable[[T], R], tasks: Iterator[T], prepare: Callable[[], None] | None
) -> Iterator[tuple[T, Any, BaseException | None]]:
    from distributed import KilledWorker, as_completed

    arriving = as_completed(loop=client.loop)
    waiting: dict[Any, tuple[T, int]] = {}

    def submit(task: T, attempt: int) -> None:
        # Not pure: an equal task of an earlier batch must not stand for this one.
        future = client.submit(_in_turn, run, prepare, task, pure=False)
        waiting[future.key] = task, attempt
        arriving.add(future)

    def refill() -> bool:
        """Hand on what there is room for; whether anything is to be waited for."""
        while len(waiting) < _AHEAD and (task := next(tasks, None)) is not None:
            submit(task, 1)
        return bool(waiting)

    watch = _Watch(client)
    while refill():
        if not arriving.has_ready():
            time.sleep(_POLL)
            watch.look()
            continue
        future = next(arriving)
        task, attempt = waiting.pop(future.key)
        status = future.status
        if status == "cancelled":
            raise EnsembleStopped("the scheduler or its connection has gone")
        if status not in ("finished", "error"):
            # Its worker died with the result since; the scheduler has it computed again.
            waiting[future.key] = task, attempt
            arriving.add(future)
            continue
        done = status == "finished"
        result, failure = None, None
        try:
            result = future.result()
        except Exception as error:
            if done and attempt < _ATTEMPTS:
                # It was computed, but its worker died before it had handed over the result.
                submit(task, attempt + 1)
                continue
            failure = LOST if isinstance(error, KilledWorker) else error
        future.release()  # workers need not keep it any longer
        yield task, result, failure


class _Watch:
    """Looks whether a cluster has workers at all while nothing arrives from them.

    Parameters
    ----------
    client : Client
        Of the cluster.
    """

    def __init__(self, client: Client) -> None:
        self._client = client
        self._looked = self._met = time.monotonic()
        self._told = False

    def look(self) -> None:
        """Say so, once, if there have been none for long."""
        now = time.monotonic()
        if now - self._looked < _LOOK:
            return
        self._looked = now
        if self._client.nthreads():
            self._met, self._told = now, False
        elif now - self._met >= _ALONE and not self._told:
            self._told = True
            _log.warning("the scheduler has had no workers for %g s; waiting for some", _ALONE)
