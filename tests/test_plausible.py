"""Values that are allowed but look wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from changes import TINY_BEAM
from cli.fakes import call
from fissura.case import case_from_dict, case_notices, load_case

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))


def keys(small_case: Any, **changes: Any) -> list[str]:
    return [notice.key for notice in case_notices(small_case(**changes))]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_plausible(path: Path) -> None:
    assert case_notices(load_case(path)) == ()


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, []),
        ({"material__E": 1.01e9, "material__f_t": 1e6}, []),
        ({"material__E": 0.99e9, "material__f_t": 1e6}, ["material.E"]),
        ({"material__E": 0.99e12}, []),
        ({"material__E": 60e12}, ["material.E"]),
        ({"material__f_t": 1.1e4}, []),
        ({"material__f_t": 9e3}, ["material.f_t"]),
        ({"material__f_t": 2.2}, ["material.f_t"]),
        ({"material__f_t": 0.59e9}, []),
        ({"material__f_t": 0.61e9}, ["material.f_t"]),  # more than E/100
        ({"material__f_t": 2.2e9}, ["material.f_t", "material.f_t"]),
        ({"material__G_t": 0.11}, []),
        ({"material__G_t": 0.035}, ["material.G_t"]),
        ({"material__G_t": 35e3}, ["material.G_t"]),
        ({"material__f_s": 9e3, "material__f_t": 1.1e4}, ["material.f_s"]),
        ({"material__f_c": 9e3, "material__f_t": 1.1e4}, ["material.f_c"]),
        ({"material__G_s": 0.05, "material__G_t": 0.11}, ["material.G_s"]),
        ({"material__K_c": 0.9e9}, ["material.K_c"]),
        ({"specimen__size": [101.0, 50.0, 50.0], "control__target": 0.1}, ["specimen.size"]),
        (
            {"specimen__size": [9e-4, 4e-4, 4e-4], "control__target": 1e-6, "adaptivity": None}
            | {"discretization": {"l_f": 1e-4}},
            ["specimen.size"],
        ),
        ({"discretization": {"l_f": 0.04}}, []),  # l_c is 160 mm by default
        ({"discretization__l_c": 40}, ["discretization.l_c"]),
        ({"adaptivity": {"r_f": 16}}, ["adaptivity.r_f"]),
        ({"control__target": 0.0059}, []),
        ({"control__target": 0.1}, ["control.target"]),  # of 120 mm
        ({"control__target": 3.1e-8}, []),  # a tenth of 8 mm * 2.2 MPa / 60 GPa is 2.9e-8 m
        ({"control__target": 2.8e-8}, ["control.target"]),
        ({"field": {"length": 0.05, "cov": 0.9}}, []),
        ({"field": {"length": 0.05, "cov": 25, "marginal": "lognormal"}}, ["field.cov"]),
        ({"field": {"length": 0.05, "energy": {"cov": 25, "marginal": "lognormal"}}}, ["field.energy.cov"]),
        ({"field": {"length": 11.9}}, []),
        ({"field": {"length": 50}}, ["field.length"]),
        ({"field": {"length": [0.05, 0.05, 0.005]}}, ["field.length"]),
    ],
)
def test_what_looks_wrong(small_case: Any, changes: dict[str, Any], expected: list[str]) -> None:
    assert keys(small_case, **changes) == expected


def test_every_notice_says_what_to_do(small_case: Any) -> None:
    notices = case_notices(small_case(material__E=60000.0, material__f_t=5e4))
    assert str(notices[0]) == (
        "material.E: 60 kPa is very soft for concrete, below 1 GPa (what to do: see whether a unit is missing: "
        'numbers without one are in Pa; write such as "60 GPa")'
    )
    assert "50 kPa is 0.83 of E = 60 kPa" in str(notices[1])


def test_constants_of_the_concrete_are_named_as_they_were_given(small_case: Any) -> None:
    part = {"macro": {"E": 38e3, "nu": 0.18}, "f_t": 2.2e6, "G_t": 35.0}
    assert keys(small_case, material=part) == ["material.macro.E", "material.f_t", "control.target"]


def test_consistent_numbers_in_mm_and_MPa(tmp_path: Path) -> None:
    """They run as if they were m and Pa: `fissura check` names every one."""
    text = TINY_BEAM.replace(' mm"', '"').replace(" GPa", "000").replace(" MPa", "").replace("35 J/m^2", "0.035")
    for number in ("80", "20", "10", "40", "8", "70", "38", "42", "5", "60000", "2.2", "0.035"):
        text = text.replace(f'"{number}"', number)
    path = tmp_path / "mm.toml"
    path.write_text(text.replace("80, 20, 10", "180, 20, 10") + "control.target = 0.1\n")
    done = call("check", path)
    assert done.exit_code == 0, done.stderr
    for key in ("material.E", "material.f_t", "material.G_t", "specimen.size"):
        assert f"warning: {key}: " in done.stderr


def test_case_read_from_resolved_values(small_case: Any) -> None:
    case = case_from_dict(small_case().model_dump(mode="json"))
    assert case_notices(case) == ()
