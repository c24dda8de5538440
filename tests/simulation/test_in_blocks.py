"""Runs with nuclei in blocks: the same specimen at every resolution, without placing all of it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import fissura
from conftest import small_beam
from fissura.errors import InputError
from fissura.simulation.memory import estimate_bodies, require_memory
from remembered import REMEMBERED

BLOCKS = {"discretization__placement": "blocks"}

#: `beam_d100` of the documentation: 350 x 100 x 50 mm, notched to half its depth.
D100 = {
    "specimen__size": [0.35, 0.1, 0.05],
    "notch": {"face": "bottom", "position": 0.175, "depth": 0.05},
    "supports": [{"type": "pin", "face": "bottom", "at": 0.05}, {"type": "roller", "face": "bottom", "at": 0.3}],
    "load__at": 0.175,
    "gauge": {"a": {"face": "bottom", "at": 0.17}, "b": {"face": "bottom", "at": 0.18}},
    "discretization": {"l_f": 0.01, "l_c": 0.04, "placement": "blocks"},
    "adaptivity__r_f": 0.04,
}

#: A beam of 10 m, with 10 million bodies at full resolution.
LONG = {
    "specimen__size": [10.5, 3.0, 0.45],
    "notch": {"face": "bottom", "position": 5.25, "depth": 1.5},
    "supports": [{"type": "pin", "face": "bottom", "at": 1.5}, {"type": "roller", "face": "bottom", "at": 9.0}],
    "load__at": 5.25,
    "gauge": {"a": {"face": "bottom", "at": 5.245}, "b": {"face": "bottom", "at": 5.255}},
    "discretization": {"l_f": 0.01, "l_c": 0.16, "placement": "blocks"},
    "adaptivity": {"r_f": 0.02, "r_c": 0.1, "calibrate": False},
}


def curve(simulation):
    return np.array([[step.controlled, step.load] for step in simulation.steps()]).T


def test_an_adaptive_run_follows_the_full_one():
    adaptive, full = (fissura.Simulation(small_beam(**D100), full=full) for full in (False, True))
    start, whole = adaptive.tessellation, full.tessellation
    assert len(start) < 0.5 * len(whole)
    assert np.isin(start.nucleus, whole.nucleus).all()
    inside = adaptive.start().layout.region.distance(whole.x) <= 0.0
    assert_array_equal(start.nucleus[start.fine], whole.nucleus[inside])
    assert_array_equal(start.x[start.fine], whole.x[inside])
    (gauge, load), (gauge_full, load_full) = curve(adaptive), curve(full)
    error = np.interp(gauge_full, gauge, load) - load_full
    assert np.abs(error).max() < 0.01 * load_full.max()


def test_what_was_known_before_has_no_influence_on_a_run():
    """A run whose nuclei are all placed beforehand has the same bits."""
    case = small_beam(**REMEMBERED["blocks"])
    plain, knowing = fissura.Simulation(case), fissura.Simulation(case)
    assert len(plain._discretization.nuclei) < len(knowing._discretization.nuclei.complete())
    knowing._discretization.nuclei = knowing._discretization.nuclei.complete()
    assert_array_equal(curve(plain), curve(knowing))
    assert len(plain.tessellation) > plain.bodies_start


def test_bodies_at_full_resolution_are_estimated():
    case = small_beam(**BLOCKS)
    adaptive, full = fissura.Simulation(case), fissura.Simulation(case, full=True)
    assert adaptive.bodies_full_estimated
    assert not full.bodies_full_estimated
    assert full.bodies_full == len(full.tessellation)
    assert adaptive.bodies_full == pytest.approx(full.bodies_full, rel=0.03)
    assert adaptive.told_full == f"about {adaptive.bodies_full}"
    assert full.told_full == f"{full.bodies_full}"
    rows = dict(fissura.check(case).table())
    assert rows["bodies at full resolution"] == adaptive.told_full
    assert not fissura.Simulation(small_beam()).bodies_full_estimated


def test_a_specimen_of_ten_metres_starts():
    case = small_beam(**LONG)
    assert estimate_bodies(case) == pytest.approx(1.07e7, rel=0.02)
    require_memory(case)
    simulation = fissura.Simulation(case)
    assert simulation.bodies_start < 8000
    assert len(simulation._discretization.nuclei) < 50_000
    assert simulation.tessellation.volume.sum() == pytest.approx(10.5 * 3.0 * 0.45, rel=1e-9)


def test_memory_is_that_of_what_is_placed(monkeypatch):
    """10 million nuclei take 4 GB, their coarse part nothing."""
    monkeypatch.setattr("fissura.simulation.memory.physical_memory", lambda: 2e9)
    require_memory(small_beam(**LONG))
    for changes in ({"discretization__placement": "saturated"}, {"discretization__l_c": 0.01}):
        with pytest.raises(InputError, match="placing them takes about 4"):
            require_memory(small_beam(**{**LONG, **changes}))
    with pytest.raises(InputError, match="solving them"):
        require_memory(small_beam(**LONG), full=True)


def test_regions_that_are_fine_from_the_start_count():
    changes = LONG | {"discretization": {"l_f": 0.002, "l_c": 0.032, "placement": "blocks"}}
    require_memory(small_beam(**changes))
    everywhere = {"type": "box", "lower": [0.0, 0.0, 0.0], "upper": LONG["specimen__size"]}
    changes["adaptivity"] = LONG["adaptivity"] | {"regions": [everywhere]}
    with pytest.raises(InputError, match=r"1\.3e\+09 bodies \(allowed: a spacing that gives at most 5e\+07"):
        require_memory(small_beam(**changes))


def test_given_nuclei_are_refused(tmp_path):
    np.save(tmp_path / "x.npy", np.array([[0.01, 0.02, 0.02]]))
    with pytest.raises(InputError) as caught:
        small_beam(tmp_path, **BLOCKS, discretization__nuclei="x.npy")
    assert caught.value.key == "discretization.nuclei"


@pytest.mark.slow
def test_prisms_are_as_stiff_as_with_nuclei_placed_at_once():
    """Means over 12 specimens; one of them scatters by 1 %."""
    case = fissura.case_from_dict(
        {
            "specimen": {"size": [0.24, 0.12, 0.12]},
            "supports": [{"type": "clamp", "face": "left"}],
            "load": {"face": "right", "direction": [1, 0, 0]},
            "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": 0.01},
            "control": {"type": "displacement", "target": 1e-5},
        }
    )

    def stiffness(placement: str) -> float:
        found = []
        for seed in range(12):
            simulation = fissura.Simulation(
                case.with_({"seed": seed, "discretization.placement": placement}), full=True
            )
            found.append(simulation.start().start.stiffness)
        return float(np.mean(found))

    assert stiffness("blocks") == pytest.approx(stiffness("saturated"), rel=0.01)
