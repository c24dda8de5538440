"""Where realisations are computed: processes of this machine, or any Dask cluster."""

from __future__ import annotations

import logging
import socket
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from fissura.ensemble.outcome import Outcome, compute
from fissura.ensemble.plan import Task
from fissura.errors import EnsembleStopped, InputError
from fissura.memory import estimate_bodies, estimate_memory, physical_memory
from fissura.threads import threads_each, usable_processors

if TYPE_CHECKING:
    from distributed import Client
    from distributed.deploy.cluster import Cluster

    from fissura.case import Case
    from fissura.ensemble.local import LocalProcesses

__all__ = ["check_scheduler", "connected", "outcomes", "require_dask", "workers_that_fit"]

_log = logging.getLogger(__name__)

INSTALL = "pip install fissura[ensemble]"
ADDRESS = "the address that `dask scheduler` prints, such as tcp://127.0.0.1:8786"

#: How often a run is computed at most if its result is lost each time.
_ATTEMPTS = 5

#: Tasks that are handed to the cluster at a time: more than it has processors, few enough for a scheduler's memory.
_AHEAD = 2000

#: Seconds without any worker after which that is said, or, where workers are ours to start, the ensemble ends.
_ALONE = 60.0

#: Seconds within which a scheduler must answer.
_REACH = 10.0

#: Seconds between looks for results, and between checks that all local workers are there.
_POLL, _HEAL = 0.02, 2.0


def require_dask(*, local: bool) -> None:
    """Raise InputError if what ensembles need beyond a single run is not installed.

    Parameters
    ----------
    local : bool
        Whether they run in processes of this machine, which need credentials.
    """
    for package in ("dask", "distributed", "pyarrow", "jinja2", *(["cryptography"] if local else [])):
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


@contextmanager
def connected(workers: int, threads: int = 1, scheduler: str | Cluster | None = None) -> Iterator[Client]:
    """A client of a cluster.

    Parameters
    ----------
    workers : int
        Local processes to start, unless there is a scheduler.
    threads : int, optional
        Threads of each of them, in Fissura's kernels and in linear algebra, unless environment variables that limit
        them are set already.
    scheduler : str or Cluster, optional
        Address of a scheduler whose workers are to be used, for example ``"tcp://127.0.0.1:8786"``, or a cluster of
        Dask, which knows its credentials.

    Raises
    ------
    InputError
        Dask is not installed, or the scheduler cannot be reached.
    EnsembleStopped
        A local process could not be started.
    """
    require_dask(local=scheduler is None)
    import dask
    from distributed import Client

    settings = {
        # Threads are limited below: what is set here would stay in the environment of this process.
        "distributed.nanny.pre-spawn-environ": {"MALLOC_TRIM_THRESHOLD_": "65536"},
        # A worker has no run waiting beside the one it computes, which would be blamed, too, when it dies.
        "distributed.scheduler.worker-saturation": 1.0,
        # A busy machine takes long to start the process anew.
        "distributed.deploy.lost-worker-timeout": "30s",
    }
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(_silent())
        stack.enter_context(threads_each(threads))
        if scheduler is None:
            cluster: Any = stack.enter_context(_started(workers))
        else:
            cluster = scheduler
        try:
            client = stack.enter_context(Client(cluster, set_as_default=False))
        except (OSError, ValueError, TypeError, TimeoutError) as error:
            if scheduler is None:
                raise EnsembleStopped(f"the local scheduler cannot be reached ({error})") from error
            raise InputError("--scheduler", f"{_address(scheduler)} cannot be reached ({error})", ADDRESS) from error
        yield client


def _started(workers: int) -> LocalProcesses:
    """Local processes, once all of them have started.

    Raises
    ------
    EnsembleStopped
        One has not.
    """
    from fissura.ensemble.local import LocalProcesses

    try:
        return LocalProcesses(workers)
    except (OSError, RuntimeError, TimeoutError) as error:  # what nannies and sockets raise
        reason: BaseException = error
        while reason.__cause__ is not None:
            reason = reason.__cause__
        raise EnsembleStopped(
            f"a worker process died while it started, perhaps for lack of memory ({reason or type(reason).__name__})"
        ) from error


def _address(scheduler: str | Cluster | None) -> str:
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


def outcomes(client: Client, tasks: Iterable[Task]) -> Iterator[Outcome]:
    """Compute tasks, and yield what becomes of each in the order in which they end.

    Tasks are taken as they are handed to the cluster, `_AHEAD` at a time, so that planning many takes no time. A
    realisation whose worker dies is computed again by another one; the cluster gives up on it after several such deaths
    (``distributed.scheduler.allowed-failures``), and it has failed then.

    Raises
    ------
    EnsembleStopped
        The scheduler has gone, or no local worker could be started.
    """
    try:
        yield from _arriving(client, iter(tasks))
    except (OSError, RuntimeError, TimeoutError) as error:  # what connections raise
        raise EnsembleStopped(f"the scheduler or its connection has gone ({error})") from error


def _arriving(client: Client, tasks: Iterator[Task]) -> Iterator[Outcome]:
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
            if isinstance(error, KilledWorker):
                error = MemoryError("the processes that computed it died, perhaps for lack of memory")
            outcome = Outcome.failed(task, error)
        future.release()  # workers need not keep it any longer
        yield outcome


class _Watch:
    """Looks after the workers of a cluster while nothing arrives from them.

    Parameters
    ----------
    client : Client
        Of the cluster.
    """

    def __init__(self, client: Client) -> None:
        from fissura.ensemble.local import LocalProcesses

        self._client = client
        self._ours: Any = client.cluster if isinstance(client.cluster, LocalProcesses) else None
        self._looked = self._met = time.monotonic()
        self._told = False

    def look(self) -> None:
        """Start local workers anew that could not be restarted, which a cluster gives up; say if there are none.

        Raises
        ------
        EnsembleStopped
            For long there has been no local worker.
        """
        now = time.monotonic()
        if now - self._looked < _HEAL:
            return
        self._looked = now
        if self._ours is not None:
            self._ours.scale(len(self._ours.worker_spec))
        if self._client.nthreads():
            self._met, self._told = now, False
        elif now - self._met >= _ALONE and self._ours is not None:
            raise EnsembleStopped(f"no worker process could be started for {_ALONE:g} s, perhaps for lack of memory")
        elif now - self._met >= _ALONE and not self._told:
            self._told = True
            _log.warning("the scheduler has had no workers for %g s; waiting for some", _ALONE)
