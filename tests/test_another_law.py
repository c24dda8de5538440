"""Whole runs with a law of which nothing outside its class knows how it remembers."""

from dataclasses import dataclass

import numpy as np
import pytest

from fissura.contact import LAWS
from fissura.simulation import Simulation


@dataclass(frozen=True)
class Exponential:
    """Damage from the largest effective strain of tension and shear, which is all it remembers: one column.

    Virgin contacts remember the strain at which damage begins, which is not zero.
    """

    material: object
    scale: np.ndarray
    limit: np.ndarray  # strain at which damage begins
    softening: np.ndarray  # strain over which traction falls by a factor of e

    @classmethod
    def create(cls, material, length, scale=None, ductility=None):
        scale = np.ones(len(length)) if scale is None else scale
        limit = scale * material.f_t / material.E
        return cls(material, scale, limit, scale**2 * material.G_t / (length * scale * material.f_t) - 0.5 * limit)

    @property
    def elastic(self):
        return self.material.E * np.array([1.0, self.material.alpha, self.material.alpha])

    def initial_history(self):
        return self.limit[:, None].copy()

    def damage(self, history):
        past = history[:, 0] - self.limit
        return 1.0 - self.limit / history[:, 0] * np.exp(-past / self.softening)

    def _effective(self, strain):
        return np.sqrt(np.maximum(strain[:, 0], 0.0) ** 2 + self.material.alpha * (strain[:, 1:] ** 2).sum(axis=1))

    def loading(self, strain, history):
        return self._effective(strain) ** 2, history[:, 0] ** 2

    def response(self, strain, history):
        new = np.maximum(history, self._effective(strain)[:, None])
        return (1.0 - self.damage(new))[:, None] * self.elastic * strain, new

    def tangent(self, strain, history):
        effective = self._effective(strain)
        grows = effective > history[:, 0]
        top = np.where(grows, effective, history[:, 0])
        left = 1.0 - self.damage(top[:, None])
        out = left[:, None, None] * np.diag(self.elastic)
        slope = np.where(grows, left * (1.0 / top + 1.0 / self.softening), 0.0)
        gradient = strain * [1.0, self.material.alpha, self.material.alpha] / top[:, None]
        gradient[:, 0] = np.maximum(gradient[:, 0], 0.0)
        return out - slope[:, None, None] * np.einsum("ka,kb->kab", self.elastic * strain, gradient)

    def utilisation(self, strain):
        return self._effective(strain) / self.limit


@pytest.fixture
def case(small_case, monkeypatch):
    """A brittle beam that refines itself; its wake unloads."""
    monkeypatch.setitem(LAWS, "exponential", Exponential)
    return small_case(
        material__law="exponential",
        material__G_t=6.0,
        discretization__l_f=0.008,
        discretization__l_c=0.02,
        adaptivity__r_f=0.03,
        adaptivity__coarsen=True,
        adaptivity__gamma_coarse=0.7,
        control__stop_load=0.2,
    )


def test_a_law_with_one_column_runs_refines_and_coarsens(case, monkeypatch):
    monkeypatch.setattr("fissura.adaptivity.coarsening._FEWEST", 20)
    monkeypatch.setattr("fissura.adaptivity.coarsening._SAVING", 0.05)
    steps = list(Simulation(case).steps())
    load = np.array([s.load for s in steps])
    assert sum(s.refinements for s in steps) > 0
    assert sum(s.coarsenings for s in steps) > 0
    assert 0 < load.argmax() < len(load) - 3
    assert load[-1] < 0.5 * load.max()
    rest = np.array([s.work + s.exchanged - s.stored - s.dissipated for s in steps])
    assert np.abs(rest).max() < 1e-4 * steps[-1].work
    assert max(s.snapshot.damage.max() for s in steps) > 0.9


def test_a_law_that_does_not_remember_the_largest_strain_stays_fine(case, monkeypatch):
    monkeypatch.setattr(Exponential, "loading", lambda self, strain, history: 2 * (self._effective(strain) ** 2,))
    steps = list(Simulation(case).steps())
    assert sum(s.refinements for s in steps) > 0
    assert sum(s.coarsenings for s in steps) == 0
