"""Strength and fracture energy of the material as a whole: the table, and how it is read between its numbers."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from fissura.case.macroscopic import macroscopic_elasticity
from fissura.cli import app
from fissura.elasticity.tension import MacroscopicTension, Prisms, macroscopic_tension

EXAMPLES = Path(__file__).parents[2] / "examples"

KNOWN = MacroscopicTension(
    (
        Prisms(4.0, 8.0, 80.0, 0.3, 5, 1.2, 0.05, 2.0, 0.4),
        Prisms(6.0, 12.0, 80.0, 0.3, 5, 1.1, 0.02, 1.9, 0.2),
        Prisms(6.0, 12.0, 20.0, 0.3, 5, 1.0, 0.02, 1.9, 0.2),
        Prisms(6.0, 12.0, 320.0, 0.3, 5, 1.32, 0.02, 3.8, 0.2),
        Prisms(6.0, 12.0, 80.0, 0.6, 5, 0.99, 0.02, 1.9, 0.2),
    )
)


def test_all_shapes_and_their_scatter_make_the_range() -> None:
    assert KNOWN.strength(80.0, 0.3) == pytest.approx((1.08, 1.25))
    assert KNOWN.energy(80.0, 0.3) == pytest.approx((1.6, 2.4))


@pytest.mark.parametrize(
    ("brittleness", "alpha", "strength", "energy"),
    [
        (20.0, 0.3, 1.0 / 1.1, 1.0),
        (320.0, 0.3, 1.2, 2.0),
        (160.0, 0.3, 1.1, 1.5),  # half of the way, in logarithms
        (80.0, 0.6, 0.9, 1.0),
        (320.0, 0.6, 1.08, 2.0),  # both
        (1.0, 0.3, 1.0 / 1.1, 1.0),  # the nearest beyond what is known
        (1e6, 0.01, 1.2, 2.0),
    ],
)
def test_brittleness_and_alpha_change_both_ends(
    brittleness: float, alpha: float, strength: float, energy: float
) -> None:
    assert KNOWN.strength(brittleness, alpha) == pytest.approx((1.08 * strength, 1.25 * strength))
    assert KNOWN.energy(brittleness, alpha) == pytest.approx((1.6 * energy, 2.4 * energy))


def test_the_table_of_the_package() -> None:
    known = macroscopic_tension()
    assert len(known.shapes) >= 3
    assert known.limits("brittleness")[0] < 87.0 < known.limits("brittleness")[1]
    assert known.limits("alpha")[0] < 0.29 < known.limits("alpha")[1]
    assert all(group.prisms >= 4 for group in known.groups)
    # A whole needs no less than its contacts.
    assert all(group.strength > 1.0 and group.energy > 1.0 for group in known.groups)


@given(st.floats(0.5e6, 10e6), st.floats(5.0, 500.0), st.floats(0.05, 1.0), st.floats(1e-3, 0.1))
def test_contacts_for_a_wanted_whole(strength: float, energy: float, alpha: float, l_f: float) -> None:
    """Their ranges have the wanted values in the middle."""
    f_t, G_t = macroscopic_tension().contact(strength, energy, 60e9, alpha, l_f)
    brittleness = 2.0 * 60e9 * G_t / f_t**2 / l_f
    assert 0.5 * sum(macroscopic_tension().strength(brittleness, alpha)) * f_t == pytest.approx(strength, rel=1e-9)
    assert 0.5 * sum(macroscopic_tension().energy(brittleness, alpha)) * G_t == pytest.approx(energy, rel=1e-9)


def test_the_command_finds_contacts_for_a_concrete() -> None:
    words = ["--inverse", "E=33.8GPa", "nu=0.2", "--tension", "G_F=125J/m^2", "f=3.5MPa", "l_f=8mm"]
    done = CliRunner().invoke(app, ["elastic", *words])
    assert done.exit_code == 0, done.stderr
    rows = dict(line.split("  ", 1) for line in done.stdout.splitlines() if "  " in line)
    E, alpha = macroscopic_elasticity().contact(33.8e9, 0.2)
    f_t, G_t = macroscopic_tension().contact(3.5e6, 125.0, E, alpha, 0.008)
    assert rows["contacts: f_t, G_t"].strip() == f"{f_t / 1e6:.4g} MPa, {G_t:.4g} J/m^2"
    assert rows["in a case file"].endswith(f'f_t = "{f_t / 1e6:.4g} MPa", G_t = "{G_t:.4g} J/m^2" }}')


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--tension", "f=3MPa", "G_F=100", "l_f=10mm"), "--tension: needs the elastic constants"),
        (("--inverse", "E=38GPa", "nu=0.2", "--tension", "f=3MPa", "G_F=100", "f=10mm"), "'f=10mm' is not understood"),
        (("--inverse", "E=38GPa", "nu=0.2", "--tension", "f=3mm", "G_F=100", "l_f=10mm"), "--tension f: "),
        (("--inverse", "E=38GPa", "nu=0.2", "--tension", "f=3MPa", "G_F=-1", "l_f=10mm"), "--tension G_F: '-1' is neg"),
    ],
)
def test_what_the_command_does_not_understand(words: tuple[str, ...], message: str) -> None:
    done = CliRunner().invoke(app, ["elastic", *words])
    assert done.exit_code != 0
    assert message in done.stderr


def test_the_command_shows_them_beside_the_elastic_constants() -> None:
    done = CliRunner().invoke(app, ["elastic", str(EXAMPLES / "beam_d100.toml")])
    assert done.exit_code == 0
    rows = dict(line.split("  ", 1) for line in done.stdout.splitlines() if "  " in line)
    rows = {name: text.strip() for name, text in rows.items()}
    assert rows["contacts: f_t, G_t"] == "2.2 MPa, 35 J/m^2"
    low, high = macroscopic_tension().strength(2.0 * 60e9 * 35.0 / 2.2e6**2 / 0.01, 0.29)
    assert rows["whole: strength"] == f"{2.2 * low:.4g} MPa to {2.2 * high:.4g} MPa, {low:.2f} to {high:.2f} f_t"
    assert rows["whole: fracture energy"].endswith(" G_t")
    assert "but" not in rows


def test_the_command_says_what_was_not_measured(tmp_path: Path) -> None:
    text = (EXAMPLES / "beam_d100.toml").read_text()
    path = tmp_path / "case.toml"
    path.write_text(text.replace('G_t = "35 J/m^2"', 'G_t = "5 J/m^2"\nf_s = "5 MPa"') + '[field]\nlength = "50 mm"\n')
    done = CliRunner().invoke(app, ["elastic", str(path)])
    assert done.exit_code == 0, done.stderr
    brittleness = 2.0 * 60e9 * 5.0 / 2.2e6**2 / 0.01
    notes = [line.removeprefix("but").strip() for line in done.stdout.splitlines() if line.startswith("but ")]
    assert notes[0].startswith(f"l_t / l_f is {brittleness:.3g}, measured from ")
    assert notes[1:] == [
        "measured with the default f_s, f_c and G_s",
        "measured without a random field, which weakens",
    ]


@pytest.mark.slow
def test_a_prism_is_as_the_table_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a seed of its own, within what one of ten prisms scatters."""
    monkeypatch.syspath_prepend(str(EXAMPLES.parent / "benchmarks"))
    monkeypatch.setattr(sys, "argv", ["meaning.py"])
    import meaning

    group = next(g for g in macroscopic_tension().groups if (g.width, g.length) == (4.0, 8.0))
    found = meaning.broken("width 4", 11)
    assert found["finished"]
    spread = 4.0 * math.sqrt(1.0 + 1.0 / group.prisms)
    assert abs(found["strength"] - group.strength) < spread * group.strength_std
    assert abs(found["energy"] - group.energy) < spread * group.energy_std
