"""Reading and validating cases."""

from __future__ import annotations

import math
import subprocess
import sys
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from changes import ABSENT, replaced
from fissura.case import BallRegion, BoxRegion, Case, case_from_dict, load_case
from fissura.case.units import COMMON, ENERGY_PER_AREA, LENGTH, STRESS, _parsed_scale, to_si
from fissura.errors import InputError

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
TEMPLATES = sorted(
    path for path in Path(str(files("fissura") / "templates")).glob("*.toml") if path.stem != "mesh"
)  # that one needs a mesh: tests/test_templates.py

BASE: dict[str, Any] = tomllib.loads(
    """
specimen.size = ["350 mm", "100 mm", "50 mm"]
notch = { face = "bottom", position = "175 mm", depth = "50 mm" }
supports = [
    { type = "pin", face = "bottom", at = "50 mm" },
    { type = "roller", face = "bottom", at = "300 mm" },
]
load = { face = "top", at = "175 mm" }
gauge.a = { face = "bottom", at = "170 mm" }
gauge.b = { face = "bottom", at = "180 mm" }
material = { E = "60 GPa", alpha = 0.29, f_t = "2.2 MPa", G_t = "35 J/m^2" }
discretization.l_f = "10 mm"
control.target = "0.1 mm"
"""
)


def changed(**changes: Any) -> dict[str, Any]:
    """The base case with values replaced."""
    return replaced(BASE, changes)


def error_of(**changes: Any) -> InputError:
    with pytest.raises(InputError) as caught:
        case_from_dict(changed(**changes))
    return caught.value


# What a case says


def test_defaults() -> None:
    case = case_from_dict(BASE)
    assert (case.name, case.seed) == ("case", 1)
    assert case.specimen.shape == "box"
    assert case.specimen.size == (0.35, 0.1, 0.05)
    m = case.material
    assert (m.E, m.alpha, m.f_t, m.G_t) == (60e9, 0.29, 2.2e6, 35.0)
    assert (m.f_s, m.f_c, m.G_s) == pytest.approx((6.6e6, 35.2e6, 560.0))
    assert (m.K_c, m.mu, m.beta, m.n_c) == pytest.approx((15.6e9, 0.2, 1.0, 2.0))
    assert m.law == "cusatis-cedolin"
    assert (case.discretization.l_f, case.discretization.l_c) == (0.01, 0.04)
    a = case.adaptivity
    assert (a.criterion, a.gamma, a.r_f, a.r_c, a.notch_tips, a.regions) == (
        "utilisation",
        0.75,
        0.06,
        0.14,
        True,
        (),
    )
    c = case.control
    assert (c.type, c.target) == ("gauge", 1e-4)
    assert (c.first_step, c.max_step, c.min_step) == pytest.approx((5e-7, 2e-6, 1e-9))
    assert (c.tolerance, c.max_iterations) == (1e-4, 30)
    assert (c.switch, c.stop_load) == (True, 0.0)
    assert (case.output.vtk, case.output.measured) == (5, None)
    assert case.load.direction is None
    assert case.gauge is not None
    assert case.gauge.direction is None


def test_axis_of_a_face() -> None:
    data = changed(notch=[{"face": face, "position": 0.01, "depth": 0.01} for face in ("bottom", "left", "front")])
    assert [notch.normal for notch in case_from_dict(data).notch] == ["x", "y", "x"]
    case = case_from_dict(changed(load={"face": "right", "at": 0.01}, supports__0__along="z"))
    assert (case.load.along, case.supports[0].along) == ("y", "z")


def test_a_table_is_a_list_of_one_and_absent_is_none() -> None:
    assert len(case_from_dict(BASE).notch) == 1
    assert case_from_dict(changed(notch=ABSENT)).notch == ()
    assert case_from_dict(changed(notch=[BASE["notch"]])) == case_from_dict(BASE)


def test_radii_follow_the_spacings_that_are_given() -> None:
    a = case_from_dict(changed(discretization__l_c="15 mm", adaptivity__r_f="5 mm")).adaptivity
    assert (a.r_f, a.r_c) == pytest.approx((0.005, 0.035))


def test_small_steps_bound_the_first_and_smallest() -> None:
    control = case_from_dict(changed(control__max_step="1e-7 mm")).control
    assert control.min_step == control.first_step == control.max_step
    assert control.max_step == pytest.approx(1e-10)


def test_direction_becomes_a_unit_vector() -> None:
    case = case_from_dict(changed(load__direction=[0, -3, 4], gauge__direction=[1e200, 0, 1e200]))
    assert case.load.direction == pytest.approx((0, -0.6, 0.8))
    assert case.gauge is not None
    assert case.gauge.direction == pytest.approx((math.sqrt(0.5), 0, math.sqrt(0.5)))


def test_regions() -> None:
    regions = [
        {"type": "ball", "center": ["1 cm", 0.0, 0], "radius": "20 mm"},
        {"type": "box", "lower": [0, 0, 0], "upper": [1, 1, 1]},
    ]
    assert case_from_dict(changed(adaptivity__regions=regions)).adaptivity.regions == (
        BallRegion(type="ball", center=(0.01, 0.0, 0.0), radius=0.02),
        BoxRegion(type="box", lower=(0.0, 0.0, 0.0), upper=(1.0, 1.0, 1.0)),
    )


def test_elastic_regions_are_of_the_same_kinds() -> None:
    ball = {"type": "ball", "center": ["1 cm", 0.0, 0], "radius": "20 mm"}
    expected = BallRegion(type="ball", center=(0.01, 0.0, 0.0), radius=0.02)
    assert case_from_dict(BASE).material.elastic == ()
    for one_or_list in (ball, [ball]):
        case = case_from_dict(changed(material__elastic=one_or_list))
        assert case.material.elastic == (expected,)
        assert case_from_dict(case.model_dump()) == case


def test_dissipation_ends_with_the_load_and_records_the_gauge_if_there_is_one() -> None:
    case = case_from_dict(changed(control__type="dissipation"))
    assert (case.control.stop_load, case.quantity) == (0.05, "gauge")
    case = case_from_dict(changed(control__type="dissipation", gauge=ABSENT, control__stop_load=0))
    assert (case.control.stop_load, case.quantity) == (0.0, "displacement")


def test_displacement_control_needs_no_gauge() -> None:
    assert case_from_dict(changed(gauge=ABSENT, control__type="displacement")).gauge is None


def test_case_is_frozen_and_its_data_untouched() -> None:
    data = changed()
    case = case_from_dict(data)
    assert data == BASE
    with pytest.raises(ValueError, match="frozen"):
        case.seed = 3  # type: ignore[misc]


@pytest.mark.parametrize("mode", ["python", "json"])
def test_dump_validates_to_the_same_case(mode: Any) -> None:
    case = case_from_dict(changed(adaptivity__regions={"type": "ball", "center": [0, 0, 0], "radius": 1}))
    assert case_from_dict(case.model_dump(mode=mode)) == case
    assert Case.model_validate(case.model_dump(mode=mode)) == case


# Quantities


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("50 mm", LENGTH, 0.05),
        ("50mm", LENGTH, 0.05),
        (" 5 um ", LENGTH, 5e-6),
        ("5 µm", LENGTH, 5e-6),
        ("-2 cm", LENGTH, -0.02),
        ("1 inch", LENGTH, 0.0254),
        ("2.2 N/mm^2", STRESS, 2.2e6),
        ("60 GPa", STRESS, 60e9),
        ("35 J/m2", ENERGY_PER_AREA, 35.0),
        ("35 J/m²", ENERGY_PER_AREA, 35.0),
        ("0.035 N/mm", ENERGY_PER_AREA, 35.0),
        ("35 J m^-2", ENERGY_PER_AREA, 35.0),
        (3, LENGTH, 3.0),
    ],
)
def test_quantities(text: Any, dimension: Any, value: float) -> None:
    assert to_si(text, dimension) == pytest.approx(value, rel=1e-14)


@given(
    st.floats(-1e12, 1e12, allow_nan=False),
    st.sampled_from([("nm", 1e-9), ("µm", 1e-6), ("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("km", 1e3)]),
    st.sampled_from(["", " ", "  "]),
)
@settings(deadline=None)
def test_length_round_trip(number: float, unit: tuple[str, float], space: str) -> None:
    assert to_si(f"{number!r}{space}{unit[0]}", LENGTH) == pytest.approx(number * unit[1], rel=1e-14)


@pytest.mark.parametrize(("unit", "due"), [(unit, due) for due, known in COMMON.items() for unit in known])
def test_common_units_are_those_of_pint(unit: str, due: str) -> None:
    assert COMMON[due][unit] == _parsed_scale(unit, due)


@given(st.integers(1, 999), st.sampled_from(["kPa", "MPa", "GPa"]))
@settings(deadline=None)
def test_stress_of_text_and_number_are_the_same(number: int, unit: str) -> None:
    value = number * {"kPa": 1e3, "MPa": 1e6, "GPa": 1e9}[unit]
    case = case_from_dict(changed(material__f_t=f"{number} {unit}"))
    assert case == case_from_dict(changed(material__f_t=value))
    assert case.material.f_s == pytest.approx(3 * value)


BAD_LENGTHS = [
    "", " ", "5", "mm", "5 kg", "5 m^2", "20 degC", "5 dB", "5 dBm", "5 percent", "5 blargh", "5 MM",
    "0,5 mm", "1 000 mm",
    "5 mm + 3 mm", "5 mm * 2", "5 mm**9999999", "5 (((mm", "5 m/", "five mm", "nan mm", "inf mm",
    "-inf", "nan", "1e400 mm", "0x10 mm", "5 mm" * 30, "5 m\0m", "__import__('os') mm", "5 mm; 3",
    math.nan, math.inf, -math.inf, 10**400, True, False, [], {}, ["5 mm"], {"value": 5}, None,
]  # fmt: skip


@pytest.mark.parametrize("value", BAD_LENGTHS, ids=lambda value: repr(value)[:20])
def test_what_is_not_a_length(value: Any) -> None:
    error = error_of(notch__depth=value)
    assert error.key == "notch.depth"
    assert "a length" in error.allowed
    assert "\n" not in str(error)
    assert len(str(error)) < 300


# What is wrong in a case

FLAT_BOX = {"type": "box", "lower": [0, 0, 0], "upper": [1, 0, 1]}
EMPTY_BALL = {"type": "ball", "center": [0, 0, 0], "radius": 0}
MISSPELT_BALL = {"type": "ball", "centre": 1}

WRONG: list[tuple[str, dict[str, Any], str]] = [
    # wrong units name the key, and what is allowed
    ("notch.depth", {"notch__depth": "5 kg"}, "a length"),
    ("notch[0].depth", {"notch": [{"position": 0.1, "depth": "5 kg"}]}, "a length"),
    ("supports[1].at", {"supports__1__at": "3 s"}, "a length"),
    ("gauge.a.at", {"gauge__a__at": "3 MPa"}, "a length"),
    ("specimen.size[1]", {"specimen__size": [1, "3 N", 1]}, "a length"),
    ("material.E", {"material__E": "60 GN"}, "a stress"),
    ("material.G_t", {"material__G_t": "35 J/m"}, "an energy per area"),
    ("material.alpha", {"material__alpha": "0.29"}, "a number"),
    ("load.point[2]", {"load": {"face": "top", "point": [0, 0, "x"]}}, "a length"),
    # signs
    ("notch.depth", {"notch__depth": 0}, "positive"),
    ("notch.width", {"notch__width": "-1 mm"}, "zero or positive"),
    ("specimen.size[2]", {"specimen__size": [1, 1, "-3 mm"]}, "positive"),
    ("discretization.l_f", {"discretization__l_f": "0 mm"}, "positive"),
    ("material.f_t", {"material__f_t": -1}, "positive"),
    ("control.target", {"control__target": "-1 mm"}, "positive, 1 nm to 10 km; for a gauge that gets smaller"),
    ("control.tolerance", {"control__tolerance": 0}, "above 0"),
    ("control.max_iterations", {"control__max_iterations": 0}, "1 to 10000"),
    ("output.vtk", {"output__vtk": -1}, "0 to 10000"),
    ("seed", {"seed": -1}, "0 or larger"),
    ("seed", {"seed": 2**70}, "0 or larger"),
    # ranges
    ("material.alpha", {"material__alpha": 1.01}, "at most 1"),
    ("adaptivity.gamma", {"adaptivity__gamma": 0}, "above 0 and at most 1"),
    ("adaptivity.gamma", {"adaptivity__gamma": 1.5}, "above 0 and at most 1"),
    ("adaptivity.gamma", {"adaptivity__gamma": math.nan}, "above 0 and at most 1"),
    ("discretization.l_f", {"discretization__l_c": "5 mm"}, "l_c"),
    ("adaptivity.r_f", {"adaptivity__r_f": 2, "adaptivity__r_c": 1}, "r_c"),
    ("adaptivity.r_f", {"adaptivity__r_c": "1 mm"}, "r_c"),
    ("control.max_step", {"control__max_step": "0.0021 mm"}, "at most 2e-06 m"),
    ("control.first_step", {"control__first_step": "0.1 mm"}, "at most 2e-06 m"),
    ("control.min_step", {"control__min_step": "0.1 mm"}, "at most 5e-07 m"),
    ("load.direction", {"load__direction": [0, 0.0, 0]}, "not all zero"),
    ("load.direction", {"load__direction": [0, math.nan, 0]}, "three numbers"),
    ("adaptivity.regions[0].upper", {"adaptivity__regions": [FLAT_BOX]}, "above that of lower"),
    ("material.elastic[0].upper", {"material__elastic": [FLAT_BOX]}, "above that of lower"),
    ("material.f_t", {"material__f_t": 1e308}, "a stress"),
    # kinds
    ("seed", {"seed": True}, "whole number"),
    ("seed", {"seed": 1.5}, "whole number"),
    ("material.mu", {"material__mu": True}, "a number"),
    ("supports[0].at", {"supports__0__at": True}, "a length"),
    ("adaptivity.notch_tips", {"adaptivity__notch_tips": 1}, "true or false"),
    ("name", {"name": 3}, "text"),
    ("specimen.size", {"specimen__size": "3 mm"}, "three lengths"),
    ("specimen.size", {"specimen__size": [1, 2]}, "three lengths"),
    ("load.direction", {"load__direction": "down"}, "three numbers"),
    ("material", {"material": 3}, "a table"),
    ("notch", {"notch": 3}, "a list"),
    ("supports[0]", {"supports": [3]}, ""),
    ("control.type", {"control__type": "force"}, '"gauge", "displacement" or "dissipation"'),
    ("control.type", {"control__type": ["gauge"]}, '"gauge", "displacement" or "dissipation"'),
    ("control.switch", {"control__switch": "no"}, "true or false"),
    ("control.stop_load", {"control__stop_load": 1.5}, "0 to 1"),
    ("control.stop_load", {"control__stop_load": -0.1}, "0 to 1"),
    ("supports[0].type", {"supports__0__type": "hinge"}, 'clamp, guide, pin, roller'),
    ("notch.normal", {"notch__normal": "w"}, '"x", "y" or "z"'),
    ("adaptivity.regions[0].type", {"adaptivity__regions": [{"type": "cone"}]}, '"ball" or "box"'),
    ("adaptivity.regions[0].type", {"adaptivity__regions": [{"radius": 1}]}, '"ball" or "box"'),
    ("adaptivity.regions[0].type", {"adaptivity__regions": [{"type": 16**6000}]}, '"ball" or "box"'),
    ("adaptivity.regions[0].type", {"adaptivity__regions": [{"type": ["ball"]}]}, '"ball" or "box"'),
    ("adaptivity.regions[0].radius", {"adaptivity__regions": [EMPTY_BALL]}, "a length"),
    ("material.elastic[0].type", {"material__elastic": [{"type": "cone"}]}, '"ball" or "box"'),
    ("material.elastic.radius", {"material__elastic": EMPTY_BALL}, "a length"),
    # missing
    ("specimen", {"specimen": ABSENT}, "[specimen]"),
    ("supports", {"supports": ABSENT}, "[[supports]]"),
    ("supports", {"supports": []}, "[[supports]]"),
    ("load", {"load": ABSENT}, "[load]"),
    ("material.f_t", {"material__f_t": ABSENT}, "2.2 MPa"),
    ("discretization.l_f", {"discretization__l_f": ABSENT}, "10 mm"),
    ("control.target", {"control__target": ABSENT}, "0.1 mm"),
    ("gauge", {"gauge": ABSENT}, "[gauge]"),
    ("gauge.b", {"gauge__b": ABSENT}, "face"),
    ("load.face", {"load__face": ABSENT}, "name of a face"),
    # unknown
    ("discretization.lf", {"discretization__lf": 1, "discretization__l_f": ABSENT}, "l_f, l_c, nuclei"),
    ("supports[1].position", {"supports__1__position": 1}, "at"),
    ("Material", {"Material": {}}, "material"),
    ("adaptivity.regions[0].centre", {"adaptivity__regions": [MISSPELT_BALL]}, "center, radius"),
    # places and files
    ("load.point", {"load__point": [0, 0, 0]}, "one of at, point"),
    ("load.width", {"load": {"face": "top", "width": 0.01}}, "only with at"),
    ("output.measured", {"output__measured": "nope.csv"}, "path"),
    ("output.measured", {"output__measured": "."}, "path"),
    ("output.measured", {"output__measured": "a\0b"}, "path"),
    ("discretization.nuclei", {"discretization__nuclei": 3}, "path"),
    ("name", {"name": "../up"}, "100 characters"),
    ("name", {"name": ".."}, "100 characters"),
    ("name", {"name": ""}, "100 characters"),
]  # fmt: skip


@pytest.mark.parametrize(("key", "changes", "allowed"), WRONG, ids=[f"{k}-{i}" for i, (k, _, _) in enumerate(WRONG)])
def test_one_message_names_the_key(key: str, changes: dict[str, Any], allowed: str) -> None:
    error = error_of(**changes)
    assert error.key == key
    assert allowed in error.allowed
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("changes", "suggestion"),
    [
        ({"discretization__lf": 1}, "discretization.l_f"),
        ({"supports__1__att": 1}, "supports[1].at"),
        ({"material__e": 1}, "material.E"),
        ({"materail": {}}, "material"),
        ({"notch__posittion": 1}, "notch.position"),
        ({"control__maxstep": 1}, "control.max_step"),
    ],
)
def test_misspelt_key_gets_a_suggestion(changes: dict[str, Any], suggestion: str) -> None:
    assert f"did you mean {suggestion}?" in error_of(**changes).problem


def test_several_tables_where_one_is_due() -> None:
    load = {"face": "top", "at": 0.1}
    assert str(error_of(load=[load, load])) == "load: 2 tables are given (allowed: one table, [load])"
    assert str(error_of(gauge=[BASE["gauge"]])) == "gauge: is a list of tables, [[gauge]] (allowed: one table, [gauge])"
    assert error_of(material=[1]).problem == "[1] is not a table"


def test_strange_key_gets_no_suggestion() -> None:
    assert error_of(xyzzy=1).problem == "unknown key"


def test_further_problems_are_counted_not_listed_in_full() -> None:
    error = error_of(notch__depth="5 kg", material__E=-1, control__target=0)
    assert error.key == "notch.depth"
    assert error.problem.endswith("[and 2 more problems: material.E, control.target]")


def test_missing_key_brings_no_message_about_its_dependents() -> None:
    assert "more problem" not in error_of(material__f_t=ABSENT).problem
    assert "more problem" not in error_of(control__target="x").problem
    assert "more problem" not in error_of(discretization__l_f="x").problem


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["5 mm", "ball"]),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["type", "face", "at", "point", "l_f", "E", "a", "b", "q"]), inner, max_size=4
        )
    ),
    max_leaves=6,
)
PLACES = [
    "name", "seed", "specimen", "specimen__size", "notch", "notch__width", "supports", "supports__0", "load",
    "load__direction", "load__point", "gauge", "gauge__a", "material", "material__mu", "material__elastic",
    "discretization", "discretization__nuclei", "adaptivity", "adaptivity__regions", "adaptivity__criterion", "control",
    "control__type", "output", "output__measured", "extra",
]  # fmt: skip


@given(st.sampled_from(PLACES), JSON)
@settings(deadline=None, max_examples=300)
def test_any_nonsense_is_an_input_error_or_a_case(place: str, value: Any) -> None:
    case = error = None
    try:
        case = case_from_dict(changed(**{place: value}))
    except InputError as caught:
        error = caught
    if error is not None:
        assert error.key.startswith(place.split("__")[0])
        assert "\n" not in str(error)
    else:
        assert case is not None
        assert case_from_dict(case.model_dump()) == case


# Files


@pytest.mark.parametrize("path", [*EXAMPLES, *TEMPLATES], ids=lambda path: path.stem)
def test_examples_and_templates_are_valid(path: Path) -> None:
    case = load_case(path)
    assert case.name == path.stem
    assert case.source == path.read_text(encoding="utf-8")
    if path in EXAMPLES:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= (55 if case.stage else 32)


def test_examples_are_there() -> None:
    assert {path.stem for path in EXAMPLES} >= {
        "gregoire_d50_halfnotch",
        "beam_d100",
        "beam_d200",
        "beam_d400",
        "beam_350",
        "tension_bar",
        "notched_bar",
    }
    assert load_case(next(p for p in EXAMPLES if "gregoire" in p.stem)).output.measured is not None


def test_files_are_relative_to_the_case(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("# cmod_mm,min_N,max_N\n0.1,1,2\n")
    data = changed(output__measured="m.csv")
    assert case_from_dict(data, tmp_path).output.measured == (tmp_path / "m.csv").resolve()
    moved = case_from_dict(data, tmp_path / "elsewhere", files_exist=False)
    assert moved.output.measured == tmp_path / "elsewhere" / "m.csv"


def test_a_name_in_the_file_wins(tmp_path: Path) -> None:
    text = (EXAMPLES[0]).read_text(encoding="utf-8")
    (tmp_path / "a.toml").write_text('name = "b"\n' + text, encoding="utf-8-sig")
    assert load_case(tmp_path / "a.toml").name == "b"


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (None, "no such file"),
        (b"\xff\x00", "not UTF-8"),
        (b"\xff\xfea\x00", "is UTF-16 text"),
        (b"a = ", "not TOML"),
        (b"a = 1\na = 2", "not TOML"),
        (b"a = " + b"[" * 100_000, "not"),
        (b"<xml/>", "not TOML"),
    ],
)
def test_bad_file(tmp_path: Path, content: bytes | None, problem: str) -> None:
    path = tmp_path / "case.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=problem) as caught:
        load_case(path)
    assert caught.value.key == str(path)


def test_folder_and_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="folder"):
        load_case(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        load_case("a\0b")

    def refuse(self: Path, mode: str) -> bytes:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "case.toml").write_text("")
    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match="cannot be read: Permission denied"):
        load_case(tmp_path / "case.toml")


def test_empty_file_names_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text("")
    with pytest.raises(InputError, match=r"specimen: missing \[and 5 more problems") as caught:
        load_case(tmp_path / "case.toml")
    assert caught.value.key == "specimen"


def test_import_is_light() -> None:
    code = (
        "import sys, fissura; fissura.Case; fissura.load_case; fissura.InputError; fissura.__version__;"
        "print(*{'numba', 'scipy', 'pint', 'matplotlib'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_linear_solver() -> None:
    assert case_from_dict(BASE).solver.linear == "auto"
    assert case_from_dict(changed(solver={"linear": "two-level"})).solver.linear == "two-level"
    with pytest.raises(InputError, match=r"solver\.linear.*direct"):
        case_from_dict(changed(solver={"linear": "gauss"}))
