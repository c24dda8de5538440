"""Coarsening: what is needed, when a region shrinks, that nothing flickers, and whole runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from equilibrium.models import CONCRETE
from fissura.adaptivity import Coarsening, RefinedRegion, needed_bodies
from fissura.contact import CusatisCedolin
from fissura.simulation.loop import Simulation
from fissura.specimen import domain_from_case
from fissura.tessellation import discretize, nuclei_from_case


@pytest.fixture(scope="module")
def fine(small_case):
    """An unnotched beam that is fine all over, its region, and all its nuclei."""
    case = small_case(notch=None)
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    l_f = nuclei.spacing
    region = RefinedRegion(l_f, 4 * l_f, 2 * l_f, 8 * l_f, centers=nuclei.x, r_w=0.01)
    return discretize(nuclei, domain, region.spacing(nuclei.x)), region, nuclei


@pytest.mark.parametrize(
    ("strain", "damage", "largest_n", "largest_t", "used", "needed"),
    [
        ([0.1, 0, 0], 1e-9, 1.0, 0.0, 0.0, True),  # damaged, however little, and unloaded
        ([0.1, 0, 0], 0.0, 1.0, 0.0, 0.61, True),  # unloaded, but still highly stressed
        ([0.1, 0, 0], 0.0, 1.0, 0.0, 0.59, False),
        ([0.99, 0, 0], 0.0, 1.0, 0.0, 0.1, True),  # about to grow
        ([-5.0, 0.1, 0], 0.0, 0.0, 1.0, 0.59, False),  # compression is no strain of the history
        ([0, 0.6, 0.79], 0.0, 0.0, 1.0, 0.1, True),
    ],
)
def test_needed_bodies(fine, strain, damage, largest_n, largest_t, used, needed, monkeypatch):
    """One contact differs from all others, which have unloaded: its two bodies are needed or not."""
    tessellation, _, _ = fine
    damageable = np.arange(len(tessellation.contacts))
    strains = np.tile([0.0, 0.0, 0.0], (len(damageable), 1))
    history = np.tile([0.0, 1e-9, 0.0], (len(damageable), 1))
    strains[7], history[7] = strain, [damage, largest_n, largest_t]
    law = CusatisCedolin.create(CONCRETE, tessellation.contacts.length)
    utilisation = np.zeros(len(damageable))
    utilisation[7] = used
    monkeypatch.setattr(CusatisCedolin, "utilisation", lambda self, strain: utilisation)
    found = needed_bodies(tessellation, damageable, law, strains, history, 0.6)
    expected = np.zeros(len(tessellation), bool)
    expected[tessellation.contacts.bodies[7]] = needed
    assert_array_equal(found, expected)


def test_a_coarsened_region_keeps_what_the_case_asks_for():
    region = RefinedRegion(
        1.0,
        4.0,
        r_f=6.0,
        ramp=8.0,
        centers=np.array([[50.0, 0, 0]]),
        lines=np.array([[[0.0, 0, 0], [0.0, 0, 9.0]]]),
        balls=np.array([[20.0, 0, 0]]),
        radii=np.array([2.0]),
        r_w=3.0,
    )
    small = region.coarsened(np.array([[35.0, 0, 0]]), np.array([[70.0, 0, 0]]))
    x = np.array([[0.0, 3, 4], [0.0, 3.1, 4], [21.9, 0, 0], [35, 3.0, 0], [35, 3.1, 0], [50.0, 0, 0], [70, 5.9, 0]])
    assert_array_equal(small.spacing(x) == 0.0, [True, False, True, True, False, False, True])


def asked(fine, coarsening, share):
    """What is left of the region when the bodies in a share of the length are needed."""
    tessellation, region, nuclei = fine
    needed = tessellation.x[:, 0] < share * nuclei.x[:, 0].max()
    return coarsening.smaller(region, tessellation, needed, lambda part: (part.distance(nuclei.x) <= 0.0).sum())


def test_it_waits_after_a_change_and_shrinks_only_where_that_saves_enough(fine):
    _, _, nuclei = fine
    coarsening = Coarsening()
    for _ in range(3):
        assert asked(fine, coarsening, 0.2) is None
        coarsening = coarsening.stepped()
    assert asked(fine, coarsening, 0.2) is not None
    assert asked(fine, coarsening, 0.9) is None
    assert asked(fine, coarsening.refined(nuclei.x[:1]), 0.2) is None


def test_needed_bodies_stay_with_a_margin(fine):
    tessellation, _, nuclei = fine
    small = asked(fine, replace(Coarsening(), rest=3), 0.2)
    assert small is not None
    needed = tessellation.x[:, 0] < 0.2 * nuclei.x[:, 0].max()
    assert (small.distance(tessellation.x[needed]) <= -small.r_w + 1e-15).all()


def test_what_is_refined_again_stays(fine):
    _, region, nuclei = fine
    coarsening = replace(Coarsening(), rest=3)
    outside = np.array([[-1.0, -1.0, -1.0]])
    assert len(coarsening.refined(nuclei.x[:2]).lasting) == 0  # nothing was given up so far
    later = coarsening.coarsened(region).refined(np.concatenate([nuclei.x[:2], outside]))
    assert_array_equal(later.lasting, np.unique(nuclei.x[:2], axis=0))
    small = asked(fine, replace(later, rest=3), 0.2)
    assert small is not None
    assert (small.distance(nuclei.x[:2]) <= -small.r_f).all()


def test_a_brittle_beam_coarsens_and_keeps_all_damage(small_case):
    """Its wake unloads. Facets of damaged contacts never change, and no damage is lost."""
    case = small_case(
        material__G_t=4.0,
        discretization__l_f=0.006,
        discretization__l_c=0.02,
        adaptivity__r_f=0.05,
        adaptivity__coarsen=True,
        adaptivity__gamma_coarse=0.7,
        control__stop_load=0.2,
    )
    known: dict[tuple[int, int], tuple[float, float]] = {}
    bodies, coarsenings, work, rest = [], 0, 1.0, 0.0
    for step in Simulation(case).steps():
        shot = step.snapshot
        contacts, nucleus = shot.tessellation.contacts, shot.tessellation.nucleus
        damaged = np.flatnonzero(shot.damage > 0.0)
        pairs = np.sort(nucleus[contacts.bodies[damaged]], axis=1)
        now = {
            (int(i), int(j)): (float(contacts.area[c]), float(shot.damage[c]))
            for c, (i, j) in zip(damaged, pairs, strict=True)
        }
        for pair, (area, damage) in known.items():
            assert now[pair][0] == pytest.approx(area, rel=1e-9)
            assert now[pair][1] >= damage * (1.0 - 1e-9)
        known = now
        bodies.append(step.bodies)
        coarsenings += step.coarsenings
        work, rest = step.work, step.work + step.exchanged - step.stored - step.dissipated
    assert coarsenings > 0
    assert min(np.diff(bodies)) < -100
    assert abs(rest) < 1e-4 * work
