"""`Case.with_`: values changed by dotted keys."""

from __future__ import annotations

from typing import Any

import pytest

from changes import replaced
from conftest import SMALL_BEAM
from fissura.case import Case, case_from_dict
from fissura.errors import InputError

STAGES: dict[str, Any] = {
    "load": None,
    "loads": {"left": {"face": "top", "at": 0.04}, "right": {"face": "top", "at": 0.08}},
    "control": None,
    "stage": [{"load": {"left": 0.5, "right": 0.5}, "to": ["10 um", "0.1 mm"]}],
}
MATERIALS: dict[str, Any] = {
    "materials": [
        {"region": {"type": "box", "lower": [0, 0, 0], "upper": [0.06, 0.06, 0.04]}, "f_t": "5 MPa"},
        {
            "region": {"type": "box", "lower": [0.06, 0, 0], "upper": [0.12, 0.06, 0.04]},
            "macro": {"E": "30 GPa", "nu": 0.2},
        },
    ]
}


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("seed", 7),
        ("material.f_t", "3 MPa"),
        ("material.macro.E", "30 GPa"),
        ("supports[1].at", "100 mm"),
        ("specimen.size[2]", "50 mm"),
        ("discretization.l_f", "6 mm"),
        ("adaptivity.tolerance", "1 %"),
        ("adaptivity.regions", [{"type": "ball", "center": [0, 0, 0], "radius": "9 mm"}]),
        ("control.target", "0.2 mm"),
        ("load.platen", "glued"),
        ("load", {"face": "top", "at": 70, "unit": "mm"}),
        ("gauges.side.a", {"face": "left"}),
        ("field.length", "30 mm"),
        ("gravity.density", "2400 kg/m^3"),
    ],
)
def test_the_same_as_in_the_case_file(small_case: Any, key: str, value: Any) -> None:
    """What a changed file would be read as, its derived defaults with it."""
    more: dict[str, Any] = {"adaptivity": {}, "load": {"face": "top", "at": 0.06, "width": 0.01}}
    if key.startswith("material.macro"):
        more["material"] = {"f_t": "2 MPa", "G_t": 30}
    changes: dict[str, Any] = {key: value}
    if key.startswith("material.macro"):
        changes["material.macro.nu"] = 0.2
    if key.startswith("gauges"):
        changes |= {"gauges.side.b": {"face": "right"}, "stage": {"gauge": "gauge", "to": "0.1 mm"}, "control": None}
    data = replaced(SMALL_BEAM, {k: v for k, v in more.items() if k != "material"})
    for name, new in changes.items():
        path = name.replace("[", "__").replace("]", "").replace(".", "__")
        if new is None:
            del data[path]
        else:
            data = replaced(data, {path: new})
    base = small_case(**more) if "material" not in more else _with_macro(small_case, more)
    if "material" in more:
        data["material"] = {"macro": {"E": "30 GPa", "nu": 0.2}, **more["material"]}
    assert base.with_(changes) == case_from_dict(data)


def _with_macro(small_case: Any, more: dict[str, Any]) -> Case:
    return small_case(**more | {"material": {"macro": {"E": "38 GPa", "nu": 0.18}, **more["material"]}})


def test_defaults_follow_and_what_was_given_stays(small_case: Any) -> None:
    case = small_case(material__f_c="40 MPa").with_({"material.f_t": "3 MPa", "discretization.l_c": "16 mm"})
    assert (case.material.f_s, case.material.f_c) == (9e6, 40e6)
    assert case.adaptivity.r_c == pytest.approx(0.016 + 2 * 0.016)


def test_changes_that_only_go_together_are_made_together(small_case: Any) -> None:
    case = small_case().with_({"control.max_step": "20 um", "control.target": "1 mm"})
    assert (case.control.target, case.control.max_step) == (1e-3, 2e-5)
    with pytest.raises(InputError, match=r"^control\.max_step: "):
        small_case().with_({"control.max_step": "20 um"})


def test_nothing_else_changes(small_case: Any) -> None:
    case = small_case()
    before = case.model_dump()
    assert case.with_({}) is case
    other = case.with_({"material.f_t": "3 MPa"})
    assert (other.specimen, other.supports) == (case.specimen, case.supports)
    assert case.model_dump() == before
    assert other.with_({"material.f_t": 2.2e6}) == case
    case.__dict__["source"] = "text"
    assert case.with_({"seed": 2}).source == "text"


def test_the_only_table_of_a_list_needs_no_index(small_case: Any) -> None:
    case = small_case()
    assert case.with_({"notch.depth": "20 mm"}) == case.with_({"notch[0].depth": "20 mm"})
    assert small_case(notch=[]).with_({"notch.depth": 0.03, "notch.position": 0.06}).notch == case.notch


def test_named_loads_and_stages(small_case: Any) -> None:
    case = small_case(**STAGES).with_({"loads.left.at": "30 mm", "stage.load.left": 0.4, "stage.to[1]": "0.2 mm"})
    assert case.loads["left"].at == 0.03
    assert case.stages[0].ratios == (("left", 0.4), ("right", 0.5))
    assert [target.value for target in case.stages[0].targets] == pytest.approx([1e-5, 2e-4])
    fewer = case.with_({"loads.left": None, "stage.load": "right"})
    assert list(fewer.loads) == ["right"]


def test_materials_of_regions(small_case: Any) -> None:
    case = small_case(**MATERIALS)
    before = case.model_dump()
    other = case.with_({"material.f_t": "3 MPa", "materials[0].G_t": 50, "materials[1].f_t": "1 MPa"})
    assert [m.f_t for m in other.resolved_materials] == [5e6, 1e6]
    assert [m.G_t for m in other.resolved_materials] == [50.0, 35.0]
    assert other.resolved_materials[1].E == case.resolved_materials[1].E
    assert case.with_({"materials[1].E": "20 GPa"}).resolved_materials[1].E == 20e9
    assert case.model_dump() == before  # settled with its own material, not with that of the copy
    assert case_from_dict(other.model_dump(mode="json")).resolved_materials == other.resolved_materials


@pytest.mark.parametrize(
    ("changes", "key", "told"),
    [
        ({"material.ft": 1}, "material.ft", "did you mean"),
        ({"materiel.f_t": 1}, "materiel", "did you mean material"),
        ({"material.f_t": "3 mm"}, "material.f_t", "MPa"),
        ({"supports[2].at": 1}, "supports[2]", "supports[0] to supports[1]"),
        ({"supports.at": 1}, "supports", "supports[0] to supports[1]"),
        ({"supports[1].at": "9 banana"}, "supports[1].at", "banana"),
        ({"supports[1].type": "pim"}, "supports[1].type", "pin, roller"),
        ({"seed.x": 1}, "seed", "neither a table nor a list"),
        ({"loads[0].at": 1}, "loads", "NAME"),
        ({"notch.depth": 0.02, "notch[0].width": 0.01}, "notch", "both with and without"),
        ({"load.unit": "mm"}, "load.unit", "a text with a unit"),
        ({"load": {}, "load.at": 1}, "load.at", "together with the table"),
        ({"load.at": 1, "load": {}}, "load", "together with values in it"),
        ({"gauge": None}, "gauge", ""),
        ({"": 1}, '""', "is no key"),
        ({"supports[-1].at": 1}, '"supports[-1].at"', "is no key"),
        ({"a..b": 1}, '"a..b"', "is no key"),
        ({3: 1}, "3", "is no key"),
    ],
)
def test_what_is_wrong_is_named(small_case: Any, changes: Any, key: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        small_case().with_(changes)
    assert caught.value.key == key
    assert told in str(caught.value)
