"""Contacts along paths of strain, and their tangents by differences: what the tests of all laws share."""

import numpy as np
from hypothesis import strategies as st

from equilibrium.models import CONCRETE

YIELD = CONCRETE.f_t / CONCRETE.E
LENGTH = 0.0125
COMPONENT = st.floats(-40.0, 40.0, allow_nan=False)
PATHS = st.lists(st.tuples(COMPONENT, COMPONENT, COMPONENT), min_size=1, max_size=6)


def answered(law, path):
    """Tractions and histories of one contact along a path."""
    history, tractions, histories = law.initial_history(), [], []
    for strain in path:
        traction, history = law.response(strain[None], history)
        tractions.append(traction[0])
        histories.append(history[0])
    return np.array(tractions), np.array(histories)


def random_states(law, rng, *, known):
    """Strains of all contacts of a law around and far above yield; virgin, or with a history of other strains."""
    n = len(law.length)
    strain = rng.normal(size=(n, 3)) * YIELD * 10 ** rng.uniform(-0.3, 1.5, (n, 1))
    history = law.initial_history()
    if known:
        factor = rng.uniform(0.0, 1.2, (n, 1))
        _, history = law.response(factor * np.linalg.norm(strain, axis=1)[:, None] * rng.normal(size=(n, 3)), history)
    return strain, history


def slopes(law, rng, strain, history):
    """Derivatives of tractions along random ways, as long as the strains.

    Returns
    -------
    exact : (n, 3) array
        By the tangent.
    coarse, fine : (n, 3) arrays
        By central differences over 2e-4 and 1e-4 of the way.
    size : (n,) array
        Their possible size.
    """
    way = rng.normal(size=strain.shape)
    way *= (np.linalg.norm(strain, axis=1) / np.linalg.norm(way, axis=1))[:, None]
    tangent = law.tangent(strain, history)
    coarse, fine = (
        (law.response(strain + h * way, history)[0] - law.response(strain - h * way, history)[0]) / (2.0 * h)
        for h in (2e-4, 1e-4)
    )
    size = np.linalg.norm(tangent, axis=(1, 2)) * np.linalg.norm(way, axis=1)
    return np.einsum("cab,cb->ca", tangent, way), coarse, fine, size


def extrapolated(coarse, fine):
    """Their common limit: its error goes with the fourth power of the step."""
    return (4.0 * fine - coarse) / 3.0
