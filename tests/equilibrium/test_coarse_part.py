"""The smooth coarse part: less scatter and resistance to bending, with the same modulus of elasticity."""

from pathlib import Path

import numpy as np
import pytest

from equilibrium.models import CONCRETE, beam, beam_system, box_domain
from fissura import load_case
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.contact import CusatisCedolin
from fissura.equilibrium import System, limits, settle
from fissura.equilibrium.coarse_part import bending_stiffness, smooth_moduli
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case
from fissura.tessellation.discretize import tessellate

EXAMPLES = Path(__file__).parents[2] / "examples"
MODULI = np.array([[60e9, 0.29 * 60e9, 0.29 * 60e9]])


def coarse_row(count, side):
    """A row of coarse cubes."""
    domain = box_domain([count * side, side, side])
    x = np.stack([(np.arange(count) + 0.5) * side, np.full(count, side / 2), np.full(count, side / 2)], axis=1)
    home = np.zeros(count, np.int64)
    return tessellate(x, home, domain.complex, domain.surfaces, np.full(count, side), fine=np.zeros(count, bool))


@pytest.fixture(scope="module")
def systems():
    """The small beam, coarse but for its middle, as heterogeneous as the material and smooth."""
    case = beam()
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    spacing = np.where(np.abs(nuclei.x[:, 0] - 0.05) < 0.015, 0.0, 0.02)
    conditions = conditions_from_case(case, domain)
    return [
        System(discretize(nuclei, domain, spacing), CONCRETE, CusatisCedolin, conditions, smooth=smooth)
        for smooth in (False, True)
    ]


@pytest.mark.parametrize("alpha", [0.05, 0.1, 0.29, 0.4])
def test_modulus_of_elasticity_is_kept(alpha):
    smooth = smooth_moduli(np.array([[60e9, alpha * 60e9, alpha * 60e9]]))[0]
    assert smooth[1] == smooth[2] == pytest.approx(limits.SMOOTH_ALPHA * smooth[0])
    table = macroscopic_elasticity()
    before, _ = table.macroscopic(60e9, alpha)
    assert table.macroscopic(smooth[0], limits.SMOOTH_ALPHA)[0] == pytest.approx(before, rel=1e-12)


def test_what_is_smoother_already_stays():
    given = np.array([[60e9, 0.7 * 60e9, 0.7 * 60e9], [40e9, 40e9, 40e9]])
    np.testing.assert_array_equal(smooth_moduli(given), given)


def test_a_row_of_cubes_bends_as_a_bar():
    side, count = 0.1, 6
    row = coarse_row(count, side)
    elastic = np.tile(MODULI, (count - 1, 1))
    spin = bending_stiffness(elastic, row.contacts, np.arange(count - 1))
    modulus, _ = macroscopic_elasticity().macroscopic(60e9, 0.29)
    moment = 10.0
    turned = moment / spin  # of each contact
    curvature = turned.sum() / ((count - 1) * side)
    assert moment / curvature == pytest.approx(modulus * side**4 / 12.0)


def test_nothing_at_full_resolution():
    both = [beam_system(), beam_system()]
    case = beam()
    domain = domain_from_case(case)
    smooth = System(both[0].tessellation, CONCRETE, CusatisCedolin, conditions_from_case(case, domain), smooth=True)
    np.testing.assert_array_equal(smooth.moduli, both[1].moduli)
    np.testing.assert_array_equal(smooth.pattern.spin, both[1].pattern.spin)


def test_only_coarse_contacts_change(systems):
    usual, smooth = systems
    fine = np.setdiff1d(np.arange(len(usual.moduli)), usual.coarse)
    assert 0 < len(fine) < len(usual.moduli)
    np.testing.assert_array_equal(smooth.moduli[fine], usual.moduli[fine])
    np.testing.assert_array_equal(smooth.pattern.spin[fine], usual.pattern.spin[fine])
    np.testing.assert_allclose(smooth.moduli[usual.coarse], smooth_moduli(usual.moduli[usual.coarse]))
    assert (smooth.pattern.spin[usual.coarse] > 1e3 * usual.pattern.spin[usual.coarse]).all()


def test_rigid_motion_costs_nothing(systems):
    _, system = systems
    rng = np.random.default_rng(0)
    move, turn = rng.normal(size=(2, 3))
    u = np.hstack([move + np.cross(turn, system.tessellation.x), np.tile(turn, (len(system.tessellation), 1))]).ravel()
    held = system.supports.constant @ u
    forces = system.internal(system.strain(u) * system.moduli, u) - held
    system.pattern.low_rank.add_product(-u.reshape(-1, 6), forces.reshape(-1, 6))
    bent = rng.normal(size=system.size)
    scale = np.abs(system.internal(system.strain(bent) * system.moduli, bent)).max()
    assert np.abs(forces).max() < 1e-11 * scale


def test_bending_adds_stiffness_of_the_start(systems):
    usual, smooth = (settle(system, system.virgin(), 1e-6).load for system in systems)
    assert usual < smooth < 1.3 * usual


def with_part(name, kind, **changes):
    """An example with this kind of coarse part."""
    case = load_case(EXAMPLES / name)
    part = case.adaptivity.model_copy(update={"coarse_part": kind, **changes})
    return case.model_copy(update={"adaptivity": part})


def test_platens_keep_their_contacts():
    usual, smooth = (
        Simulation(with_part("compression_glued.toml", kind)).model.system for kind in ("heterogeneous", "smooth")
    )
    inner = len(usual.tessellation.contacts)
    assert len(usual.moduli) > inner
    assert (usual.coarse >= inner).any()
    np.testing.assert_array_equal(smooth.moduli[inner:], usual.moduli[inner:])
    np.testing.assert_array_equal(smooth.pattern.spin[inner:], usual.pattern.spin[inner:])


def test_contacts_of_one_direction_scatter_less_in_tension():
    scatter = []
    for kind in ("heterogeneous", "smooth"):
        system = Simulation(with_part("tension_bar.toml", kind)).model.system
        used = system.elastic_utilisation(settle(system, system.virgin(), 1e-5).response)
        along = used[(used > 0.0) & (np.abs(system.tessellation.contacts.normal[:, 0]) > 0.95)]
        assert len(along) > 20
        scatter.append(along.std() / along.mean())
    assert scatter[1] < 0.8 * scatter[0]


def test_smooth_run_against_full_resolution():
    case = with_part("beam_d100.toml", "smooth", r_f=0.05, r_c=0.13)
    adaptive, full = Simulation(case), Simulation(case, full=True)
    curves = [np.array([(step.gauge, step.load) for step in run.steps()]) for run in (adaptive, full)]
    assert len(adaptive.tessellation) < 0.4 * len(full.tessellation)
    end = min(curve[-1, 0] for curve in curves)
    way = np.linspace(0.0, end, 200)
    adaptive, full = (np.interp(way, [0, *curve[:, 0]], [0, *curve[:, 1]]) for curve in curves)
    assert np.abs(adaptive - full).max() < 0.01 * full.max()
