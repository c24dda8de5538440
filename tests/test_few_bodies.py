"""Specimens of a few bodies: they run, or are refused with the key that mends it."""

import numpy as np
import pytest

import fissura
from equilibrium.models import CONCRETE, beam
from fissura.api.check import check
from fissura.contact import CusatisCedolin
from fissura.equilibrium import System
from fissura.errors import InputError
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation.discretize import tessellate

#: A pulled cube twice as large as its bodies.
CUBE = {
    "specimen": {"size": [0.02, 0.02, 0.02]},
    "notch": None,
    "supports": [{"type": "clamp", "face": "left"}],
    "load": {"face": "right", "at": None, "direction": [1, 0, 0]},
    "gauge": None,
    "control": {"type": "displacement", "target": 2e-5},
    "output": {"vtk": 0},
}


def cube(size=0.02, **spacing):
    return beam(**{**CUBE, "specimen": {"size": [size] * 3}, "discretization": {"l_f": 0.01, **spacing}})


@pytest.mark.parametrize("seed", [1, 2])
def test_a_start_of_one_body_is_refused(seed):
    case = cube(l_c=0.04).model_copy(update={"seed": seed})
    for attempt in (fissura.run, check):
        with pytest.raises(InputError, match="the start has 1 body without any contact") as caught:
            attempt(case)
        assert caught.value.key == "discretization.l_c"
        assert "l_f = 0.01 m" in caught.value.allowed


def test_what_the_refusal_asks_for_runs():
    result = fissura.run(cube(l_c=0.01))
    assert result.summary["bodies_start"] == result.summary["bodies_full"] > 5
    assert result.summary["status"] == "finished"


@pytest.mark.parametrize("more", [{}, {"field": {"length": 0.01}}, {"adaptivity": {"criterion": "rankine"}}])
@pytest.mark.parametrize("full", [True, False])
def test_two_bodies_break(more, full):
    """One contact, as strong as it is wide."""
    case = beam(**{**CUBE, "specimen": {"size": [0.01] * 3}, "discretization": {"l_f": 0.01, "l_c": 0.01}, **more})
    result = fissura.run(case, full=full)
    assert result.summary["bodies_end"] == 2
    assert result.summary["status"] == "finished"
    assert result.curve["load_N"][-1] < 0.8 * result.peak_load
    (area,) = result.last.tessellation.contacts.area
    assert 0.1 < result.peak_load / (case.material.f_t * area) < 10.0


def test_everything_is_written_of_two_bodies(tmp_path):
    case = beam(**{**CUBE, "specimen": {"size": [0.01] * 3}, "discretization": {"l_f": 0.01, "l_c": 0.01}})
    fissura.run(case, output=tmp_path)
    written = {path.name for path in tmp_path.iterdir()}
    assert {"curve.csv", "summary.json", "state_last.npz", "section.npz", "curve.png", "crack.png"} <= written


def test_equations_without_contacts_are_refused():
    case = cube(l_c=0.01)
    domain = domain_from_case(case)
    alone = tessellate(np.full((1, 3), 0.01), np.zeros(1, int), domain.complex, domain.surfaces, np.full(1, 0.02))
    with pytest.raises(InputError, match="a single body is rigid") as caught:
        System(alone, CONCRETE, CusatisCedolin, conditions_from_case(case, domain))
    assert caught.value.key == "discretization.l_f"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"discretization": {"l_f": 0.01, "l_c": 0.02}, "specimen": {"size": [0.015] * 3}}, "too soft"),
        (
            {
                "seed": 41,
                "specimen": {"size": [0.10943456725084795, 0.02803106389722247, 0.03723180937189192]},
                "material": {"alpha": 0.5245360367155978},
                "discretization": {"l_f": 0.008, "l_c": 0.032},
                "adaptivity": {"r_f": 0.03528},
                "gauge": {"a": {"face": "bottom", "at": 0.02455}, "b": {"face": "bottom", "at": 0.09021}},
                "control": {"type": "gauge", "target": 1e-5},
            },
            "moves the gauge the other way",
        ),
    ],
)
def test_a_start_that_calibration_cannot_mend_blames_its_spacing(changes, says):
    """Whatever it does; at full resolution both specimens are as they should be."""
    case = beam(**{**CUBE, **changes})
    with pytest.raises(InputError, match=says) as caught:
        next(Simulation(case).steps())
    assert caught.value.key == "discretization.l_c"
    assert next(Simulation(case, full=True).steps()).load > 0.0
