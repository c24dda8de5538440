"""Random shapes are either refused with a message or have all identities of a complex."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from fissura.errors import InputError
from fissura.specimen import domain_from_case, thin_parts
from fissura.specimen.shapes.prism import FACES

from .complexes import check, volume

SIZE = np.array([0.3, 0.1, 0.1])


def random_notch(rng):
    """From any face in any direction, its front in any other."""
    face = int(rng.integers(6))
    axis, inwards = face // 2, 1.0 - 2.0 * (face % 2)
    at = rng.uniform(0.1, 0.9, 3) * SIZE
    at[axis] = SIZE[axis] * (face % 2)
    direction = rng.normal(size=3)
    direction[axis] = inwards * (abs(direction[axis]) + 0.1)
    depth, width = rng.uniform(0.02, 0.9) * SIZE[axis], rng.choice([0.0, 0.0, 0.003, 0.01])
    return {
        "on": FACES[face],
        "at": at,
        "direction": direction,
        "along": rng.normal(size=3),
        "depth": depth,
        "width": width,
    }


def notched(rng):
    return {"specimen": {"size": SIZE}, "notch": [random_notch(rng) for _ in range(rng.integers(1, 4))]}


def outlined(rng):
    """Around a star, or anywhere; with arcs, and with corners on a coarse grid, which then may coincide."""
    count = int(rng.integers(3, 12))
    points = rng.uniform(0.0, 0.3, (count, 2))
    if rng.random() < 0.7:
        angle, radius = np.sort(rng.uniform(0.0, 2.0 * np.pi, count)), rng.uniform(0.03, 0.15, count)
        points = 0.15 + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.round(points, 2) if rng.random() < 0.3 else points
    chord = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    outline = [
        {"to": p, "radius": c * rng.uniform(0.5, 3.0) * rng.choice([-1.0, 1.0])} if rng.random() < 0.3 and c else p
        for p, c in zip(points, chord, strict=True)
    ]
    return {"specimen": {"outline": outline, "thickness": 0.1}, "notch": []}


def pierced(rng):
    voids = []
    for _ in range(rng.integers(1, 4)):
        kind = rng.integers(3)
        if kind == 0:
            low = rng.uniform(-0.05, 0.25, 3) * [1.0, 0.4, 0.4]
            voids.append({"box": {"lower": low, "upper": low + rng.uniform(0.02, 0.2, 3)}})
        elif kind == 1:
            ends = rng.uniform(-0.1, 1.1, (2, 3)) * SIZE
            voids.append({"cylinder": {"diameter": rng.uniform(0.01, 0.08), "start": ends[0], "end": ends[1]}})
        else:
            through = rng.uniform(0.0, 1.0, 3) * SIZE
            axis = "xyz"[rng.integers(3)]
            voids.append({"cylinder": {"diameter": rng.uniform(0.01, 0.06), "through": through, "axis": axis}})
    return {"specimen": {"size": SIZE}, "minus": voids, "notch": [random_notch(rng)] if rng.random() < 0.5 else []}


def round_bar(rng):
    angle = rng.uniform(0.0, 2.0 * np.pi)
    at = [0.075 * np.cos(angle), 0.075 * np.sin(angle), rng.uniform(0.05, 0.15)]
    notch = {"on": "lateral", "at": at, "along": rng.normal(size=3), "depth": rng.uniform(0.01, 0.1)}
    cylinder = {"diameter": 0.15, "length": 0.2}
    return {"specimen": {"cylinder": cylinder}, "notch": notch | {"width": rng.choice([0.0, 0.004])}}


def built(small_case, make, seed):
    """The specimen of a seed, or None where it is refused."""
    rng = np.random.default_rng(seed)
    tables = make(rng)
    l_f = 0.015 if "minus" in tables else rng.choice([0.004, 0.008, 0.015])  # voids make many cells
    case = small_case(**tables, discretization={"l_f": l_f})
    try:
        found = domain_from_case(case)
    except InputError:
        return None
    check(found.complex)
    assert_allclose(volume(found.complex), found.volume, rtol=1e-12)
    # The surface encloses the same volume: no part of it is missing.
    centre = found.bounds.mean(axis=0)
    enclosed = sum(part.area * (part.normal @ (part.polygon[0] - centre)) for part in found.faces()) / 3.0
    assert_allclose(enclosed, found.volume, rtol=1e-9)
    assert all(part.value >= 0.0 for part in thin_parts(case, found))
    if "outline" in tables["specimen"]:
        (loop,) = found.outline(np.array([0.0, 0.0, 1.0]), 0.05)
        assert_allclose(shapely.Polygon(loop[:, :2]).area * 0.1, found.volume, rtol=1e-7)
    return found


#: What makes random tables, and how many of the quick test are at least not refused.
MAKERS = {
    "notches": (notched, 6, 3),
    "outlines": (outlined, 8, 3),
    "voids": (pierced, 3, 1),
    "round bars": (round_bar, 8, 4),
}


@pytest.mark.parametrize(("make", "seeds", "least"), MAKERS.values(), ids=MAKERS)
def test_a_few(small_case, make, seeds, least):
    assert sum(built(small_case, make, seed) is not None for seed in range(seeds)) >= least


@pytest.mark.slow
@pytest.mark.parametrize(("make", "seeds", "least"), MAKERS.values(), ids=MAKERS)
def test_many(small_case, make, seeds, least):
    found = [built(small_case, make, seed) for seed in range(8, 8 + 8 * seeds)]
    assert sum(domain is not None for domain in found) >= 4 * least
