"""The bulk law: interpolation, its inverse, and cases that give the material instead of its contacts."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from typer.testing import CliRunner

from changes import replaced
from conftest import SMALL_BEAM
from fissura.api.check import check
from fissura.case import case_from_dict
from fissura.case.macroscopic import MacroscopicElasticity, macroscopic_elasticity, voigt
from fissura.cli import app
from fissura.errors import InputError

LAW = macroscopic_elasticity()

REFERENCE = [
    (0.0123, 0.3572359736361473),
    (0.07, 0.2805053450067579),
    (0.28, 0.18354576258561714),
    (0.456, 0.1283727407402915),
    (0.97, 0.006046295017203616),
]


def test_the_table():
    assert LAW.alpha[0] == 0.01
    assert (LAW.alpha[-1], LAW.nu[-1], LAW.error[-1]) == (1.0, 0.0, 0.0)
    assert all(a < b for a, b in itertools.pairwise(LAW.alpha))
    assert all(a > b for a, b in itertools.pairwise(LAW.nu))
    # Modulus to a third of a per cent, three standard errors.
    assert all(3 * 2 * error < 0.004 * (1 - 2 * nu) for error, nu in zip(LAW.error, LAW.nu, strict=True))


@pytest.mark.parametrize(("alpha", "nu"), REFERENCE)
def test_values_between_those_of_the_table(alpha, nu):
    """Against monotone cubics with the slopes of Fritsch and Butland (1984), written out in Python."""
    assert LAW.macroscopic(1.0, alpha)[1] == pytest.approx(nu, abs=1e-15)


@given(st.lists(st.floats(0.01, 1.0), min_size=5, max_size=5), st.floats(0.0, 1.0))
def test_any_descending_table_is_interpolated_without_bumps(falls, share):
    nu = tuple(float(value) for value in np.cumsum(falls[::-1])[::-1] - falls[-1])
    law = MacroscopicElasticity((0.04, 0.09, 0.25, 0.64, 1.0), nu, (0.0,) * 5)
    k = min(sum(place <= share for place in (0.25, 0.5, 0.75)), 3)  # one of the four intervals, and where in it
    low, high = (math.sqrt(law.alpha[i]) for i in (k, k + 1))
    assert nu[k + 1] - 1e-14 <= law._value(low + (4 * share - k) * (high - low)) <= nu[k] + 1e-14


def test_half_of_the_table_predicts_the_other_half():
    """Interpolation errs by less than the table, even with twice the distances."""
    half = MacroscopicElasticity(LAW.alpha[::2], LAW.nu[::2], LAW.error[::2])
    off = [half.macroscopic(1.0, a)[0] / (1.0 - 2.0 * nu) - 1.0 for a, nu in zip(LAW.alpha, LAW.nu, strict=True)]
    assert max(map(abs, off)) < 2.5e-4


@pytest.mark.parametrize("alpha", LAW.alpha)
def test_the_law_meets_its_table(alpha):
    E, nu = LAW.macroscopic(1.0, alpha)
    assert nu == pytest.approx(LAW.nu[LAW.alpha.index(alpha)], abs=1e-15)
    assert pytest.approx(1.0 - 2.0 * nu, rel=1e-15) == E


def test_alpha_one_is_exact():
    assert LAW.macroscopic(60e9, 1.0) == (60e9, 0.0)
    assert LAW.contact(60e9, 0.0) == (60e9, 1.0)


def test_the_law_stays_below_voigt_and_comes_near_it():
    for alpha in np.linspace(0.01, 0.99, 50):
        (E, nu), (E_voigt, nu_voigt) = LAW.macroscopic(1.0, alpha), voigt(alpha)
        assert E_voigt > E
        assert nu > nu_voigt
    assert LAW.macroscopic(1.0, 0.9)[0] == pytest.approx(voigt(0.9)[0], rel=1e-3)


@given(E=st.floats(1e3, 1e12), nu=st.floats(*LAW.range))
@example(E=38e9, nu=0.0)
@example(E=38e9, nu=LAW.range[1])
def test_forward_of_inverse(E, nu):
    contact, alpha = LAW.contact(E, nu)
    assert LAW.alpha[0] <= alpha <= 1.0
    assert LAW.macroscopic(contact, alpha) == pytest.approx((E, nu), rel=1e-12, abs=1e-14)


@given(E=st.floats(1e3, 1e12), alpha=st.floats(0.01, 1.0))
@example(E=60e9, alpha=0.01)
def test_inverse_of_forward(E, alpha):
    assert LAW.contact(*LAW.macroscopic(E, alpha)) == pytest.approx((E, alpha), rel=1e-11)


@pytest.mark.parametrize("nu", [-0.1, 0.37, 0.5, float("nan")])
def test_ratios_that_cannot_be_reached(nu):
    with pytest.raises(InputError, match=r"cannot be reached.*alpha = 0\.01"):
        LAW.contact(1.0, nu)


def test_other_impossible_constants():
    for E in (0.0, -1.0, float("inf"), float("nan")):
        with pytest.raises(InputError, match="not possible"):
            LAW.contact(E, 0.2)
    for alpha in (0.009, 1.1, float("nan")):
        with pytest.raises(InputError, match="outside the table"):
            LAW.macroscopic(1.0, alpha)


MACRO = {"f_t": 2.2e6, "G_t": 35.0, "macro": {"E": "38 GPa", "nu": 0.18}}


def case(**changes):
    return case_from_dict(replaced({**SMALL_BEAM, "material": MACRO}, changes))


def test_a_case_may_give_the_material():
    found = case().material
    assert (found.E, found.alpha) == LAW.contact(38e9, 0.18)
    assert found.K_c == 0.26 * found.E
    assert (found.f_t, found.G_s) == (2.2e6, 16 * 35.0)


def test_such_a_case_is_the_one_with_its_contacts():
    E, alpha = LAW.contact(38e9, 0.18)
    plain = case_from_dict({**SMALL_BEAM, "material": {"E": E, "alpha": alpha, "f_t": 2.2e6, "G_t": 35.0}})
    assert case() == plain
    assert case_from_dict(case().model_dump(mode="json")) == plain
    assert "macro" not in case().model_dump()["material"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"material__E": 60e9}, "material.E: is given together with macro"),
        ({"material__alpha": 0.29}, "material.alpha: is given together with macro"),
        ({"material__macro__nu": 0.4}, "material.macro.nu: 0.4 cannot be reached (allowed: a number from 0"),
        ({"material__macro__nu": -0.01}, "material.macro.nu: -0.01 cannot be reached"),
        ({"material__macro__nu": "0.2"}, 'material.macro.nu: "0.2" is text, not a plain number'),
        ({"material__macro__E": "38 mm"}, "material.macro.E: "),
        ({"material__macro__E": 0}, "material.macro.E: 0 is not positive"),
        ({"material__macro": {"E": 38e9}}, "material.macro.nu: missing (allowed: a number"),
        ({"material__macro": {"nu": 0.2}}, "material.macro.E: missing (allowed: a stress"),
        (
            {"material__macro": {"E": 38e9, "nu": 0.2, "mu": 0.2}},
            "material.macro.mu: unknown key; did you mean material.macro.nu?",
        ),
        ({"material__macro": 3}, "material.macro: 3 is not a table (allowed: a table with E and nu)"),
        ({"material": {"f_t": 2.2e6, "G_t": 35.0}}, "material.E: missing (allowed: a stress such as"),
        ({"material": {**MACRO, "marco": {}}}, "material.marco: unknown key; did you mean material.macro?"),
    ],
)
def test_wrong_materials_have_one_clear_message(changes, message):
    with pytest.raises(InputError) as caught:
        case(**changes)
    assert str(caught.value).startswith(message)
    assert "more problem" not in str(caught.value)


def test_check_shows_both_sets():
    rows = dict(check(case()).table())
    assert rows["elastic, contacts"] == "E 59.38 GPa, alpha 0.2902"
    assert rows["elastic, bulk"] == "E 38 GPa, nu 0.180"
    sparse = case_from_dict(replaced(SMALL_BEAM, {"material__alpha": 0.005, "material__G_t": 1e6}))
    assert dict(check(sparse).table())["elastic, bulk"] == "-"


def call(*arguments):
    return CliRunner().invoke(app, ["elastic", *map(str, arguments)])


@pytest.mark.parametrize("parts", [("E=38GPa", "nu=0.18"), ("nu = 0.18", "E = 38 GPa"), ("E=38e9", "nu=0.18")])
def test_inverse_on_the_command_line(parts):
    result = call("--inverse", *parts)
    assert result.exit_code == 0
    assert "59.38 GPa" in result.output
    assert "0.2902" in result.output
    assert 'macro = { E = "38 GPa", nu = 0.18 }' in result.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--inverse", "E=38GPa", "nu=0.4"), "--inverse nu: 0.4 cannot be reached"),
        (("--inverse", "E=38GPa", "nu=x"), "--inverse nu: 'x' is not a number"),
        (("--inverse", "E=38mm", "nu=0.2"), "--inverse E: "),
        (("--inverse", "E=-1", "nu=0.2"), "--inverse E: '-1' is negative"),
        (("--inverse", "E=1e300", "nu=0.2"), "--inverse E: '1e300' is too large"),
        (("--E", "60"), "--E: '60' is too small"),
        (("--E", "12 (9**9**9)*Pa"), '--E: "12 (9**9**9)*Pa" has a unit that is not known'),
        (("--alpha", "1e-300"), "--alpha: 1e-300 is out of range"),
        (("--alpha", ",".join(["0.3"] * 101)), "--alpha: the list has 101 entries"),
        (("--inverse", "E=38GPa", "E=30GPa"), "--inverse: 'E=30GPa' is not understood"),
        (("--inverse", "38GPa", "0.2"), "--inverse: '38GPa' is not understood"),
        (("--alpha", "0.1,x"), "--alpha: '0.1,x' is not a list of numbers"),
        (("--alpha", "0"), "--alpha: 0 is out of range"),
        (("--alpha", "nan"), "--alpha: nan is out of range"),
        (("--sizes", "3.9"), "--sizes: 3.9 is out of range"),
        (("--sizes", "4,100"), "--sizes: 100 is out of range"),
        (("--inverse", "E=38GPa", "nu=0.2", "--alpha", "0.3"), "--alpha: has no effect together with --inverse"),
        (("case.toml", "--seeds", "2"), "--seeds: has no effect together with a case"),
        (("--E", "x"), '--E: "x" is not a number with a unit'),
    ],
)
def test_wrong_options(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = call(*arguments)
    assert result.exit_code == 2
    assert result.output.startswith(f"error: {message}")
    assert not list(tmp_path.iterdir())


TEXT = """
specimen.size = [0.12, 0.06, 0.04]
supports = [{ type = "clamp", face = "left" }]
load = { face = "right" }
material = { f_t = 2.2e6, G_t = 35.0, macro = { E = "30 GPa", nu = 0.2 } }
discretization.l_f = 0.01
control = { type = "displacement", target = 1e-4 }
"""


def test_case_on_the_command_line(tmp_path):
    path = tmp_path / "block.toml"
    path.write_text(TEXT)
    result = call(path)
    assert result.exit_code == 0
    assert "50 GPa" in result.output
    assert "30 GPa, 0.6000 of that of the contacts" in result.output
    assert call(path, "--inverse", "E=1", "nu=0").exit_code == 2
    path.write_text(TEXT.replace('macro = { E = "30 GPa", nu = 0.2 }', "E = 1e9, alpha = 0.005"))
    result = call(path)
    assert result.exit_code == 2
    assert result.output.startswith("error: material.alpha: 0.005 is outside the table")
    assert call(tmp_path / "none.toml").exit_code == 2


def test_study_on_the_command_line(tmp_path):
    options = ("--alpha", "0.3,1", "--sizes", "4,5", "--seeds", 2, "--aspect", 1, "--E", "60 GPa")
    result = call(*options, "--output", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "periodic cell" in result.output
    assert "60 GPa" in result.output
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        ".fissura",
        "elastic.csv",
        "elastic_alpha.png",
        "elastic_size.png",
    ]
    again = call(*options, "--output", tmp_path / "out")
    assert again.exit_code == 2
    assert "is not empty" in again.output
