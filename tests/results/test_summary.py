import json
import subprocess
import sys

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results.curve import columns, row
from fissura.results.summary import build_summary, peak_memory, read_summary, write_summary

from .synthetic import simulation, snapping, step, steps


def summary_of(recorded, **changes):
    curve = columns(row(s, 0.5 * s.number, 1.0 * s.number) for s in recorded)
    options = {"status": "finished", "message": "", "cpu_s": 3.0, "wall_s": 6.0, "memory": 1e8}
    return build_summary(simulation(), curve, **(options | changes))


def test_numbers():
    summary = summary_of(steps([100.0, 300.0, 200.0, 50.0], refinements=2))
    expected = {
        "case": "little beam",
        "seed": 7,
        "full": False,
        "criterion": "utilisation",
        "status": "finished",
        "peak_load_N": 300.0,
        "gauge_at_peak_m": 0.5e-4,
        "gauge_at_end_m": 1e-4,
        "dissipated_energy_J": 4e-3,
        "stored_J": 1e-3,
        "work_J": 5.01e-3,
        "initial_stiffness_N_per_m": 1.5e8,
        "bodies_start": 2,
        "bodies_end": 2,
        "bodies_full": 40,
        "bodies_full_estimated": False,
        "steps": 4,
        "refinements": 8,
        "iterations": 16,
        "linear_iterations": 120,
        "steps_led_by_energy": 0,
        "factorizations": 8,
        "iterations_per_step": 4.0,
        "max_elastic_utilisation": 0.8,
        "cpu_s": 3.0,
        "wall_s": 6.0,
        "warnings": [],
    }
    for key, value in expected.items():
        assert summary[key] == (pytest.approx(value) if isinstance(value, float) else value), key
    assert summary["energy_balance_error"] == pytest.approx(0.01e-3 / 5.01e-3)
    assert 1 < summary["peak_memory_MB"] < 1e5
    assert set(summary["versions"]) == {"fissura", "python", "numpy", "scipy", "numba"}


def test_steps_led_by_energy_are_counted():
    summary = summary_of(snapping())
    assert summary["steps_led_by_energy"] == 4
    assert (summary["gauge_at_peak_m"], summary["gauge_at_end_m"]) == (3e-5, 2.2e-5)


def test_late_refinement_is_a_warning():
    recorded = steps([1.0, 2.0, 3.0, 4.0])
    late = [
        step(2, 5e-5, 2.0, max_elastic_utilisation=1.1),
        step(3, 7.5e-5, 3.0, max_elastic_utilisation=1.23),
    ]
    (warning,) = summary_of([recorded[0], *late, recorded[3]])["warnings"]
    assert "1.23 times their strength at step 3 (gauge 75.0 µm): refinement came too late there" in warning
    assert "2 of 4 steps" in warning


def test_unknown_numbers_are_null_in_strict_json(tmp_path):
    summary = summary_of([step(1, 1e-6, 5.0, max_elastic_utilisation=float("nan"), work=0.0)])
    write_summary(tmp_path / "summary.json", summary)
    text = (tmp_path / "summary.json").read_text()
    read = json.loads(text, parse_constant=pytest.fail)
    assert read["max_elastic_utilisation"] is None
    assert read["energy_balance_error"] is None
    assert read_summary(tmp_path) == summary


def test_no_steps():
    summary = summary_of([], status="stopped", message="no equilibrium")
    assert summary["peak_load_N"] is None
    assert summary["steps"] == summary["linear_iterations"] == summary["steps_led_by_energy"] == 0
    assert summary["message"] == "no equilibrium"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "is not JSON"),
        ("[]", "format_version is None"),
        ('{"format_version": 99}', "format_version is 99"),
    ],
)
def test_broken_files(tmp_path, content, message):
    (tmp_path / "summary.json").write_text(content)
    with pytest.raises(InputError, match=message):
        read_summary(tmp_path)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_summary(tmp_path)


def test_files_of_an_ensemble_are_called_so(tmp_path):
    path = tmp_path / "ensemble.json"
    path.write_text("{}")
    with pytest.raises(InputError, match=r"the ensemble\.json of a Fissura ensemble"):
        read_summary(path)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere nothing is inherited")
def test_memory_is_that_of_the_process_alone():
    code = "from fissura.results.summary import peak_memory; print(peak_memory())"
    ballast = np.ones(40_000_000)  # 320 MB in this process
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ballast.nbytes <= peak_memory()
    assert 1e6 < float(done.stdout) < ballast.nbytes
