"""Refinement criteria (theory section 4): how near to failure an elastic body is.

Each returns a value per body, 1 meaning at its strength; coarse bodies above ``gamma`` are critical.
"""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.tessellation import Tessellation


@dataclass(frozen=True)
class ElasticState:
    """What criteria may look at.

    Attributes
    ----------
    tessellation : Tessellation
        Bodies and contacts.
    stress : (n, 3, 3) array
        Stress in bodies [Pa].
    strength : (n,) array
        Tensile strength at the bodies [Pa].
    utilisation : (m,) array
        Effective traction over strength of elastic contacts; 0 for contacts with damage, and in elastic regions.
    elastic : (n,) bool array
        Bodies whose nucleus lies in an elastic region.
    """

    tessellation: Tessellation
    stress: FloatArray
    strength: FloatArray
    utilisation: FloatArray
    elastic: BoolArray


def rankine(state: ElasticState) -> FloatArray:
    """Largest principal stress of each body over its tensile strength; 0 in elastic regions."""
    principal = np.linalg.eigvalsh(state.stress)[:, -1]
    return np.where(state.elastic, 0.0, principal / state.strength)


def utilisation(state: ElasticState) -> FloatArray:
    """Largest utilisation of the elastic contacts of each body."""
    value = np.zeros(len(state.tessellation))
    for side in (0, 1):
        np.maximum.at(value, state.tessellation.contacts.bodies[:, side], state.utilisation)
    return value
