"""Docstrings: those of public names are complete, and all examples in the package run and give what they say."""

from __future__ import annotations

import dataclasses
import doctest
import importlib
import inspect
import re
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from pydantic import BaseModel

import fissura

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"

#: Examples that need a screen, or what stands for one.
RENDER = doctest.register_optionflag("RENDER")

#: Checks of numpydoc that are off, and why.
OFF = {
    "ES01": "a name whose summary says all needs no more",
    "SA01": "related names stand beside each other on the page of names",
    "SS05": "it takes every plural in front, such as 'Rows of', for a verb",
    "PR01": "checked below, where fields of data are attributes",
}


def reference() -> list[str]:
    """Names on the page, in its order."""
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    return re.findall(r"^::: (\S+)$", page, re.MULTILINE)


def found(name: str) -> Any:
    parts = name.split(".")
    for k in range(len(parts) - 1, 0, -1):
        try:
            value = importlib.import_module(".".join(parts[:k]))
        except ImportError:
            continue
        for part in parts[k:]:
            value = getattr(value, part)
        return value
    raise AssertionError(name)


def is_property(value: Any) -> bool:
    return isinstance(value, property | cached_property)


def members(name: str) -> Iterator[str]:
    """Public methods and properties of a class that are Fissura's own."""
    classes = [base for base in found(name).__mro__ if base.__module__.startswith("fissura.")]
    for member in dict.fromkeys(key for base in classes for key in vars(base) if not key.startswith("_")):
        value = inspect.getattr_static(found(name), member)
        if is_property(value) or inspect.isroutine(value):
            yield f"{name}.{member}"


def public() -> list[str]:
    """Names on the page, and what their classes have."""
    names = reference()
    return [one for name in names for one in (name, *(members(name) if inspect.isclass(found(name)) else ()))]


def fields(value: Any) -> list[str]:
    """What a class of data has, or a function takes."""
    if inspect.isclass(value) and dataclasses.is_dataclass(value):
        return [field.name for field in dataclasses.fields(value) if not field.name.startswith("_")]
    if inspect.isclass(value) and issubclass(value, BaseModel):
        return list(value.model_fields)
    if inspect.isclass(value) and "__init__" not in vars(value):
        return []
    return [name for name in inspect.signature(value).parameters if name not in ("self", "cls")]


def documented(value: Any) -> set[str]:
    """Names in sections Parameters and Attributes of a docstring."""
    from numpydoc.docscrape import NumpyDocString

    sections = NumpyDocString(inspect.getdoc(value) or "")
    listed = (*sections["Parameters"], *sections["Attributes"])
    return {name.strip("* ") for part in listed for name in part.name.split(",")}


@pytest.mark.parametrize("name", public())
def test_public_names_are_documented(name: str) -> None:
    validate = pytest.importorskip("numpydoc.validate").validate
    value = found(name.rpartition(".")[0]) if is_property(_static(name)) else found(name)
    off = set(OFF)
    if is_property(_static(name)):
        off.add("EX01")  # what has the property has an example
    elif missing := set(fields(value)) - documented(value):
        pytest.fail(f"{name}: {', '.join(sorted(missing))}: neither in Parameters nor in Attributes")
    assert [error for error in validate(name)["errors"] if error[0] not in off] == []


def _static(name: str) -> Any:
    outer, _, member = name.rpartition(".")
    return inspect.getattr_static(found(outer), member, None) if "." in outer else None


def test_a_name_without_sections_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """As far as these checks go: no parameter, no returned value and no example may be missing."""
    validate = pytest.importorskip("numpydoc.validate").validate

    def bare(case: Any) -> int:
        """Do something."""
        return 1

    monkeypatch.setattr(fissura, "bare", bare, raising=False)
    assert {code for code, _ in validate("fissura.bare")["errors"]} - set(OFF) == {"RT01", "EX01"}
    assert set(fields(bare)) - documented(bare) == {"case"}


def modules() -> list[str]:
    """Modules with examples."""
    files = [path for path in SOURCE.rglob("*.py") if ">>>" in path.read_text(encoding="utf-8")]
    return sorted(".".join(path.relative_to(SOURCE).with_suffix("").parts) for path in files)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A working directory with the examples in it."""
    folder = tmp_path_factory.mktemp("examples")
    (folder / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    return folder


@pytest.fixture(scope="module")
def names(place: Path) -> Iterator[dict[str, Any]]:
    """What examples begin with: the lines that the page of names gives."""
    mpl.use("Agg")
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    (lines,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    space: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        exec(lines, space)
    yield space
    from matplotlib import pyplot

    pyplot.close("all")


@pytest.mark.parametrize("module", modules())
def test_examples_run(module: str, names: dict[str, Any], place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fissura.pictures.pyvista_tools import can_render

    monkeypatch.chdir(place)
    source = importlib.import_module(module)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    tests = [test for test in doctest.DocTestFinder().find(source, extraglobs={**names}) if test.examples]
    assert tests
    told: list[str] = []
    for test in tests:
        for example in test.examples:
            if example.options.get(RENDER) and not can_render():
                example.options[doctest.SKIP] = True
        runner.run(test, out=told.append)
    assert not told, "".join(told)
