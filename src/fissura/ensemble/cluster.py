"""Where realisations are computed: processes of this machine, or any Dask cluster."""

from __future__ import annotations

import logging
import socket
import time
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fissura.batch.processes import ProcessesLost, computed
from fissura.ensemble.outcome import Outcome, compute
from fissura.ensemble.plan import Task
from fissura.errors import EnsembleStopped, InputError
from fissura.machine.memory import physical_memory
from fissura.machine.threads import threads_each, usable_processors
from fissura.simulation.memory import estimate_bodies, estimate_memory

if TYPE_CHECKING:
    from distributed import Client
    from distributed.deploy.cluster import Cluster

    from fissura.case import Case

__all__ = ["check_scheduler", "outcomes", "require_packages", "workers_that_fit"]

_log = logging.getLogger(__name__)

INSTALL = "pip install fissura[ensemble]"
ADDRESS = "the address that `dask scheduler` prints, such as tcp://127.0.0.1:8786"

#: How often a run is computed at most if its result is lost each time.
_ATTEMPTS = 5

#: Tasks that are handed to a cluster at a time: more than it has processors, few enough for a scheduler's memory.
_AHEAD = 2000

#: Seconds within which a scheduler must answer.
_REACH = 10.0

#: Seconds between looks for results, between looks for workers, and without any after which that is said.
_POLL, _LOOK, _ALONE = 0.02, 2.0, 60.0


def require_packages(*, cluster: bool) -> None:
    """Raise InputError if what ensembles need beyond a single run is not installed.

    Parameters
    ----------
    cluster : bool
        Whether they run on a cluster.
    """
    for package in ("pyarrow", "jinja2", *(["dask", "distributed"] if cluster else [])):
        try:
            __import__(package)
        except ImportError as error:
            raise InputError("fissura ensemble", f"needs {package}, which is not installed", INSTALL) from error


def workers_that_fit(case: Case, *, full: bool) -> int:
    """Number of local processes by default: one per processor, fewer if that many runs do not fit into memory."""
    bodies = estimate_bodies(case) if case.discretization.nuclei is None else 0.0
    # Adaptive runs are far from the estimate of full resolution; a half of it is on the safe side.
    memory = estimate_memory(bodies if full else bodies / 2.0)
    return max(1, min(usable_processors(), int(physical_memory() / memory)))


def outcomes(
    tasks: Iterable[Task], workers: int, threads: int = 1, scheduler: str | Cluster | None = None
) -> Generator[Outcome]:
    """Compute tasks, and yield what becomes of each in the order in which they end.

    Tasks are taken as there is room for them, so that planning many takes no time. A realisation whose process dies is
    computed again by another one, and has failed after several such deaths. Whoever does not take all outcomes must
    close this generator.

    Parameters
    ----------
    tasks : iterable of Task
        What to compute.
    workers : int
        Processes to start on this machine, unless there is a scheduler.
    threads : int, optional
        Threads of each of them, in Fissura's kernels and in linear algebra, unless environment variables that limit
        them are set already.
    scheduler : str or Cluster, optional
        Address of a Dask scheduler whose workers are to be used, for example ``"tcp://127.0.0.1:8786"``, or a cluster
        of Dask, which knows its credentials.

    Raises
    ------
    InputError
        The scheduler cannot be reached.
    EnsembleStopped
        The scheduler has gone, or no local process can be started.
    """
    if scheduler is None:
        yield from _here(tasks, workers, threads)
        return
    with _connected(scheduler) as client:
        try:
            yield from _there(client, iter(tasks))
        except (OSError, RuntimeError, TimeoutError) as error:  # what connections raise
            raise EnsembleStopped(f"the scheduler or its connection has gone ({error})") from error


def _here(tasks: Iterable[Task], workers: int, threads: int) -> Iterator[Outcome]:
    """Compute tasks in processes of this machine."""
    with threads_each(threads):
        try:
            for task, outcome in computed(compute, tasks, workers):
                yield _lost(task) if outcome is None else outcome
        except ProcessesLost as error:
            raise EnsembleStopped(str(error)) from error


def _lost(task: Task) -> Outcome:
    return Outcome.failed(task, MemoryError("the processes that computed it died, perhaps for lack of memory"))


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
    """Address of a scheduler."""
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


def _there(client: Client, tasks: Iterator[Task]) -> Iterator[Outcome]:
    """Compute tasks on a cluster.

    The cluster gives a task up after several deaths of its workers (``distributed.scheduler.allowed-failures``).
    """
    from distributed import KilledWorker, as_completed

    arriving = as_completed(loop=client.loop)
    waiting: dict[Any, tuple[Task, int]] = {}

    def submit(task: Task, attempt: int) -> None:
        # Not pure: an equal task of an earlier ensemble must not stand for this one.
        future = client.submit(compute, task, pure=False)
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
        try:
            outcome = future.result()
        except Exception as error:
            if done and attempt < _ATTEMPTS:
                # It was computed, but its worker died before it had handed over the result.
                submit(task, attempt + 1)
                continue
            outcome = _lost(task) if isinstance(error, KilledWorker) else Outcome.failed(task, error)
        future.release()  # workers need not keep it any longer
        yield outcome


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
