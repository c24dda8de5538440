"""What a package index, conda and a citation say about the package: declared is what is used, and all say the same."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

#: Packages that are not imported by the name under which they are installed.
IMPORTED_AS = {"ipython": "IPython", "pillow": "PIL", "py-mkl-pardiso": "pymklpardiso"}

#: Imported only where the user has them: a message says so where gmsh is missing; in a notebook IPython is there.
FOUND_OR_NOT = {"gmsh", "IPython"}

#: What another package needs as it is and brings along, in one version that fits: numba and pydantic.
BROUGHT = {"llvmlite", "pydantic_core"}

#: Packages with another name on conda-forge; None: left out there.
ON_CONDA = {"matplotlib": "matplotlib-base", "py-mkl-pardiso": None}


def names(requirements: list[str]) -> dict[str, str]:
    """Names of packages and what they are bound to."""
    found = (re.fullmatch(r"([A-Za-z0-9_-]+)(\[[a-z,]+\])?\s*([<>=!~0-9.,]*)\s*(;.*)?", text) for text in requirements)
    return {match[1].lower(): match[3] for match in found if match}


def imported() -> set[str]:
    """Packages that modules of fissura import, in any of their lines."""
    found = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                found.add(node.module)
            elif isinstance(node, ast.Call) and ast.unparse(node.func) == "import_module":
                found |= {str(given.value) for given in node.args if isinstance(given, ast.Constant)}
    return {name.partition(".")[0] for name in found} - {"fissura"} - sys.stdlib_module_names


def as_imported(packages: dict[str, str]) -> set[str]:
    return {IMPORTED_AS.get(name, name) for name in packages}


def test_every_dependency_is_imported() -> None:
    assert as_imported(names(PROJECT["dependencies"])) <= imported()


def test_every_import_is_declared() -> None:
    optional = {
        name for group in PROJECT["optional-dependencies"].values() for name in as_imported(names(group)) - {"fissura"}
    }
    vtk = {"vtkmodules"}  # of PyVista
    known = as_imported(names(PROJECT["dependencies"])) | optional | FOUND_OR_NOT | BROUGHT | vtk
    assert imported() <= known


def test_the_recipe_of_conda_asks_for_the_same() -> None:
    recipe = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
    assert recipe["context"]["version"] == PROJECT["version"]
    assert f">={recipe['context']['python_min']}" == PROJECT["requires-python"]
    assert recipe["build"]["python"]["entry_points"] == [f"fissura = {PROJECT['scripts']['fissura']}"]
    assert recipe["about"]["license"] == PROJECT["license"]
    wanted = {ON_CONDA.get(name, name): bound for name, bound in names(PROJECT["dependencies"]).items()}
    wanted.pop(None)
    asked = dict(text.split(maxsplit=1) for text in recipe["requirements"]["run"])
    assert asked.pop("python") == ">=${{ python_min }}"
    assert asked == wanted


def test_the_citation_is_that_of_the_package() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    assert [author["name"] for author in citation["authors"]] == [author["name"] for author in PROJECT["authors"]]
    theory = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    for paper in citation["references"]:
        pages = f"({paper['year']}) {paper['start']}–{paper['end']}"
        assert f"*{paper['title']}*" in theory
        assert pages in theory
