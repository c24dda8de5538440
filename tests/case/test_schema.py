"""The JSON schema of case files: what the reader takes, it takes; what editors should mark, it refuses."""

from __future__ import annotations

import copy
import json
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from changes import replaced
from conftest import SMALL_BEAM
from fissura.case import Case
from fissura.case.schema import case_schema
from fissura.cli import app

jsonschema = pytest.importorskip("jsonschema")

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
TEMPLATES = sorted(Path(str(files("fissura") / "templates")).glob("*.toml"))


@pytest.fixture(scope="module")
def schema() -> Any:
    return jsonschema.Draft7Validator(case_schema())


def test_it_is_a_schema_that_json_can_hold(schema: Any) -> None:
    jsonschema.Draft7Validator.check_schema(schema.schema)
    assert json.loads(json.dumps(schema.schema, allow_nan=False)) == schema.schema
    text = json.dumps(schema.schema)
    for word in ('"null"', "$defs", "prefixItems", '"title": "E"'):
        assert word not in text


@pytest.mark.parametrize("path", [*EXAMPLES, *TEMPLATES], ids=lambda path: path.stem)
def test_examples_and_templates(schema: Any, path: Path) -> None:
    schema.validate(tomllib.loads(path.read_text(encoding="utf-8")))


CHANGES: dict[str, Any] = {
    "notch": {"on": "bottom", "at": [60, 0, 0], "depth": 20, "unit": "mm"},
    "minus": {"cylinder": {"diameter": "9 mm", "through": [0.03, 0.03, 0], "axis": "z"}},
    "specimen": {"outline": [[0, 0], ["50 mm", 0], {"to": [0, 50], "radius": -60}], "thickness": 10, "unit": "mm"},
    "supports__0": {"type": "clamp", "on": ["left", "right"], "toward": [1, 0, 0], "platen": {"contact": "glued"}},
    "load__platen": "frictionless",
    "load__line": [[0, 0, 0], ["1 cm", 0, 0]],
    "loads": {"a": {"face": "top", "direction": [0, -1, 0]}},
    "material": {"macro": {"E": "38 GPa", "nu": 0.18}, "f_t": 2e6, "G_t": "35 Nm/m^2", "n_c": 2},
    "material__mine": {"shear": 1.0},
    "materials": {"region": {"type": "ball", "center": [0, 0, 0], "radius": 0.1}, "f_t": "3 MPa", "E": 30e9},
    "field": {"length": ["1 cm", 0.02, 0.03], "cov": "20 %", "leading": [0.1, -1], "energy": {"cov": 0.3}},
    "field__length": 0.05,
    "stage": {"load": {"a": 0.5}, "control": "force", "to": ["1 kN", "5 % of load"], "max_step": "100 N"},
    "gravity": {"density": "2400 kg/m^3", "direction": [0, 0, 1]},
    "adaptivity": {"tolerance": "1 %", "coarsen": True, "regions": [{"type": "box", "lower": [0, 0, 0],
                   "upper": ["1 mm", 1, 1]}]},
    "output": {"vtk": 0, "measured": "file.csv", "checkpoint": "1 min"},
    "solver": {"linear": "amg", "threads": 4},
    "ensemble": {"runs": 3, "vary": {"material": {"f_t": ["2 MPa", 3e6]}, "field.length": [0.1]}, "combine": "grid"},
    "seed": 12,
}  # fmt: skip


@pytest.mark.parametrize("key", CHANGES)
def test_what_the_reader_takes(schema: Any, key: str) -> None:
    schema.validate(replaced(SMALL_BEAM, {key: CHANGES[key]}))


def test_cases_as_they_are_written(schema: Any, small_case: Any) -> None:
    """Every value that a case has, but those that TOML cannot hold."""

    def without_none(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: without_none(item) for key, item in value.items() if item is not None}
        return [without_none(item) for item in value] if isinstance(value, list) else value

    for changes in ({}, {"field": {"length": 0.05}}, {"specimen": {"cylinder": {"diameter": 0.1, "length": 0.2}}}):
        data = replaced(SMALL_BEAM, changes)
        schema.validate(without_none(Case.model_validate(data).model_dump(mode="json")))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("materiel", {}),
        ("material__ft", 1.0),
        ("material__f_t", True),
        ("material__f_t", "strong"),
        ("discretization__l_f", []),
        ("supports__0__type", "pim"),
        ("supports__0__at", {"x": 1}),
        ("load__platen", "loose"),
        ("load__direction", [1, 0]),
        ("control__type", "force"),
        ("control__switch", "yes"),
        ("control__max_iterations", 0),
        ("seed", 1.5),
        ("seed", -1),
        ("specimen__size", [1, 2]),
        ("adaptivity__regions", [{"type": "cone"}]),
        ("stage", {"control": "gauge"}),
        ("gravity", {"density": None}),
    ],
)
def test_what_editors_mark(schema: Any, key: str, value: Any) -> None:
    assert not schema.is_valid(replaced(SMALL_BEAM, {key: value}))


@pytest.mark.parametrize("key", ["specimen", "supports", "material", "discretization"])
def test_what_is_missing(schema: Any, key: str) -> None:
    data = copy.deepcopy(SMALL_BEAM)
    del data[key]
    assert not schema.is_valid(data)


def test_defaults_and_descriptions(schema: Any) -> None:
    tables = schema.schema["definitions"]
    assert tables["Gravity"]["properties"]["acceleration"]["default"] == 9.81
    steps = tables["Control"]["properties"]
    assert steps["max_step"]["description"].endswith("by default it follows target")
    assert steps["tolerance"]["default"] == 1e-4
    assert "2.2 MPa" in tables["Material"]["properties"]["f_t"]["description"]
    assert tables["Patch"]["properties"]["unit"]["type"] == "string"
    for name, table in tables.items():
        assert table["description"], name


def test_commands(schema: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new case names the file that the other command writes."""
    runner = CliRunner()
    found = runner.invoke(app, ["schema"])
    assert (found.exit_code, json.loads(found.stdout)) == (0, schema.schema)
    text = runner.invoke(app, ["new", "beam"]).stdout
    assert text.startswith("#:schema ./fissura.schema.json\n# ")
    assert "fissura schema > fissura.schema.json" in text.splitlines()[1]
    schema.validate(tomllib.loads(text))
