"""Copies of cases with other values: defaults follow, what was given stays, what is wrong is refused."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import pytest

from fissura.case import Case, case_from_dict
from fissura.errors import InputError


def copied(case: Case, part: str, **values: Any) -> Case:
    """A case with values of one part changed."""
    return case.model_copy(update={part: getattr(case, part).model_copy(update=values)})


def test_defaults_of_the_material_follow(small_case: Any) -> None:
    m = copied(small_case(), "material", f_t=1e6, G_t=50.0, E=30e9).material
    assert (m.f_t, m.f_s, m.f_c) == (1e6, 3e6, 16e6)
    assert (m.G_t, m.G_s) == (50.0, 800.0)
    assert (m.E, m.K_c) == pytest.approx((30e9, 7.8e9))


def test_what_was_given_stays(small_case: Any) -> None:
    m = copied(small_case(material__f_s=7e6, material__mu=0.3), "material", f_t=1e6).material
    assert (m.f_s, m.f_c, m.mu) == (7e6, 16e6, 0.3)
    again = m.model_copy(update={"f_t": 2e6})
    assert (again.f_s, again.f_c) == (7e6, 32e6)


def test_values_of_an_update_count_as_given(small_case: Any) -> None:
    m = small_case().material.model_copy(update={"f_c": "40 MPa"}).model_copy(update={"f_t": 1e6})
    assert (m.f_c, m.f_s) == (40e6, 3e6)


def test_constants_of_the_concrete(small_case: Any) -> None:
    """What `macro` gave counts as given to the contacts; another `macro` takes their place."""
    whole = {"E": 38e9, "nu": 0.18}
    m = small_case(material={"macro": whole, "f_t": 2.2e6, "G_t": 35.0}).material
    softer = m.model_copy(update={"f_t": 1e6})
    assert (softer.E, softer.alpha, softer.f_s) == (m.E, m.alpha, 3e6)
    assert m.model_copy(update={"E": 30e9}).alpha == m.alpha
    half = m.model_copy(update={"macro": {"E": 19e9, "nu": 0.18}})
    assert (half.E, half.alpha) == pytest.approx((0.5 * m.E, m.alpha), rel=1e-12)
    contacts = small_case().material.model_copy(update={"macro": whole})
    assert (contacts.E, contacts.alpha) == (m.E, m.alpha)
    with pytest.raises(InputError, match="together with macro"):
        m.model_copy(update={"macro": whole, "E": 30e9})


def test_spacings_and_radii_follow(small_case: Any) -> None:
    case = small_case(discretization={"l_f": 0.008}, adaptivity=None)
    finer = copied(case, "discretization", l_f=0.005)
    assert (finer.discretization.l_f, finer.discretization.l_c) == (0.005, 0.02)
    a = finer.adaptivity
    assert (a.gamma, a.r_f, a.r_c, a.r_w) == pytest.approx((0.75, 0.03, 0.07, 0.015))
    a = copied(finer, "adaptivity", tolerance="5 %").adaptivity
    assert (a.gamma, a.gamma_coarse, a.r_f, a.r_c) == pytest.approx((0.85, 0.68, 0.025, 0.065))
    a = copied(copied(case, "adaptivity", r_f=0.01), "discretization", l_f=0.005).adaptivity
    assert (a.r_f, a.r_c) == pytest.approx((0.01, 0.05))


def test_steps_follow_the_target(small_case: Any) -> None:
    c = copied(small_case(), "control", target=1e-3).control
    assert (c.max_step, c.first_step, c.min_step) == pytest.approx((2e-5, 5e-6, 1e-8))
    assert copied(small_case(), "control", type="dissipation").control.stop_load == 0.05


def test_the_axis_follows_the_face(small_case: Any) -> None:
    load = small_case().load
    assert (load.along, load.model_copy(update={"face": "left", "at": 0.03}).along) == ("x", "y")


def test_a_seed_changes_nothing_else(small_case: Any) -> None:
    case = small_case(load__direction=[1, -3, 2])
    other = case.model_copy(update={"seed": 7})
    assert other.seed == 7
    assert other.model_copy(update={"seed": 1}) == case
    assert other.material is case.material


def test_the_text_of_the_file_stays(small_case: Any) -> None:
    case = small_case()
    case.__dict__["source"] = "text"
    assert case.model_copy(update={"seed": 2}).source == "text"
    assert case.model_copy().source == "text"


@pytest.mark.parametrize(
    ("part", "values", "key"),
    [
        ("material", {"f_t": -1.0}, "f_t"),
        ("material", {"f_t": "3 mm"}, "f_t"),
        ("material", {"ft": 1.0}, "ft"),
        ("discretization", {"l_c": 0.001}, "l_f"),
        ("control", {"max_step": 1.0}, "max_step"),
        ("load", {"point": [0.0, 0.0, 0.0]}, "point"),
    ],
)
def test_what_is_wrong_is_refused(small_case: Any, part: str, values: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as caught:
        getattr(small_case(), part).model_copy(update=values)
    assert caught.value.key == key


def test_what_does_not_go_together_is_refused(small_case: Any) -> None:
    with pytest.raises(InputError) as caught:
        small_case().model_copy(update={"gauge": None})
    assert caught.value.key == "gauge"
    with pytest.raises(InputError) as caught:
        copied(small_case(), "adaptivity", r_f=1.0, r_c=0.5)
    assert caught.value.key == "adaptivity.r_f"


def test_of_resolved_values_everything_was_given(small_case: Any) -> None:
    """`case.json` holds every default as a number, so that nothing follows there."""
    case = case_from_dict(small_case().model_dump(mode="json"))
    assert copied(case, "material", f_t=1e6).material.f_s == pytest.approx(6.6e6)


def test_deep_copies_share_nothing(small_case: Any) -> None:
    case = small_case()
    assert case.model_copy(update={"seed": 3}, deep=True).material is not case.material
    assert not math.isnan(case.model_copy(deep=True).adaptivity.r_f)


def test_every_way_to_copy_is_closed(small_case: Any) -> None:
    """Defaults follow by pydantic's older name, too; copies of Python are the same case, with the same defaults."""
    case = small_case()
    stronger = case.material.copy(update={"f_t": 3e6})
    assert stronger == case.material.model_copy(update={"f_t": 3e6})
    assert stronger.f_s == 9e6
    with pytest.raises(InputError, match="copy: "):
        case.copy(exclude={"seed"})
    for again in (copy.copy(case), copy.deepcopy(case), pickle.loads(pickle.dumps(case)), case.copy()):
        assert again == case
        assert again.with_({"material.f_t": 3e6}).material.f_s == 9e6


def test_parts_put_back_into_a_case_have_their_defaults(small_case: Any) -> None:
    """The same case by keys, by tables, and by parts that were changed on their own."""
    case = small_case()
    expected = small_case(discretization={"l_f": 0.006}, material__f_t=3e6)
    by_keys = case.with_({"discretization": {"l_f": 0.006}, "material.f_t": 3e6})
    parts = {
        "discretization": type(case.discretization)(l_f=0.006),
        "material": case.material.model_copy(update={"f_t": 3e6}),
    }
    assert by_keys == case.model_copy(update=parts) == expected
    assert by_keys.adaptivity.r_c == expected.adaptivity.r_c != case.adaptivity.r_c
    assert case.model_copy(update=parts).with_({"material.f_t": 1e6}).material.f_s == 3e6
