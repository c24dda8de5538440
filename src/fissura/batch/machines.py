"""Where tasks are computed, and how many at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fissura.case import Case
from fissura.errors import InputError
from fissura.machine.memory import physical_memory
from fissura.machine.threads import side_by_side, usable_processors
from fissura.simulation.memory import estimate_bodies, estimate_memory

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster


INSTALL = "pip install fissura[ensemble]"


@dataclass(frozen=True)
class Machines:
    """Processes of this machine, or a Dask cluster.

    Attributes
    ----------
    workers : int or None
        Processes to start on this machine; None leaves it to whoever knows the tasks.
    threads_per_worker : int
        Threads of each of them, in Fissura's kernels and in linear algebra, unless environment variables that limit
        them are set already.
    scheduler : str, Cluster or None
        Address of a Dask scheduler whose workers are to be used, for example ``"tcp://127.0.0.1:8786"``, or a cluster
        of Dask, which knows its credentials.

    Raises
    ------
    InputError
        They do not fit together, or are more than this machine can run.
    """

    workers: int | None = None
    threads_per_worker: int = 1
    scheduler: str | Cluster | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            object.__setattr__(self, "workers", side_by_side("--workers", self.workers))
        threads = side_by_side("--threads-per-worker", self.threads_per_worker)
        object.__setattr__(self, "threads_per_worker", threads)
        if self.scheduler is None:
            return
        if self.workers is not None:
            allowed = "one of them: the scheduler has its workers"
            raise InputError("--workers", "is given together with --scheduler", allowed)
        if self.threads_per_worker != 1:
            raise InputError(
                "--threads-per-worker",
                "is given together with --scheduler, whose workers run already",
                "FISSURA_THREADS in the environment of these workers",
            )


def require_packages(command: str, scheduler: str | Cluster | None, *more: str) -> None:
    """Refuse a command if what it needs beyond a single run is not installed.

    Parameters
    ----------
    command : str
        What needs it, for the message.
    scheduler : str, Cluster or None
        Where there is one, Dask is needed.
    *more : str
        Further packages.

    Raises
    ------
    InputError
        A package is missing; the message says how to install it.
    """
    for package in (*more, *(() if scheduler is None else ("dask", "distributed"))):
        try:
            __import__(package)
        except ImportError as error:
            raise InputError(command, f"needs {package}, which is not installed", INSTALL) from error


def workers_that_fit(case: Case, *, full: bool) -> int:
    """Number of local processes by default: one per processor, fewer if that many runs do not fit into memory."""
    bodies = estimate_bodies(case) if case.discretization.nuclei is None else 0.0
    # Adaptive runs are far from the estimate of full resolution; a half of it is on the safe side.
    memory = estimate_memory(bodies if full else bodies / 2.0)
    return max(1, min(usable_processors(), int(physical_memory() / memory)))
