"""Signals: what they end, what they wait for, and what they leave alone."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator

import pytest

from fissura.machine.interrupts import interruptible, shielded

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="sends signals")

ALL = [name for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGXCPU") if hasattr(signal, name)]


@pytest.fixture(autouse=True)
def _own_handlers() -> Iterator[None]:
    """What a shell starts in the background ignores some of them."""
    before = {name: signal.signal(getattr(signal, name), signal.SIG_DFL) for name in ALL}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for name, handler in before.items():
        signal.signal(getattr(signal, name), handler)


def send(name: str) -> None:
    os.kill(os.getpid(), getattr(signal, name))


@pytest.mark.parametrize("name", ALL)
def test_every_signal_that_can_be_caught_is_an_interruption(name: str) -> None:
    before = signal.getsignal(getattr(signal, name))
    with interruptible(pytest.fail), pytest.raises(KeyboardInterrupt):
        send(name)
    assert signal.getsignal(getattr(signal, name)) is before


@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP"])
def test_what_is_ignored_on_purpose_stays_so(name: str) -> None:
    signal.signal(getattr(signal, name), signal.SIG_IGN)
    with interruptible(pytest.fail):
        send(name)


def test_signals_that_a_program_uses_itself_stay_with_it() -> None:
    got: list[int] = []
    signal.signal(signal.SIGUSR1, lambda number, _: got.append(number))
    with interruptible(pytest.fail):
        send("SIGUSR1")
    assert got == [signal.SIGUSR1]


def test_a_second_signal_says_so_and_a_third_gives_up() -> None:
    said: list[str] = []
    with interruptible(said.append):
        with pytest.raises(KeyboardInterrupt):
            send("SIGINT")
        send("SIGINT")
        assert said == ["still saving; Ctrl-C once more stops without saving"]
        with pytest.raises(KeyboardInterrupt):
            send("SIGINT")


def test_machines_may_repeat_themselves() -> None:
    with interruptible(pytest.fail):
        with pytest.raises(KeyboardInterrupt):
            send("SIGXCPU")
        for _ in range(5):
            send("SIGXCPU")
            send("SIGHUP")


def test_what_is_shielded_is_done_first() -> None:
    done: list[str] = []

    def save() -> None:
        with shielded():
            with shielded():
                send("SIGTERM")
                done.append("inner")
            done.append("outer")

    with interruptible(pytest.fail), pytest.raises(KeyboardInterrupt):
        save()
    assert done == ["inner", "outer"]


def test_impatience_ends_a_shield() -> None:
    said: list[str] = []

    def save() -> None:
        with shielded():
            for _ in range(3):
                send("SIGINT")
            pytest.fail("went on")

    with interruptible(said.append), pytest.raises(KeyboardInterrupt):
        save()
    assert said == ["still saving; Ctrl-C once more stops without saving"]


def test_ctrl_c_of_a_program_that_only_imports_us_waits_too() -> None:
    done: list[str] = []

    def save() -> None:
        with shielded():
            send("SIGINT")
            done.append("saved")

    with pytest.raises(KeyboardInterrupt):
        save()
    assert done == ["saved"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
