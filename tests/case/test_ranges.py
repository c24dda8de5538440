"""Ranges of numbers: extremes are refused at the key at fault, and all that is allowed gives a finite contact law."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fissura import Case, InputError
from fissura.case import case_from_dict
from fissura.contact import CusatisCedolin
from fissura.material import material_from_case

Build = Callable[..., Case]


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        # lengths
        ("specimen.size[0]", 1e-12, "1 nm to 10 km"),
        ("specimen.size[0]", 1e300, "1 nm to 10 km"),
        ("notch.depth", "0.1 nm", "1 nm to 10 km"),
        ("notch.width", 1e-300, "zero or positive, 1 nm to 10 km"),
        ("notch.position", 1e300, "-10 km to 10 km"),
        ("load.at", -1e300, "-10 km to 10 km"),
        ("discretization.l_f", 1e-300, "1 nm to 10 km"),
        ("discretization.l_c", "11 km", "1 nm to 10 km"),
        ("adaptivity.r_f", 1e300, "1 nm to 10 km"),
        ("control.target", 1e300, "1 nm to 10 km"),
        ("control.target", 1e-300, "1 nm to 10 km"),
        # material
        ("material.E", 60, "1 kPa to 100 TPa"),
        ("material.E", 1e300, "1 kPa to 100 TPa"),
        ("material.f_t", 1e-300, "1 Pa to 1 TPa"),
        ("material.f_t", 1e308, "1 Pa to 1 TPa"),
        ("material.G_t", 1e-300, "1e-6 to 1e9 J/m^2"),
        ("material.f_s", 6.6, "110 kPa to 44 MPa; numbers without a unit are in Pa"),
        ("material.f_c", 1e20, "110 kPa to 2.2 GPa"),
        ("material.G_s", 1e-300, "0.35 J/m^2 to 3.5e+07 J/m^2"),
        ("material.K_c", 1e-300, "60 kPa to 6000 GPa"),
        ("material.K_c", 1e300, "60 kPa to 6000 GPa"),
        ("material.alpha", 1e-300, "at least 0.001 and at most 1"),
        ("material.mu", 1e6, "at least 0.01 and at most 10"),
        ("material.mu", 1e-9, "at least 0.01 and at most 10"),
        ("material.beta", 1e300, "at least 0.01 and at most 100"),
        ("material.n_c", 1e-300, "at least 0.1 and at most 10"),
        # field
        ("field.length", 1e-308, "1 nm to 1e9 m"),
        ("field.length", 1e300, "1 nm to 1e9 m"),
        ("field.spacing", 1e-300, "1 nm to 10 km"),
        ("field.shape", 1e300, "above 1 and at most 1000"),
        ("field.cov", 1e-300, "at least 1e-06 and at most 100"),
        ("field.cov", 1e300, "at least 1e-06 and at most 100"),
        ("field.leading[1]", [0.5, 1e5], "from -10 to 10"),
        ("field.energy.shape", 1e300, "above 1 and at most 1000"),
        # numbers of things
        ("output.vtk", 10**12, "0 to 10000"),
        ("control.max_iterations", 10**9, "1 to 10000"),
        ("solver.threads", 10**9, "0 to 10000"),
        # steps go with the target
        ("control.max_step", 1e-300, "at least 1e-10 m"),
        ("control.min_step", 1e-300, "at least 1e-16 m"),
    ],
)
def test_extremes_are_refused_at_their_key(small_case: Build, key: str, value: Any, allowed: str) -> None:
    path = key.split("[1]")[0].replace("[0]", "__0").replace(".", "__")
    changes = {} if not key.startswith("field") else {"field": {"length": 0.05, "energy": {}}}
    if key == "field.length":
        changes = {"field": {}}
    with pytest.raises(InputError) as caught:
        small_case(**changes, **{path: value})
    assert caught.value.key == key
    assert allowed in caught.value.allowed


def test_shear_strength_is_above_what_friction_leaves(small_case: Build) -> None:
    """Else ``f_t`` would not be the tensile strength, or the surface have its apex there, without a normal."""
    for changes, key in (
        ({"material__f_s": 2.2e6, "material__mu": 1.0}, "material.f_s"),
        ({"material__f_s": 2e6, "material__mu": 1.0}, "material.f_s"),
        ({"material__mu": 3.0}, "material.mu"),
    ):
        with pytest.raises(InputError) as caught:
            small_case(**changes)
        assert caught.value.key == key
    assert small_case(material__mu=2.99).material.f_s == pytest.approx(6.6e6)


def test_every_default_can_be_read_again(small_case: Build) -> None:
    """Also where four times the largest length would be larger than that."""
    case = small_case(
        specimen__size=[1e4, 1e4, 1e4],
        discretization={"l_f": "10 km"},
        adaptivity={"tolerance": 0.01},
        material={"macro": {"E": 1e13, "nu": 0.365}, "f_t": 1e12, "G_t": 1e9},
        control={"target": 1e4},
    )
    assert case.discretization.l_c == case.adaptivity.r_f == case.adaptivity.r_c == case.adaptivity.r_w == 1e4
    assert case_from_dict(json.loads(case.model_dump_json())) == case


@pytest.mark.parametrize(
    ("key", "entry", "most"),
    [
        ("notch", {"position": 0.06, "depth": 0.03}, 100),
        ("supports", {"type": "pin", "face": "bottom", "at": 0.01}, 50),
        ("material__elastic", {"type": "ball", "center": [0, 0, 0], "radius": 1}, 10_000),
        ("adaptivity__regions", {"type": "ball", "center": [0, 0, 0], "radius": 1}, 10_000),
    ],
)
def test_lists_have_an_end(small_case: Build, key: str, entry: dict[str, Any], most: int) -> None:
    small_case(**{key: [entry] * most})
    with pytest.raises(InputError) as caught:
        small_case(**{key: [entry] * (most + 1)})
    assert caught.value.key == key.replace("__", ".")
    assert (caught.value.problem, caught.value.allowed) == (f"the list has {most + 1} entries", f"at most {most}")


def powers(least: float, most: float) -> st.SearchStrategy[float]:
    """Numbers whose logarithms are spread evenly, both ends among them."""
    inner = st.floats(math.log(least), math.log(most)).map(lambda x: min(max(math.exp(x), least), most))
    return st.sampled_from([least, most]) | inner


@given(
    E=powers(1e3, 1e14),
    alpha=powers(1e-3, 1.0),
    f_t=powers(1.0, 1e12),
    G_t=powers(1e-6, 1e9),
    f_s=powers(0.05, 20.0),
    f_c=powers(0.05, 1000.0),
    G_s=powers(0.01, 1e6),
    K_c=powers(1e-6, 100.0),
    mu=powers(0.01, 10.0),
    beta=powers(0.01, 100.0),
    n_c=powers(0.1, 10.0),
    strain=powers(1e-3, 1e6),
)
@settings(max_examples=200)
def test_what_is_allowed_has_a_finite_law(small_case: Build, strain: float, **constants: float) -> None:
    """Every response, tangent and utilisation is finite, in all directions, or the case is refused with its key."""
    given = dict(constants)
    for name, other in (("f_s", "f_t"), ("f_c", "f_t"), ("G_s", "G_t"), ("K_c", "E")):
        given[name] *= given[other]
    given["f_s"] = max(given["f_s"], 1.001 * given["mu"] * given["f_t"])
    case = small_case(material=given)
    material = material_from_case(case)
    length = np.array([1e-9, 0.01, 0.5, 0.99, 0.01]) * max(min(CusatisCedolin.limits(material).values()), 0.0)
    law, refused = None, ""
    try:
        law = CusatisCedolin.create(material, length)
    except InputError as error:
        refused = error.key
    if law is None:
        assert refused in ("material.f_c", "material.G_s")
        return
    angle = np.array([-0.5 * np.pi, law.omega0 * (1 + 1e-12), law.omega0 * (1 - 1e-12), 0.0, 0.5 * np.pi])
    size = strain * material.f_t / material.E
    e = size * np.stack([np.sin(angle), np.cos(angle) / np.sqrt(material.alpha), np.zeros(5)], axis=1)
    traction, history = law.response(e, law.initial_history())
    for found in (traction, history, law.tangent(e, law.initial_history()), law.tangent(1.1 * e, history)):
        assert np.isfinite(found).all()
    assert np.isfinite(law.utilisation(e)).all()
    assert (history[:, 0] >= 0.0).all()
    assert (history[:, 0] <= 1.0).all()
