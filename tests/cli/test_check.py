"""``fissura check``, and the memory that a run needs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fissura.api.check import check
from fissura.case import Case, load_case
from fissura.errors import InputError
from fissura.simulation import memory
from fissura.text.quantities import energy

from .fakes import EXAMPLE, TINY, FakeSimulation, call


def spacing(l_f: float) -> Case:
    case = load_case(EXAMPLE)
    return case.model_copy(update={"discretization": case.discretization.model_copy(update={"l_f": l_f})})


def test_estimates() -> None:
    assert memory.estimate_bodies(spacing(0.01)) == pytest.approx(0.734 * 35.6 * 10.6 * 5.6)
    assert 0.993e9 < memory.estimate_memory(23_647) < 1.3e9  # measured: 0.993e9
    assert 2.9e9 < memory.estimate_memory(101_000) < 4.4e9
    assert 0.448e9 < memory.estimate_elastic_memory(23_647) < 0.6e9  # measured: 0.448e9
    assert 1.25e9 < memory.estimate_elastic_memory(103_603) < 1.6e9  # measured: 1.248e9
    assert memory.estimate_elastic_memory(101_000) < memory.estimate_memory(101_000)
    assert 1e8 < memory.physical_memory() < 1e14


@pytest.mark.parametrize(
    ("l_f", "full", "refused"),
    [
        (0.01, False, False),
        (0.01, True, False),
        (0.001, False, False),  # 1.3 million bodies: 0.5 GB to place, 46 GB to solve
        (0.001, True, True),
        (0.0004, False, True),  # 8 GB to place
        (1e-5, False, True),
        (1e-9, False, True),
    ],
)
def test_memory_is_required(monkeypatch: pytest.MonkeyPatch, l_f: float, full: bool, refused: bool) -> None:
    monkeypatch.setattr(memory, "physical_memory", lambda: 4e9)
    if not refused:
        case = spacing(l_f)
        memory.require_memory(
            case.model_copy(update={"adaptivity": case.adaptivity.model_copy(update={"calibrate": False})}), full=full
        )
        return
    with pytest.raises(InputError) as caught:
        memory.require_memory(spacing(l_f), full=full)
    assert caught.value.key == "discretization.l_f"
    assert ("without full resolution" in caught.value.allowed) == full


def test_nuclei_of_a_file_need_memory_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file may have fewer nuclei than are placed at random, but not fewer than balls that cover the specimen."""
    (tmp_path / "x.txt").write_text("0.1 0.02 0.02\n")
    monkeypatch.setattr(memory, "physical_memory", lambda: 4e9)
    for l_f, refused in ((0.01, False), (1e-5, True)):
        case = spacing(l_f)
        case = case.model_copy(
            update={"discretization": case.discretization.model_copy(update={"nuclei": tmp_path / "x.txt"})}
        )
        if not refused:
            memory.require_memory(case, full=True)
            continue
        with pytest.raises(InputError, match=r"means at least 6\.1e\+11 bodies") as caught:
            memory.require_memory(case)
        assert caught.value.key == "discretization.l_f"
        volume, thinnest = 0.35 * 0.1 * 0.05, 1.4635 / (4 / 3 * np.pi)
        assert thinnest * volume / 1e-15 == pytest.approx(6.1e11, rel=0.01)


@pytest.mark.parametrize(
    ("place", "key"),
    [
        ("fissura.simulation.loop.Discretization", "discretization.l_f"),
        ("fissura.material.field.field._expanded", "field.length"),
    ],
)
def test_lack_of_memory_names_a_key(monkeypatch: pytest.MonkeyPatch, tiny: Path, place: str, key: str) -> None:
    def fail(*args: Any, **kwargs: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(place, fail)
    tiny.write_text(f'{TINY}field.length = "50 mm"\n')
    for command in (("check", "--build"), ("run",)):
        done = call(*command, tiny)
        assert done.exit_code == 2
        assert done.stderr.startswith(f"error: {key}: there is not enough memory for ")
        assert "GB" in done.stderr


def test_calibration_needs_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "physical_memory", lambda: 6e8)
    with pytest.raises(InputError) as caught:
        memory.require_memory(spacing(0.0035))
    assert caught.value.key == "adaptivity.calibrate"
    assert "false" in caught.value.allowed
    # The compliance of large specimens is extrapolated: 1.3 million bodies need no more than 40 000.
    monkeypatch.setattr(memory, "physical_memory", lambda: 9e8)
    memory.require_memory(spacing(0.001))


def test_run_refuses_what_does_not_fit(tiny: Path, fake: type[FakeSimulation]) -> None:
    tiny.write_text(TINY.replace('"5 mm"', '"1 um"'))
    for command in ("run", "check"):
        done = call(command, tiny)
        assert (done.exit_code, fake.built) == (2, [])
        assert "discretization.l_f" in done.stderr


def test_check_report(fake: type[FakeSimulation]) -> None:
    report = check(load_case(EXAMPLE))
    assert (report.bodies_start, report.bodies_full, report.contacts, report.fine_contacts) == (
        100,
        300,
        3,
        2,
    )
    assert report.limits["in tension"] == pytest.approx(2 * 60e9 * 35 / 2.2e6**2)
    assert report.limits["in shear"] == pytest.approx(report.limits["in tension"] * 16 * 0.29 / 9)
    assert report.longest_contact == pytest.approx(0.04)
    assert dict(report.table())["steps"] == "50 or more, each at most 2 µm"
    assert report.warnings == ()


@pytest.mark.parametrize("name", ["beam_d100", "nooru_mohamed"])
def test_check_on_a_fresh_machine_estimates_and_compiles_nothing(name: str, tmp_path: Path) -> None:
    path = Path(__file__).parents[2] / "examples" / f"{name}.toml"
    command = [sys.executable, "-m", "fissura", "check", str(path)]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert list(tmp_path.rglob("*.kernel")) == []
    assert "compiling" not in done.stderr
    exact = check(load_case(path))
    table = dict(line.split("  ", 1) for line in done.stdout.splitlines())
    assert float(table["bodies at full resolution"].split()[1]) == pytest.approx(exact.bodies_full, rel=0.03)
    assert "not counted" in table["bodies at start"]


def test_check_warns_of_long_contacts(tiny: Path, fake: type[FakeSimulation]) -> None:
    tiny.write_text(TINY.replace("35 J/m^2", "0.1 J/m^2"))
    done = call("check", "--build", tiny)
    assert done.exit_code == 0
    assert "warning: discretization.l_f: a fine contact may be longer than the law allows" in done.stderr
    assert "bodies at full resolution  300" in done.stdout
    assert "steps                      50 or more" in done.stdout
    assert not Path("results").exists()


@pytest.mark.parametrize(
    ("control", "told", "steps"),
    [
        ({"type": "gauge"}, "gauge, to 2 mm", "50 or more, each at most 40 µm"),
        (
            {"type": "displacement", "stop_load": 0.2},
            "displacement of the load, to 2 mm or until 20 % of the peak load is left",
            "50 or more, each at most 40 µm",
        ),
        (
            {"type": "dissipation"},
            "dissipated energy, until the gauge is 2 mm or 5 % of the peak load is left",
            f"each at most 40 µm, with energy in the lead {energy(35 * 0.012 * 0.01 / 50)}",
        ),
    ],
)
def test_check_tells_what_leads(
    tiny: Path, fake: type[FakeSimulation], control: dict[str, Any], told: str, steps: str
) -> None:
    text = ", ".join(f"{key} = {json.dumps(value)}" for key, value in control.items())
    tiny.write_text(TINY.replace('control.target = "2 um"', f'control = {{ target = "2 mm", {text} }}'))
    table = dict(check(load_case(tiny)).table())
    assert (table["control"], table["steps"]) == (told, steps)
