"""Ending a run from outside: Ctrl-C, a terminal that closes, and every other signal that can be caught."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

#: Signals by which people and batch systems end a program.
_ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")

#: Signals that end a program unless it uses them itself.
_OTHERS = (
    "SIGQUIT",
    "SIGUSR1",
    "SIGUSR2",
    "SIGALRM",
    "SIGVTALRM",
    "SIGPROF",
    "SIGPOLL",
    "SIGPWR",
    "SIGSTKFLT",
    "SIGXCPU",
)

#: Signals of impatience: the third one gives up. Others may be repeated by machines.
_IMPATIENT = ("SIGINT", "SIGTERM", "SIGQUIT", "SIGBREAK")


class _Handler:
    """Turns signals into KeyboardInterrupt, at once or after what is being saved.

    Parameters
    ----------
    say : callable
        Takes a message for the user.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._count = 0
        self._shields = 0
        self._held = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        impatient = self._count == 0 or signal.Signals(number).name in _IMPATIENT
        self._count += impatient
        if not impatient:
            return
        if self._count == 2:
            self._say("still saving; Ctrl-C once more stops without saving")
        elif self._count == 1 and self._shields:
            self._held = True
        else:
            raise KeyboardInterrupt

    @contextmanager
    def shield(self) -> Iterator[None]:
        """Hold the first signal back until the end."""
        self._shields += 1
        try:
            yield
        finally:
            self._shields -= 1
        if self._held and not self._shields:
            self._held = False
            raise KeyboardInterrupt


_handler: _Handler | None = None


@contextmanager
def interruptible(say: Callable[[str], None]) -> Iterator[None]:
    """Turn the first signal that would end the program into KeyboardInterrupt, and let the saving that follows finish.

    A second Ctrl-C only says so; a third one gives up. Signals that were ignored on purpose, as by nohup, stay ignored.

    Parameters
    ----------
    say : callable
        Takes a message for the user.
    """
    global _handler
    if threading.current_thread() is not threading.main_thread() or _handler is not None:
        yield
        return
    handler, previous = _Handler(say), {}
    for names, replaced in ((_ENDING, None), (_OTHERS, signal.SIG_DFL)):
        for number in (getattr(signal, name) for name in names if hasattr(signal, name)):
            now = signal.getsignal(number)
            if now is not None and now is not signal.SIG_IGN and replaced in (None, now):
                previous[number] = signal.signal(number, handler)
    _handler = handler
    try:
        yield
    finally:
        _handler = None
        for number, before in previous.items():
            signal.signal(number, before)


@contextmanager
def shielded() -> Iterator[None]:
    """Hold back a first signal while something is saved; it is raised as KeyboardInterrupt at the end."""
    if threading.current_thread() is not threading.main_thread():
        yield
    elif _handler is not None:
        with _handler.shield():
            yield
    elif signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        # Of a program that imports this one, only Ctrl-C is ours to hold back.
        handler = _Handler(lambda _: None)
        signal.signal(signal.SIGINT, handler)
        try:
            with handler.shield():
                yield
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)
    else:
        yield
