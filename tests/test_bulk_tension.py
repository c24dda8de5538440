"""Strength and fracture energy of the material as a whole: the table, and how it is read between its numbers."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fissura.bulk_tension import BulkTension, Prisms, bulk_tension
from fissura.cli import app

EXAMPLES = Path(__file__).parents[1] / "examples"

KNOWN = BulkTension(
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
    known = bulk_tension()
    assert len(known.shapes) >= 3
    assert known.limits("brittleness")[0] < 87.0 < known.limits("brittleness")[1]
    assert known.limits("alpha")[0] < 0.29 < known.limits("alpha")[1]
    assert all(group.prisms >= 4 for group in known.groups)
    # A whole needs no less than its contacts.
    assert all(group.strength > 1.0 and group.energy > 1.0 for group in known.groups)


def test_the_command_shows_them_beside_the_elastic_constants() -> None:
    done = CliRunner().invoke(app, ["elastic", str(EXAMPLES / "beam_d100.toml")])
    assert done.exit_code == 0
    rows = dict(line.split("  ", 1) for line in done.stdout.splitlines() if "  " in line)
    rows = {name: text.strip() for name, text in rows.items()}
    assert rows["contacts: f_t, G_t"] == "2.2 MPa, 35 J/m^2"
    low, high = bulk_tension().strength(2.0 * 60e9 * 35.0 / 2.2e6**2 / 0.01, 0.29)
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

    group = next(g for g in bulk_tension().groups if (g.width, g.length) == (4.0, 8.0))
    found = meaning.broken("width 4", 11)
    assert found["finished"]
    spread = 4.0 * math.sqrt(1.0 + 1.0 / group.prisms)
    assert abs(found["strength"] - group.strength) < spread * group.strength_std
    assert abs(found["energy"] - group.energy) < spread * group.energy_std
