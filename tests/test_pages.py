"""Blocks of code in README, CONTRIBUTING and docs: every one is run or checked, but those whose page says why not.

Python is executed, page by page, in a folder with small copies of the examples. TOML is a case, or a part of one that
is put into a small case. Commands of shells must exist with all their options; quick ones are run. A comment right
before a block changes that:

* ``<!-- test: not run: REASON -->``: only its syntax, and the options of its commands, are checked.
* ``<!-- test: slow -->``: run with the slow tests.
* ``<!-- test: part of KEY -->``, ``<!-- test: each line -->``, ``<!-- test: other specimen -->``: TOML that belongs
  into a table, whose lines are alternatives, or whose places are on a specimen that the block does not describe.
* ``<!-- test: study -->``, ``<!-- test: calibration -->``, ``<!-- test: package -->``: TOML of a study, of tests to be
  calibrated to, or of another package.
* ``<!-- test: own names -->``: TOML with names that the page adds; ``test_how_to.py`` reads it where they are known.
"""

from __future__ import annotations

import importlib
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import typer
import yaml
from typer.testing import CliRunner

import fissura
from fissura.calibration.request import request_of
from fissura.case import case_from_dict
from fissura.cli import app
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.study.definition import study_from_dict

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "benchmarks"))
from blocks import Block, blocks  # noqa: E402

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
EVERY = [(path, block) for path in PAGES for block in blocks(path.read_text(encoding="utf-8"))]

#: Languages of blocks that show what was printed, or are tested with the commands around them.
SHOWN = {"text", "diff"}
SHELLS = {"bash", "sh"}

#: Programs other than fissura, python and pip that commands on pages may call.
OTHERS = {
    "source",
    ".ci/run",
    ".ci/package",
    "mkdocs",
    "lint-imports",
    "ruff",
    "mypy",
    "dask",
    "umask",
    "mkdir",
    "cd",
    "openssl",
}

#: Commands that are run, not only parsed: they take no more than a second or two.
QUICK = {"new", "schema"}

#: What a block leaves out of a case.
REST = {
    "specimen": {"size": [0.2, 0.2, 0.05]},
    "supports": [{"type": "clamp", "face": "bottom"}],
    "load": {"face": "top"},
    "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
    "discretization": {"l_f": 0.02},
    "control": {"type": "displacement", "target": 1e-4},
}


def of(*languages: str) -> list[Any]:
    """All blocks in some languages, as parameters."""
    found = [(path, block) for path, block in EVERY if block.language in languages]
    return [pytest.param(path, block, id=f"{path.name}:{block.line}") for path, block in found]


def test_every_block_has_a_language_that_is_tested() -> None:
    known = SHOWN | SHELLS | {"python", "toml", "yaml"}
    assert [f"{path.name}:{block.line}" for path, block in EVERY if block.language not in known] == []
    for path in PAGES:
        text = path.read_text(encoding="utf-8")
        assert len(re.findall(r"^ *```", text, re.MULTILINE)) == 2 * len(list(blocks(text))), path


def test_notes_are_those_that_mean_something() -> None:
    forms = r"not run: .{10,}|slow|part of \w+|each line|other specimen|study|calibration|package|own names"
    assert [block.note for _, block in EVERY if block.note and not re.fullmatch(forms, block.note)] == []
    for path in PAGES:  # a comment that stands before no block would change nothing
        text = path.read_text(encoding="utf-8")
        assert text.count("<!-- test: ") == sum(bool(block.note) for block in blocks(text)), path


# TOML


def with_rest(given: dict[str, Any]) -> dict[str, Any]:
    """A part of a case with what it leaves out, in which it may say something else in other words."""
    rest = dict(REST)
    for key, instead in (("loads", "load"), ("stage", "control"), ("load", "load"), ("control", "control")):
        if key in given:
            rest.pop(instead, None)
    parts = [key for key in ("material", "specimen", "discretization", "control") if isinstance(given.get(key), dict)]
    for key in parts:
        filled = {name: value for name, value in REST[key].items() if name not in given[key]}
        if key == "specimen" and {"outline", "cylinder", "mesh"} & set(given[key]):
            filled.pop("size", None)
        if key == "material" and "macro" in given[key]:
            filled = {name: value for name, value in filled.items() if name not in ("E", "alpha")}
        given = {**given, key: {**filled, **given[key]}}
    return {**rest, **given}


def check_case(given: dict[str, Any], *, places: bool) -> None:
    """A case, or a part of one, is valid; so are its places, if they are on the specimen."""
    case = case_from_dict(with_rest(given), ROOT, files_exist=False)
    if places:
        conditions_from_case(case, domain_from_case(case))


@pytest.mark.parametrize(("path", "block"), of("toml"))
def test_toml_is_a_case_or_a_part_of_one(path: Path, block: Block) -> None:
    if block.note in ("package", "own names"):
        assert tomllib.loads(block.text)
    elif block.note == "calibration":
        request_of(tomllib.loads(block.text))
    elif block.note == "study":
        study_from_dict(tomllib.loads(block.text), ROOT / "benchmarks")
    elif block.note == "each line":
        for line in filter(None, block.text.splitlines()):
            check_case(tomllib.loads(line), places=False)
    elif block.note.startswith("part of "):
        check_case({block.note.split()[-1]: tomllib.loads(block.text)}, places=False)
    else:
        check_case(tomllib.loads(block.text), places=not block.note)


@pytest.mark.parametrize(("path", "block"), of("yaml"))
def test_yaml_can_be_read(path: Path, block: Block) -> None:
    assert yaml.safe_load(block.text)


# Shells


def commands(text: str) -> Iterator[list[str]]:
    """Words of the commands of a block, each without what comes before it and where its output goes."""
    for line in text.replace("\\\n", " ").splitlines():
        for part in re.split(r"&&|;|\|", line.partition("  #")[0] if not line.startswith("#") else ""):
            words = shlex.split(part, comments=True)
            while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
                words = words[1:]
            if words:
                yield words


def words_of(words: list[str]) -> list[str]:
    """A command without ``&`` and without where its output goes."""
    kept = words[: words.index(">")] if ">" in words else words
    return [word for word in kept if word != "&"]


def check_fissura(words: list[str]) -> str:
    """The command exists and takes these arguments; returns its name."""
    command: Any = typer.main.get_command(app)
    context = command.context_class(command, info_name="fissura")
    name, given = words[0], words
    if not name.startswith("-"):
        command, given = command.get_command(context, name), words[1:]
        assert command is not None, f"there is no command {name}"
        context = command.context_class(command, info_name=name)
    command.make_parser(context).parse_args(list(given))
    return name


def check_python(words: list[str]) -> None:
    """A script of the repository has these options."""
    if words[0] == "-m":
        assert words[1] in {"venv", "pytest"}
        return
    text = (ROOT / words[0]).read_text(encoding="utf-8") + (ROOT / "benchmarks" / "common.py").read_text()
    for word in words[1:]:
        if word.startswith("--"):
            assert f'"{word.partition("=")[0]}"' in text, word


def check_pip(words: list[str]) -> None:
    """Extras that are named exist."""
    assert words[0] == "install"
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    for found in re.findall(r"(?:^|\s)(?:fissura|\.)\[(.*?)\]", " ".join(words)):
        assert set(found.split(",")) <= set(extras)


def check_examples(text: str) -> None:
    """Files of the repository that are named exist."""
    for name in re.findall(r"(?<![\w/])((?:examples|benchmarks)/[\w./-]+\.\w+)", text):
        assert (ROOT / name).exists(), name


@pytest.mark.parametrize(("path", "block"), of(*SHELLS))
def test_commands_exist(path: Path, block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    check_examples(block.text)
    for found in commands(block.text):
        words = words_of(found)
        program = words[0] if words[0].startswith(".ci/") else words[0].rpartition("/")[2]
        if program == "fissura":
            if check_fissura(words[1:]) in QUICK:
                result = CliRunner().invoke(app, words[1:])
                assert result.exit_code == 0, result.output
        elif program in {"python", "python3"}:
            check_python(words[1:])
        elif program == "pip":
            check_pip(words[1:])
        else:
            assert program in OTHERS, f"{program} is neither checked nor among the other programs"


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_commands_in_the_text_exist(path: Path) -> None:
    """Pieces of text such as `fissura run case.toml --full`; those with capitals or dots leave something out."""
    text = path.read_text(encoding="utf-8")
    check_examples(text)
    for found in re.findall(r"`fissura ([^`\n]+)`", text):
        words = [word for word in shlex.split(found.partition(">")[0].replace("…", "")) if word not in {"...", "|"}]
        if words:
            check_fissura(words)


# Python


@pytest.fixture
def examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to run Python in: examples with bodies twice as large, a case of ``fissura new``, and results."""
    (tmp_path / "examples").mkdir()
    for path in (ROOT / "examples").glob("*.toml"):
        text = path.read_text(encoding="utf-8").replace('l_f = "10 mm"', 'l_f = "20 mm"')
        (tmp_path / "examples" / path.name).write_text(text, encoding="utf-8")
    beam = (files("fissura") / "templates" / "beam.toml").read_text(encoding="utf-8")
    (tmp_path / "beam.toml").write_text(beam.replace('l_f = "10 mm"', 'l_f = "20 mm"'), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("path", "block"), of("python"))
def test_python_can_be_compiled(path: Path, block: Block) -> None:
    compile(block.text, f"{path.name}:{block.line}", "exec")


def python_of(path: Path, *, slow: bool) -> list[Block]:
    """Python of a page that is run, quickly or slowly."""
    found = [block for where, block in EVERY if where == path and block.language == "python"]
    return [block for block in found if not block.note.startswith("not run") and (block.note == "slow") == slow]


#: The tutorial's and the start page's Python belongs to their commands and is run with these; test_how_to.py runs that
#: of pages of docs/how-to.
WORKED = ("tutorial.md", "index.md")
QUICK_PYTHON = [
    path
    for path in PAGES
    if path.name != "tutorial.md" and path.parent.name != "how-to" and python_of(path, slow=False)
]
SLOW_PYTHON = [path for path in PAGES if python_of(path, slow=True)]


@pytest.mark.parametrize("path", QUICK_PYTHON, ids=lambda path: path.name)
def test_python_runs(path: Path, examples: Path) -> None:
    """One block after another, with the names of those before."""
    module = ModuleType("page")
    sys.modules["page"] = module  # classes look for the module that they are in
    try:
        for block in python_of(path, slow=False):
            exec(compile(block.text, f"{path.name}:{block.line}", "exec"), module.__dict__)
    finally:
        del sys.modules["page"]


@pytest.mark.slow
@pytest.mark.parametrize("path", SLOW_PYTHON, ids=lambda path: path.name)
def test_slow_python_runs(path: Path, examples: Path) -> None:
    """Each block as a program of its own, as some of them start processes."""
    for block in python_of(path, slow=True):
        program = examples / "program.py"
        program.write_text(block.text, encoding="utf-8")
        subprocess.run([sys.executable, str(program)], cwd=examples, check=True)


# Pages that are worked through: all commands and all Python, one after another, and what they print


@pytest.fixture
def tutorial() -> ModuleType:
    """The script that runs pages."""
    return importlib.import_module("tutorial")


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def test_the_tutorial_changes_lines_that_are_there(tutorial: ModuleType, tmp_path: Path) -> None:
    text = (files("fissura") / "templates" / "beam.toml").read_text(encoding="utf-8")
    (change,) = [block for block in blocks(page("tutorial.md")) if block.language == "diff"]
    assert change.title is not None
    (tmp_path / change.title).write_text(tutorial.changed(text, change.text), encoding="utf-8")
    case = fissura.load_case(tmp_path / change.title)
    assert case.specimen.size == (0.7, 0.2, 0.05)
    assert [support.at for support in case.supports] == [0.1, 0.6]
    with pytest.raises(ValueError, match="0 times"):
        tutorial.changed(text, "-no such line\n+another")


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKED)
def test_pages_run_and_print_what_they_say(name: str, tutorial: ModuleType, tmp_path: Path) -> None:
    """All commands, changes of files and Python, one after another; rows of times and memory aside."""
    text = page(name)
    assert tutorial.differences(text, tutorial.worked(text, tmp_path)) == []
    if name == "tutorial.md":
        assert all((tmp_path / source).is_file() for source in tutorial.PICTURES.values())
        assert all(f"images/{picture}" in text for picture in tutorial.PICTURES)
