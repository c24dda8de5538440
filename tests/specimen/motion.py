"""Rigid motions."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


def rigid(x, shift, turn):
    """Displacement of points under a small rigid motion, shape (k, 3)."""
    return shift + np.cross(turn, x)


def value(functional, displacement) -> float:
    """Functional of displacements of its own points."""
    return float(np.sum(functional.coefficients * displacement))
