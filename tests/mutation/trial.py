"""One trial: a mutated file is read as the program reads it, and what comes of it is judged.

What is wrong in a file must end in an `InputError` that names a key of it or the file, in one line, and says what is
allowed; nothing may take long. What is right must build, and some of it must break.
"""

from __future__ import annotations

import itertools
import os
import random
import re
import signal
import tomllib
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any
from unittest import mock

from fissura import Case, InputError, RunStopped
from fissura.api.check import check
from fissura.case import load_case
from fissura.case.units import show
from fissura.simulation.loop import Simulation
from fissura.simulation.memory import estimate_bodies, require_memory
from fissura.study.definition import Study, load_study

from .files import BAR, BEAM, PLATE, STUDY, base_files, npy
from .mutate import Tables, mutated_bytes, mutated_tables, possible_tables, written, written_json

__all__ = ["Fault", "Tally", "trial", "trials"]

#: Kinds of trials, and how often each is made.
_KINDS = {
    "possible": 5, "case": 8, "json": 2, "case text": 4, "study": 2, "study text": 1, "nuclei": 2, "npy": 1,
    "measured": 2,
}  # fmt: skip

#: Bodies up to which a case is built, and up to which it is loaded.
_BUILT, _BROKEN = 2000, 400
#: Every such trial whose case builds goes on for two steps.
_STEPPED = 20
#: Longest trial: processor time, the same where kernels are compiled on the way, and time that it may wait [s].
_LONGEST, _COMPILING, _WAITING = 5.0, 60.0, 120.0

#: Tables that two keys of different tables contradict each other in: the second is named, and the first may be wrong.
_RELATED = {("control", "gauge"), ("discretization", "adaptivity"), ("specimens", "variations")}


class Hang(BaseException):
    """A trial that takes too long; nothing on the way may take it for an error of its own."""


@dataclass(frozen=True)
class Fault:
    """What a trial brought to light: its number, what kind of file, what went wrong, and the file."""

    number: int
    kind: str
    problem: str
    content: bytes

    def __str__(self) -> str:
        return f"trial {self.number}, {self.kind}: {self.problem}\n{self.content[:2000]!r}"


@dataclass
class Tally:
    """How trials ended, counted, and the faults among them."""

    ends: Counter[str] = field(default_factory=Counter)
    faults: list[Fault] = field(default_factory=list)


@contextmanager
def _in_time(longest: float) -> Iterator[None]:
    """Give up what takes longer than some processor time [s], where the system can say so."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def give_up(number: int, frame: FrameType | None) -> None:
        raise Hang

    before = [signal.signal(number, give_up) for number in (signal.SIGPROF, signal.SIGALRM)]
    signal.setitimer(signal.ITIMER_PROF, longest)
    signal.setitimer(signal.ITIMER_REAL, _WAITING)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in zip((signal.SIGPROF, signal.SIGALRM), before, strict=True):
            signal.signal(number, handler)


@contextmanager
def _unraised(found: list[str]) -> Iterator[None]:
    """Gather what Python prints of exceptions that nobody can catch."""
    with mock.patch("sys.unraisablehook", lambda about: found.append(f"{about.exc_type.__name__}: {about.exc_value}")):
        yield


@contextmanager
def _small_fields() -> Iterator[None]:
    """Limits of random fields that make the largest ones quick; beyond them they are refused as ever."""
    with mock.patch.multiple("fissura.material.field.limits", MOST=1 << 16, MOST_FINER=1 << 13, SEPARABLE=2000):
        yield


@dataclass(frozen=True)
class _Made:
    """A mutated file, how it is read, and what may be named."""

    kind: str
    name: str
    content: bytes
    read: Callable[[Path], Any]
    main: str
    touched: tuple[str, ...] = ()
    keys: frozenset[str] = frozenset()


def _made(rng: random.Random, files: dict[str, bytes]) -> _Made:
    (kind,) = rng.choices(list(_KINDS), list(_KINDS.values()))
    changes = rng.choice((1, 1, 1, 2, 5))
    if kind == "possible":
        tables, touched = possible_tables(rng, tomllib.loads(rng.choice((BEAM, BAR, PLATE))), changes)
        content = written(tables).encode()
        return _Made(kind, "main.toml", content, load_case, "main.toml", touched, frozenset(tables))
    if kind in ("case", "json", "study"):
        base: Tables = tomllib.loads(STUDY if kind == "study" else rng.choice((BEAM, BAR, PLATE)))
        tables, touched = mutated_tables(rng, base, changes)
        text = written_json(tables) if kind == "json" else written(tables)
        name = "main.json" if kind == "json" else "main.toml"
        read = load_study if kind == "study" else load_case
        return _Made(kind, name, text.encode("utf-8", "replace"), read, name, touched, frozenset(tables))
    if kind in ("case text", "study text"):
        base_text = (STUDY if kind == "study text" else rng.choice((BEAM, BAR, PLATE))).encode()
        read = load_study if kind == "study text" else load_case
        return _Made(kind, "main.toml", mutated_bytes(rng, base_text, changes), read, "main.toml")
    if kind == "measured":
        content = mutated_bytes(rng, files["measured.csv"], changes)
        return _Made(kind, "measured.csv", content, load_case, "beam.toml", ("output",))
    name = "nuclei.npy" if kind == "npy" else "nuclei.txt"
    content = mutated_bytes(rng, npy(files["nuclei.txt"]) if kind == "npy" else files["nuclei.txt"], changes)
    return _Made(kind, name, content, load_case, f"{kind}.toml", ("discretization",))


def trial(seed: int, number: int, folder: Path) -> tuple[str, Fault | None]:
    """Mutate a file and try it.

    Parameters
    ----------
    seed, number : int
        Decide the mutation.
    folder : Path
        Where `trials` has put the files that are right.

    Returns
    -------
    end : str
        How it ended, in a word.
    fault : Fault or None
        What went wrong.
    """
    made = _made(random.Random(f"{seed}-{number}"), base_files())
    end, fault = _tried(made, number, folder, _LONGEST)
    if end == "hang" and _tried(made, number, folder, _COMPILING)[0] != "hang":
        end, fault = _tried(
            made, number, folder, _LONGEST
        )  # kernels that it needs had been compiled for the first time
    return end, fault


def _tried(made: _Made, number: int, folder: Path, longest: float) -> tuple[str, Fault | None]:
    path = folder / made.name
    kept = path.read_bytes() if path.exists() else None
    path.write_bytes(made.content)
    problem, end, where = "", "refused", "reading"
    unraised: list[str] = []
    try:
        with _in_time(longest), warnings.catch_warnings(), _unraised(unraised):
            warnings.simplefilter("error", RuntimeWarning)
            found = made.read(folder / made.main)
            where = "building"
            end = _built(found, number % _STEPPED == 0) if isinstance(found, Case) else "planned"
    except InputError as error:
        problem = _judged(error, made, folder, reading=where == "reading")
    except RunStopped:
        end = "stopped"
    except Hang:
        problem, end = f"hangs while {where}", "hang"
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        last = "".join(traceback.format_tb(error.__traceback__)[-2:])
        problem, end = f"{type(error).__name__} while {where}: {str(error)[:200]}\n{last}", "traceback"
    finally:
        path.unlink() if kept is None else path.write_bytes(kept)
    if unraised:
        problem = f"prints an exception that was ignored while {where}: {unraised[0]}"
    return end, Fault(number, made.kind, problem, made.content) if problem else None


def _built(case: Case, stepped: bool) -> str:
    if estimate_bodies(case) > _BUILT:
        require_memory(case)
        return "too large to be built here"
    check(case)
    if not stepped or estimate_bodies(case) > _BROKEN:
        return "built"
    for _ in itertools.islice(Simulation(case).steps(), 2):
        pass
    return "stepped"


def _judged(error: InputError, made: _Made, folder: Path, *, reading: bool) -> str:
    """What is wrong with a refusal; empty where nothing is."""
    text = str(error)
    if not text.isprintable() or len(text) > 2500:
        return f"the message is not one readable line of bounded length: {text[:200]!r}"
    if not error.key or not error.problem or not error.allowed:
        return f"the message lacks key, problem or what is allowed: {text}"
    if error.key.startswith(str(folder)):
        return ""
    match = re.match(r'"(?:[^"\\]|\\.)*"|[^.\[:( ]*', error.key)
    top = match[0] if match else ""
    known = {*Case.model_fields, *Study.model_fields, *made.keys, *map(show, made.keys)}
    if top not in known and (made.keys or not reading):  # of mutated bytes nobody knows what keys they have
        return f"the message names no key of the file: {text}"
    touched = {*made.touched, *map(show, made.touched)}
    related = {second for first, second in _RELATED if first in touched}
    if reading and touched and top not in touched | related:
        return f"the message names {error.key}, and {', '.join(made.touched)} was changed: {text}"
    return ""


def trials(seed: int, numbers: range, folder: Path) -> Tally:
    """Try many mutations, one after the other.

    Parameters
    ----------
    seed : int
        Decides all of them.
    numbers : range
        Which ones.
    folder : Path
        Empty folder to work in.
    """
    files = base_files()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    (folder / "nuclei.toml").write_text(BAR)
    (folder / "plate.toml").write_text(PLATE)
    (folder / "npy.toml").write_text(BAR.replace("nuclei.txt", "nuclei.npy"))
    (folder / "nuclei.npy").write_bytes(npy(files["nuclei.txt"]))
    if hasattr(os, "mkfifo"):
        os.mkfifo(folder / "pipe")
    for name in ("beam.toml", "nuclei.toml", "npy.toml", "plate.toml"):
        check(load_case(folder / name))  # they are right, and kernels are loaded before times count
        for _ in itertools.islice(Simulation(load_case(folder / name)).steps(), 2):
            pass
    tally = Tally()
    with _small_fields():
        for number in numbers:
            end, fault = trial(seed, number, folder)
            tally.ends[end] += 1
            if fault is not None:
                tally.faults.append(fault)
    return tally
