"""Processes of this machine that compute tasks side by side, which nobody else can reach, and which may die.

Each process has a pipe to the one that started it and no other door: no port is opened, so that other users of the
machine cannot get at them. A pool of the standard library is of no use once one of its processes has died; here another
one takes over.
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from typing import Any, Generic, TypeVar

from fissura.errors import EnsembleStopped
from fissura.kernels import prepare_cache

T = TypeVar("T")
R = TypeVar("R")

DEATHS = 4
"""Processes that may die with a task until it is given up."""

#: Processes that may die one after another before any has got to work, until no more are started.
_FAILED_STARTS = 3

#: Seconds between looks for signals, where waiting cannot be interrupted, and for a process to end by itself.
_LOOK, _PATIENCE = 1.0, 10.0

#: What processes send.
_READY, _REFUSED, _DONE = range(3)

# A forked copy of the threads of numerical libraries may hang.
_context = get_context("spawn")


def computed(
    run: Callable[[T], R], tasks: Iterable[T], count: int, prepare: Callable[[], None] | None = None
) -> Generator[tuple[T, R | None]]:
    """Compute tasks in processes of their own.

    Whoever does not take all results must close this generator, which ends the processes.

    Parameters
    ----------
    run : callable
        Computes a task. It, tasks and results must be picklable. What it does not catch ends its process.
    tasks : iterable
        Taken one by one as processes get free.
    count : int
        Processes.
    prepare : callable, optional
        Called once in each process.

    Yields
    ------
    (task, result)
        In the order in which they end. The result is None where processes died again and again with the task.

    Raises
    ------
    EnsembleStopped
        No process can be started, or the preparation fails.
    """
    left, again = iter(tasks), deque[_Job[T]]()

    def following() -> _Job[T] | None:
        return again.popleft() if again else next((_Job(task) for task in left), None)

    pool = _Pool(run, prepare)
    try:
        job = following()
        while job is not None or pool.working:
            pool.fill(count)
            for worker in pool.idle():
                if job is not None and worker.take(job):
                    job = following()
            for done, result in pool.arrived():
                if result is not _DIED:
                    yield done.task, result
                    continue
                done.deaths += 1
                if done.deaths < DEATHS:
                    again.append(done)
                else:
                    yield done.task, None
            job = following() if job is None else job
    finally:
        pool.end()


#: Stands for the result of a task whose process has died.
_DIED: Any = object()


@dataclass
class _Job(Generic[T]):
    """A task, and how many processes have died with it."""

    task: T
    deaths: int = 0


class _Worker(Generic[T, R]):
    """A process, as seen by the one that starts it."""

    def __init__(self, run: Callable[[T], R], prepare: Callable[[], None] | None) -> None:
        self.pipe, other = _context.Pipe()
        self.ready = False
        self.job: _Job[T] | None = None
        self.process = _context.Process(target=_serve, args=(other, run, prepare), daemon=True)
        try:
            with _no_interrupts():
                self.process.start()
        except BaseException:
            self.pipe.close()
            raise
        finally:
            other.close()  # so that the pipe ends when the process does

    def take(self, job: _Job[T]) -> bool:
        """Give it a job; False where it has died since."""
        self.job = job  # before it is sent: a Ctrl-C may come between the two, and who works is ended by force
        try:
            self.pipe.send(job.task)
        except OSError:
            self.job = None
            return False
        return True

    def end(self) -> str:
        """Let it end, by force if it must be; says how it ended."""
        self.pipe.close()
        if self.process.is_alive() and (self.job is not None or not self.ready):
            self.process.terminate()
        self.process.join(_PATIENCE)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        code = self.process.exitcode or 0
        return f"signal {-code}" if code < 0 else f"exit status {code}"


class _Pool(Generic[T, R]):
    """The processes that there are."""

    def __init__(self, run: Callable[[T], R], prepare: Callable[[], None] | None) -> None:
        self._run, self._prepare = run, prepare
        self._workers: list[_Worker[T, R]] = []
        self._failed, self._reason = 0, ""

    @property
    def working(self) -> bool:
        """Whether any of them has a job."""
        return any(worker.job is not None for worker in self._workers)

    def idle(self) -> list[_Worker[T, R]]:
        """Those that wait for a job."""
        return [worker for worker in self._workers if worker.ready and worker.job is None]

    def fill(self, count: int) -> None:
        """Start processes up to a number of them, unless the last ones died before they got to work.

        Raises
        ------
        EnsembleStopped
            There is none, and none can be started.
        """
        while len(self._workers) < count and self._failed < _FAILED_STARTS:
            try:
                self._workers.append(_Worker(self._run, self._prepare))
            except OSError as error:  # too many processes, or no memory for one more
                self._failed, self._reason = self._failed + 1, str(error)
        if not self._workers:
            raise EnsembleStopped(f"processes die while they start, perhaps for lack of memory ({self._reason})")

    def arrived(self) -> Iterator[tuple[_Job[T], R]]:
        """Wait for any of them, and tell of jobs that ended; the result is `_DIED` where the process has."""
        waiting = {worker.pipe: worker for worker in self._workers}
        for pipe in wait(list(waiting), _LOOK):
            worker = waiting[pipe]  # type: ignore[index]
            try:
                kind, content = worker.pipe.recv()
            except Exception:  # an end, or half a message
                self._workers.remove(worker)
                job = worker.job
                self._reason = worker.end()
                self._failed += not worker.ready
                if job is not None:
                    yield job, _DIED
                continue
            if kind == _READY:
                worker.ready, self._failed = True, 0
            elif kind == _REFUSED:
                raise EnsembleStopped(content)
            else:
                job, worker.job = worker.job, None
                assert job is not None
                yield job, content

    def end(self) -> None:
        """Let all of them end."""
        for worker in self._workers:
            if worker.job is not None or not worker.ready:
                worker.process.terminate()  # all at once; each is waited for below
        while self._workers:
            self._workers.pop().end()


@contextmanager
def _no_interrupts() -> Iterator[None]:
    """Let a process that starts inside never see a Ctrl-C, which a terminal sends to all; one that comes now waits."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(pipe: Connection, run: Callable[[T], R], prepare: Callable[[], None] | None) -> None:
    """What a process does: a task, the next one, until the pipe ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where it could not be blocked
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # of a terminal that closes; the one that started it decides
    prepare_cache(say=False)
    # What runs warn of is part of their results; so many processes would only repeat each other.
    logging.getLogger("fissura").addHandler(logging.NullHandler())
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(1))  # temporary folders are removed on the way
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        if prepare is not None:
            prepare()
    except Exception as error:
        _tell(pipe, _REFUSED, str(error) or type(error).__name__)
        return
    told = _tell(pipe, _READY, None)
    while told:
        try:
            task = pipe.recv()
        except (EOFError, OSError):
            return
        told = _tell(pipe, _DONE, run(task))


def _tell(pipe: Connection, kind: int, content: Any) -> bool:
    """Send to the process that started this one; False where it no longer listens, which is how it ends all of them."""
    message = ForkingPickler.dumps((kind, content))  # what cannot be pickled is an error, a closed pipe is none
    try:
        pipe.send_bytes(message)
    except OSError:
        return False
    return True


def _end_with_parent() -> None:
    """End this process when the one that started it has ended, however that was."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
