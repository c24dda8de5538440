"""Calibration of the elastic part."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fissura.adaptivity import calibrated, gauge_compliance, region_from_case
from fissura.contact import law_from_case
from fissura.equilibrium import System
from fissura.material import material_from_case
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case


@pytest.fixture(scope="module")
def systems(small_case):
    """The beam fine at the tip, and fine everywhere."""
    case = small_case()
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    region = region_from_case(case, domain, full=False)
    return [
        System(
            discretize(nuclei, domain, where.spacing(nuclei.x)),
            material_from_case(case),
            law_from_case(case),
            conditions_from_case(case, domain),
        )
        for where in (region, replace(region, everywhere=True))
    ]


def test_gauge_as_at_full_resolution(systems):
    adaptive, full = systems
    target = gauge_compliance(full)
    assert abs(gauge_compliance(adaptive) / target - 1.0) > 1e-3
    assert gauge_compliance(calibrated(adaptive, target)) == pytest.approx(target, rel=1e-4)


def test_target_already_met(systems):
    adaptive, _ = systems
    assert calibrated(adaptive, gauge_compliance(adaptive)).elastic_scale == 1.0


def test_nothing_to_scale(systems):
    _, full = systems
    assert calibrated(full, 2.0 * gauge_compliance(full)).elastic_scale == 1.0


@pytest.mark.parametrize(("share", "limit"), [(1e-3, 2.0), (10.0, 0.5)])
def test_limits(systems, share, limit):
    adaptive, _ = systems
    assert calibrated(adaptive, share * gauge_compliance(adaptive)).elastic_scale == limit


def test_stiffer_elastic_contacts_make_a_stiffer_beam(systems):
    adaptive, _ = systems
    compliance = [gauge_compliance(adaptive.scaled(scale)) for scale in (0.5, 1.0, 2.0)]
    assert compliance[0] > compliance[1] > compliance[2]


def test_compliance_needs_no_shapes(systems):
    _, full = systems
    bare = full.tessellation.without_shapes()
    assert bare.cells is None
    assert len(bare.contacts.polygons) == 0
    assert len(bare.contacts) == len(full.tessellation.contacts)
    other = System(bare, full.law.material, type(full.law), full.conditions)
    assert gauge_compliance(other) == gauge_compliance(full)


@pytest.mark.parametrize("gauge_is_load", [False, True])
def test_rough_solutions_are_exact_enough(systems, gauge_is_load):
    """Iterative solutions find the factor of direct ones, also where load and gauge are one."""
    adaptive, _ = systems
    conditions = adaptive.conditions
    if gauge_is_load:
        conditions = replace(conditions, drives=(replace(conditions.main, quantity="displacement"),))
    shared = (adaptive.tessellation, adaptive.law.material, type(adaptive.law), conditions)
    direct, iterative = System(*shared, "direct"), System(*shared, "two-level")
    target = 1.02 * gauge_compliance(direct)
    assert gauge_compliance(iterative) == pytest.approx(target / 1.02, rel=1e-4)
    found, expected = calibrated(iterative, target), calibrated(direct, target)
    assert found.elastic_scale == pytest.approx(expected.elastic_scale, rel=2e-4)
    assert gauge_compliance(expected) == pytest.approx(target, rel=1.5e-4)


def test_a_gauge_that_the_load_does_not_move_is_left_to_the_start(systems):
    adaptive, _ = systems
    assert calibrated(adaptive, 0.0) is adaptive
