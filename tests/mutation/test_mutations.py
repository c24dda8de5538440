"""Mutated input files end in a message that names a key, or in a case that builds; trials would tell otherwise."""

from __future__ import annotations

import random
import time
import tomllib
from pathlib import Path
from typing import Any, NoReturn

import pytest

from fissura import InputError, RunStopped
from fissura.case import load_case

from . import trial as module
from .files import BAR, BEAM, base_files
from .mutate import mutated_bytes, mutated_tables, written
from .trial import Tally, trials


def shown(tally: Tally) -> str:
    return "\n\n".join(map(str, tally.faults[:5]))


def test_mutated_files_are_refused_with_a_key_or_build(tmp_path: Path) -> None:
    tally = trials(1, range(200), tmp_path)
    assert not tally.faults, shown(tally)
    assert tally.ends["refused"] > 80
    assert tally.ends["built"] + tally.ends["stepped"] > 20


@pytest.mark.slow
def test_two_thousand_of_them(tmp_path: Path) -> None:
    tally = trials(2, range(2000), tmp_path)
    assert not tally.faults, shown(tally)
    assert set(tally.ends) == {"refused", "built", "stepped", "planned", "too large to be built here"}


def raising(error: BaseException) -> Any:
    def fail(*_: Any) -> NoReturn:
        raise error

    return fail


class Muttering:
    """Raises where nobody can catch it."""

    def __del__(self) -> None:
        raise ValueError("unheard")


def busy(*_: Any) -> None:
    while time.process_time() >= 0.0:
        pass


@pytest.mark.parametrize(
    ("reader", "problem"),
    [
        (raising(ZeroDivisionError("division by zero")), "ZeroDivisionError while reading: division by zero"),
        (raising(RecursionError()), "RecursionError while reading"),
        (raising(SystemExit(1)), "SystemExit while reading"),
        (raising(InputError("", "is wrong", "right")), "lacks key"),
        (raising(InputError("seed", "is wrong")), "lacks key, problem or what is allowed"),
        (raising(InputError("nonsense", "is wrong", "right")), "names no key of the file"),
        (raising(InputError("solver.linear", "is wrong", "right")), "the message names solver.linear, and"),
        (busy, "hangs while reading"),
        (lambda path: Muttering() and None, "that was ignored while building: ValueError: unheard"),
        (raising(RunStopped("reason", 1, 0.0)), ""),
        (lambda path: None, ""),
    ],
)
def test_trials_tell_what_is_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reader: Any, problem: str) -> None:
    for name, content in base_files().items():
        (tmp_path / name).write_bytes(content)
    monkeypatch.setattr(module, "_KINDS", {"possible": 1})
    monkeypatch.setattr(module, "_LONGEST", 0.1)
    monkeypatch.setattr(module, "_COMPILING", 0.1)
    monkeypatch.setattr(module, "load_case", reader)
    number = next(k for k in range(100) if "solver" not in touched_by(k))
    _, fault = module.trial(1, number, tmp_path)
    assert (fault is None) == (problem == "")
    assert fault is None or problem in str(fault)
    assert not (tmp_path / "main.toml").exists()


def touched_by(number: int) -> tuple[str, ...]:
    return module._made(random.Random(f"1-{number}"), base_files()).touched


def test_a_mutation_is_made_again_from_its_seed() -> None:
    files = base_files()
    for number in range(50):
        one, two = (module._made(random.Random(f"1-{number}"), files) for _ in range(2))
        assert (one.content, one.touched, one.kind) == (two.content, two.touched, two.kind)
    assert len({module._made(random.Random(f"1-{number}"), files).content for number in range(50)}) > 45


@pytest.mark.parametrize("text", [BEAM, BAR])
def test_tables_are_written_as_they_are_read(tmp_path: Path, text: str) -> None:
    tables = tomllib.loads(text)
    assert tomllib.loads(written(tables)) == tables
    rng = random.Random(3)
    for _ in range(100):
        changed, touched = mutated_tables(rng, tables, 2)
        assert touched
        text_again = written(changed)
        assert written(tomllib.loads(text_again)) == text_again
    assert tomllib.loads(text) == tables
    assert any(mutated_bytes(rng, text.encode(), 1) != text.encode() for _ in range(3))


def test_the_files_to_begin_with_are_right(tmp_path: Path) -> None:
    for name, content in base_files().items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "bar.toml").write_text(BAR)
    assert load_case(tmp_path / "beam.toml").output.measured == (tmp_path / "measured.csv").resolve()
    assert load_case(tmp_path / "bar.toml").discretization.nuclei == (tmp_path / "nuclei.txt").resolve()
