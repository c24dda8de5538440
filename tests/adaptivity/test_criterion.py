"""Criteria on states made by hand."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from equilibrium.models import box_domain
from fissura.adaptivity import ElasticState
from fissura.case.registry import CRITERIA
from fissura.errors import InputError
from fissura.tessellation.discretize import tessellate

X = np.array([[0.01, 0.02, 0.02], [0.05, 0.02, 0.02], [0.09, 0.02, 0.02]])


def state(stress=None, strength=2.0, utilisation=(0.0, 0.0), elastic=(False, False, False)):
    """Three bodies in a row, two contacts."""
    domain = box_domain((0.12, 0.04, 0.04))
    t = tessellate(X, domain.cell_of(X), domain.complex, domain.surfaces, np.full(3, 0.1))
    assert_array_equal(t.contacts.bodies, [[0, 1], [1, 2]])
    stress = np.zeros((3, 3, 3)) if stress is None else stress
    return ElasticState(t, stress, np.broadcast_to(strength, 3), np.asarray(utilisation), np.asarray(elastic))


def test_rankine_is_the_largest_principal_stress():
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    principal = np.array([[3.0, -5.0, 1.0], [-1.0, -2.0, -9.0], [0.0, 0.0, 0.0]])
    stress = np.einsum("ia,na,ja->nij", turn, principal, turn)
    assert_allclose(CRITERIA.named("rankine")(state(stress)), [1.5, -0.5, 0.0], atol=1e-12)


def test_rankine_in_pure_shear_and_with_a_strength_of_its_own():
    stress = np.zeros((3, 3, 3))
    stress[:, 0, 1] = stress[:, 1, 0] = 4.0
    assert_allclose(CRITERIA.named("rankine")(state(stress, np.array([4.0, 2.0, 1.0]))), [1.0, 2.0, 4.0])


def test_rankine_does_not_look_into_elastic_regions():
    stress = 4.0 * np.tile(np.eye(3), (3, 1, 1))
    assert_allclose(CRITERIA.named("rankine")(state(stress, elastic=(False, True, False))), [2.0, 0.0, 2.0])


def test_utilisation_is_the_worst_contact():
    value = CRITERIA.named("utilisation")
    assert_allclose(value(state(utilisation=(0.3, 0.8))), [0.3, 0.8, 0.8])
    assert_allclose(value(state(utilisation=(0.9, 0.0))), [0.9, 0.9, 0.0])
    assert_allclose(value(state()), 0.0)


def test_names():
    assert set(CRITERIA) == {"utilisation", "rankine"}
    with pytest.raises(InputError, match="utilisation") as caught:
        CRITERIA.named("mises")
    assert caught.value.key == "adaptivity.criterion"
