"""Units as engineers write them, units that would never end, and values that are hard to show."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fissura.case.units import ENERGY_PER_AREA, LENGTH, STRESS, show, to_si
from fissura.errors import InputError, one_line


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("35 Nm/m^2", 35.0),  # RILEM writes it so
        ("35 Nm/m²", 35.0),
        ("35 N m/m^2", 35.0),
        ("35 N*m/m**2", 35.0),
        ("35 N·m/m²", 35.0),
        ("0.035 kNm/m2", 35.0),
        ("0.035 Nmm/mm²", 35.0),
        ("3500 Ncm/m^2", 35.0),
        ("35 N/m", 35.0),
        ("0.035 N/mm", 35.0),
        ("0.035 kN/m", 35.0),
        ("35 J/m2", 35.0),
        ("35 J m-2", 35.0),
        ("35 J m⁻²", 35.0),
        ("35 J/(m m)", 35.0),
        ("0.035 MPa·mm", 35.0),
        ("0.035 MPa⋅mm", 35.0),
        ("0.035 MPa mm", 35.0),
        ("0.035 mJ/mm^2", 35.0),
        ("35\u00a0J/m²", 35.0),
    ],
)
def test_energies_per_area(text: str, value: float) -> None:
    assert to_si(text, ENERGY_PER_AREA) == pytest.approx(value, rel=1e-14)


def test_stresses() -> None:
    assert to_si("2.2 N/(mm^2)", STRESS) == pytest.approx(2.2e6, rel=1e-14)
    assert to_si("2.2 MN m^-2", STRESS) == pytest.approx(2.2e6, rel=1e-14)
    assert to_si("0.22 kN/cm2", STRESS) == pytest.approx(2.2e6, rel=1e-14)


@pytest.mark.parametrize(
    "unit",
    [
        "(9**9**9)*m", "m**9**9**9", "m^9^9", "m**(9**9)", "(m**9)**9", "m**99", "m^-99", "m*9**9", "m²²", "m**-9**9",
        "((m))", "(m", "m)", "m**", "m//m", "m+m", "m-m", "m*-m", "m**2.5", "m**m", "9 m", "m*9", "m_", "os.system",
    ],
)  # fmt: skip
def test_what_is_not_a_unit_never_reaches_the_library(unit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fissura.case.units._registry", lambda: pytest.fail("asked"))
    with pytest.raises(ValueError, match="unit"):
        to_si(f"12 {unit}", LENGTH)


def test_moments_are_not_lengths() -> None:
    with pytest.raises(ValueError, match="measures something else"):
        to_si("5 Nm", LENGTH)  # the units library would find a number of metres, or nanometres


@pytest.mark.parametrize(
    "value",
    [np.float64(0.5), np.float32(0.5), np.float16(0.5)],
)
def test_numbers_of_numpy_are_numbers(value: Any) -> None:
    assert to_si(value, LENGTH) == 0.5
    assert type(to_si(value, LENGTH)) is float
    assert to_si(np.int64(3), LENGTH) == to_si(np.uint8(3), LENGTH) == 3.0


@pytest.mark.parametrize("value", [np.float64("nan"), np.float32("inf"), np.bool_(True), np.complex128(1), np.ones(2)])
def test_what_is_no_number_of_numpy(value: Any) -> None:
    with pytest.raises(ValueError, match="not"):
        to_si(value, LENGTH)


def _nested(depth: int) -> Any:
    value: Any = 1
    for _ in range(depth):
        value = {"a": [value]}
    return value


class _Mute:
    def __str__(self) -> str:
        raise RuntimeError


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (10**5000, "a whole number of about 5000 digits"),
        (-(16**6000), "a whole number of about 7225 digits"),
        ([10**5000], "[a whole number of about 5000 digits]"),
        (np.float64(0.5), "0.5"),
        (np.int64(3), "3"),
        (np.bool_(True), "true"),
        (math.inf, "inf"),
        ("a\n b\x1b[31m", '"a b\\x1b[31m"'),
        (_nested(100_000), "{'a': [{'a': [...]}]}"),
        (_Mute(), "an object of type _Mute"),
    ],
    ids=lambda value: value[:9] if isinstance(value, str) else type(value).__name__,
)
def test_every_value_can_be_shown(value: Any, shown: str) -> None:
    assert show(value) == shown


def test_long_values_are_shown_in_short() -> None:
    assert show("x" * 10**6) == f'"{"x" * 27}...{"x" * 28}"'
    assert len(show(list(range(10**6)))) <= 60


def test_messages_are_one_line_of_bounded_length() -> None:
    error = InputError("k" * 10**6, "p\r\n  q\x00" * 10**5, "a" * 10**6)
    assert len(str(error)) < 2500
    assert str(error).isprintable()
    assert InputError("key", "a  b", "c").problem == "a  b"
    assert one_line("a\udcffb", 80) == "a\\udcffb"
    assert one_line("0123456789", 10) == "0123456789"
    assert one_line("01234567890", 10) == "012...7890"
