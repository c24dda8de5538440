"""Files of cases: what is read, what is refused at once, and the case that a run leaves behind."""

from __future__ import annotations

import json
import math
import os
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from changes import TINY_BEAM
from fissura import Case, InputError
from fissura.case import case_from_dict, load_case
from fissura.study.definition import load_study

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="kinds of files that Windows does not have")
COMPLETE = f"{TINY_BEAM}\ncontrol.target = 1e-5\n"


def refusal(path: Path, read: Callable[[Path], Any] = load_case) -> InputError:
    with pytest.raises(InputError) as caught:
        read(path)
    return caught.value


@POSIX
@pytest.mark.parametrize("read", [load_case, load_study])
def test_files_that_never_end_or_never_begin_are_not_read(tmp_path: Path, read: Callable[[Path], Any]) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    (tmp_path / "to_pipe.json").symlink_to(tmp_path / "pipe.toml")
    for name in ("pipe.toml", "zero.toml", "to_pipe.json"):
        error = refusal(tmp_path / name, read)
        assert error.key == str(tmp_path / name)
        assert error.problem == "is not a regular file"
        assert "TOML" in error.allowed


def test_files_too_large_for_tables_are_not_read(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    with path.open("wb") as file:
        file.truncate(10**10)  # takes no space
    assert refusal(path).problem == "has 1e+04 MB, more than 2 MB"


def test_a_case_of_a_study_is_read_with_the_same_care(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text('specimens = [{ name = "a", case = "folder" }]')
    (tmp_path / "folder").mkdir()
    error = refusal(tmp_path / "study.toml", load_study)
    assert error.key == "specimens[0].case"
    assert error.problem.endswith("folder: is a folder")


@POSIX
def test_names_that_are_not_utf_8(tmp_path: Path) -> None:
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/a\xff.toml"))
    path.write_text(COMPLETE)
    case = load_case(path)
    assert case.name == "a_"
    assert json.loads(case.model_dump_json())["name"] == "a_"
    path.write_text(f"{COMPLETE}output.measured = 'nothing'")
    error = refusal(path)
    assert error.key == "output.measured"
    path.write_text("a = ")
    assert refusal(path).key == str(path).replace("\udcff", "\\udcff")
    assert str(refusal(path)).encode()


@pytest.mark.parametrize(
    ("stem", "name"),
    [("a:b", "a_b"), ("ü" * 200, "ü" * 100), ("😀" * 100, "😀" * 60), ("a\x7f\u2028b", "a__b"), ("...", "case")],
)
def test_a_case_is_named_after_its_file(tmp_path: Path, stem: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fissura.case.load.read_case_file", lambda path: (None, tomllib.loads(COMPLETE)))
    case = load_case(tmp_path / f"{stem}.toml")
    assert case.name == name
    (tmp_path / case.name).mkdir()


@pytest.mark.parametrize("name", ["a\x7f", "\udcff", "a\u2028b", "😀" * 61])
def test_what_cannot_name_a_folder(name: str) -> None:
    with pytest.raises(InputError, match=r"name: .* cannot name a folder"):
        case_from_dict({**tomllib.loads(COMPLETE), "name": name})


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("a." * 100_000 + "b = 1", "has a key of more than 20 parts in line 1"),
        ("\n[a]\n" + "'x y' . \"b\\\"c\".d." * 10_000 + "b = 1", "has a key of more than 20 parts in line 3"),
        ("seed = 1\n[" + ".".join("ab" * 15) + "]", "has a key of more than 20 parts in line 2"),
        ("a = " + "{b = " * 30 + "1" + "}" * 30, "is nested too deeply"),
        ("a = " + "[" * 30 + "]" * 30, "is nested too deeply"),
        ("seed = 1\nmaterial.E = " + "9" * 5000, "has a number of 5000 digits in line 2"),
    ],
)  # fmt: skip
def test_tables_that_no_case_has(tmp_path: Path, text: str, problem: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(text)
    assert refusal(path).problem == problem


@pytest.mark.parametrize("number", ["0x" + "f" * 50_000, "0b" + "1" * 50_000, "0o" + "7" * 50_000])
def test_numbers_of_thousands_of_digits_in_other_bases(tmp_path: Path, number: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(f"{COMPLETE}seed = {number}\n".replace("seed", "solver.threads"))
    error = refusal(path)
    assert error.key == "solver.threads"
    assert "digits is too large" in error.problem


@pytest.mark.parametrize(("key", "named"), [('""', '""'), ('"a b.c"', '"a b.c"'), ('"\\u001b[31m"', '"\\x1b[31m"')])
def test_strange_keys_are_named_as_they_are_written(tmp_path: Path, key: str, named: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(f"{key} = 1\n{COMPLETE}")
    assert refusal(path).key == named
    path.write_text(f"{COMPLETE}output.{key} = 1\n")
    assert refusal(path).key == f"output.{named}"


# The case of a run as JSON


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_json_of_a_case_is_the_same_case(path: Path, tmp_path: Path) -> None:
    case = load_case(path)
    (tmp_path / "case.json").write_text(case.model_dump_json(exclude={"source"}), encoding="utf-8")
    again = load_case(tmp_path / "case.json")
    assert again == case
    assert again.name == path.stem
    assert again.source is None


@given(*[st.floats(-1, 1).filter(lambda x: abs(x) > 1e-9)] * 3)
def test_directions_read_again_are_the_same(x: float, y: float, z: float) -> None:
    data = tomllib.loads(COMPLETE)
    data["load"]["direction"] = [x, y, z]
    case = case_from_dict(data)
    assert case.load.direction is not None
    assert math.hypot(*case.load.direction) == pytest.approx(1.0, rel=1e-15)
    assert case.load.direction == pytest.approx([c / math.hypot(x, y, z) for c in (x, y, z)], rel=1e-14)
    assert case_from_dict(json.loads(case.model_dump_json())) == case


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("{", "is not JSON"),
        ("[1]", "does not hold tables"),
        ("null", "does not hold tables"),
        ("[" * 100_000, "is nested too deeply"),
        ('{"a":' * 30 + "1" + "}" * 30, "is nested too deeply"),
        ('{"seed": ' + "9" * 5000 + "}", "has a number of 5000 digits in line 1"),
        ("", "is not JSON"),
    ],
)
def test_json_that_is_no_case(tmp_path: Path, text: str, problem: str) -> None:
    path = tmp_path / "case.json"
    path.write_text(text)
    assert problem in refusal(path).problem


def test_json_cannot_smuggle_what_is_not_finite(tmp_path: Path, small_case: Callable[..., Case]) -> None:
    path = tmp_path / "case.json"
    path.write_text(small_case().model_dump_json().replace("60000000000.0", "NaN"))
    assert refusal(path).key == "material.E"
