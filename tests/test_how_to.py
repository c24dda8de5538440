"""Pages of docs/how-to: a stranger puts their files into an empty folder, and sees what they say."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from changes import replaced
from conftest import SMALL_BEAM
from fissura.case import case_from_dict, registry
from fissura.case.adaptivity import Adaptivity
from fissura.case.model import Case, Gauge, Material, Solver, Support
from fissura.case.named import NameIn, Registry
from fissura.case.schema import case_schema
from fissura.case.shape import Specimen
from fissura.errors import InputError

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "benchmarks"))
from blocks import Block, blocks  # noqa: E402

PAGES = sorted((ROOT / "docs" / "how-to").glob("*.md"))

#: Lines of the one file, blank ones and comments aside.
MOST_LINES = 60


def blocks_of(page: Path) -> list[Block]:
    return list(blocks(page.read_text(encoding="utf-8")))


def files_of(page: Path) -> dict[str, str]:
    """Files of a page by name; the first one is what is added."""
    return {block.title: block.text for block in blocks_of(page) if block.title}


def commands(page: Path) -> list[str]:
    return [line for block in blocks_of(page) if block.language == "bash" for line in block.text.splitlines()]


def printed(folder: Path, *words: str) -> str:
    """What Python prints in a folder, in a process of its own."""
    done = subprocess.run([sys.executable, *words], cwd=folder, env=os.environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    for name, text in files_of(request.param).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_seven_are_there() -> None:
    assert [page.stem for page in PAGES] == ["criterion", "gauge", "law", "observer", "picture", "shape", "solver"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_is_one_short_file_and_one_registration(page: Path) -> None:
    files = files_of(page)
    first, *_ = files.values()
    lines = [line for line in first.splitlines() if line.strip() and not line.strip().startswith("#")]
    assert len(lines) <= MOST_LINES
    program = files["run.py"]
    entered = re.findall(r"^[A-Z]+\[.*\] = ", program, re.MULTILINE)
    assert len(entered) == (0 if page.stem == "observer" else 1)


@pytest.mark.parametrize(
    ("page", "folder"), [(page, page) for page in PAGES], ids=lambda p: p.stem, indirect=["folder"]
)
def test_a_stranger_sees_what_the_page_says(page: Path, folder: Path) -> None:
    (shown,) = [block.text for block in blocks_of(page) if block.language == "text"]
    found = printed(folder, "run.py")
    if page.stem == "picture":
        assert "Crack opening over the height" in (folder / "results" / "beam" / "report.html").read_text(
            encoding="utf-8"
        )
    number = r"[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?"
    assert re.sub(number, "N", found) == re.sub(number, "N", shown)
    numbers = [[float(value) for value in re.findall(number, text)] for text in (found, shown)]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.02)  # processors differ in last digits, steps may follow


PACKAGED = [page for page in PAGES if "pyproject.toml" in files_of(page)]


@pytest.mark.parametrize("folder", PACKAGED, ids=lambda page: page.stem, indirect=True)
def test_a_package_offers_it_to_the_command_line(folder: Path, request: pytest.FixtureRequest) -> None:
    """As an installation leaves it: its name is known without a program that enters it."""
    (group, entries), *_ = tomllib.loads((folder / "pyproject.toml").read_text())["project"]["entry-points"].items()
    info = folder / "mine-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    ((name, where),) = entries.items()
    (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {where}\n")
    kinds = {one.group: one for one in vars(registry).values() if isinstance(one, Registry)}
    kind = next(key for key, one in vars(registry).items() if one is kinds[group])
    code = f"from fissura.case.registry import {kind}; print(*{kind}, {kind}.named({name!r}))"
    assert name in printed(folder, "-c", code)
    page = next(page for page in PAGES if files_of(page)["run.py"] == (folder / "run.py").read_text())
    for command in commands(page):
        program, *words = command.split()
        assert program == "fissura"
        if words[0] != "report":  # the folder that it reads is made by the program
            printed(folder, "-m", "fissura", *words)


NAMED = {
    "LAWS": (Material, "law"),
    "CRITERIA": (Adaptivity, "criterion"),
    "SOLVERS": (Solver, "linear"),
    "SUPPORTS": (Support, "type"),
    "SHAPES": (Specimen, "shape"),
}


@pytest.mark.parametrize("kind", NAMED)
def test_registries_and_case_models_agree(kind: str) -> None:
    """Every name can be loaded, the case model takes its names from the registry, and the schema lists them."""
    names: Registry[object] = getattr(registry, kind)
    model, key = NAMED[kind]
    (mark,) = [mark for mark in model.model_fields[key].metadata if isinstance(mark, NameIn)]
    assert set(names) <= set(mark.names)
    assert all(names[name] is not None for name in names)
    assert case_schema()["definitions"][model.__name__]["properties"][key]["enum"] == list(mark.names)


def test_every_registry_is_told_of() -> None:
    """Registries that a case names by the keys of tables, or that pages show, are the others."""
    kinds = {key for key, one in vars(registry).items() if isinstance(one, Registry)}
    assert kinds == {*NAMED, "GAUGES", "PICTURES", "ENSEMBLE_PICTURES"}
    assert Gauge.registry is registry.GAUGES
    assert Case.model_fields["gauge"].annotation == Gauge | None


@pytest.mark.parametrize(
    ("changes", "key", "allowed"),
    [
        ({"specimen": {"egg": {}}}, "specimen.egg", "outline"),
        ({"gauges": {"girth": {"chain": {}}}}, "gauges.girth.chain", "a, b, direction"),
        ({"adaptivity": {"criterion": "mises"}}, "adaptivity.criterion", "rankine, utilisation"),
        ({"solver": {"linear": "gauss"}}, "solver.linear", "auto, amg, direct, two-level"),
        ({"material__law": "rubber"}, "material.law", "cusatis-cedolin"),
    ],
)
def test_unknown_names_give_one_clear_error(changes: dict[str, object], key: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        case_from_dict(replaced(SMALL_BEAM, changes))
    assert caught.value.key == key
    assert allowed in caught.value.allowed
