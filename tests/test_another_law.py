"""A law of another package, that of docs/how-to/law.md: by its entry point, in whole runs, and what can be wrong."""

import importlib
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from fissura.case import case_from_dict
from fissura.case.registry import LAWS
from fissura.contact import law_from_case
from fissura.errors import InputError
from fissura.files.tables import read_toml
from fissura.material import Material, material_from_case
from fissura.simulation.loop import Simulation

PAGE = (Path(__file__).parents[1] / "docs" / "how-to" / "law.md").read_text(encoding="utf-8")


def snippet(language):
    """The first block of a language on the page."""
    return re.search(rf"```{language} title=\S+\n(.*?)```", PAGE, re.DOTALL)[1]


def install(folder, name, entry, **files):
    """A package that offers laws, as an installation leaves it."""
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[fissura.laws]\n{entry}\n")
    for module, text in files.items():
        (folder / f"{module}.py").write_text(text)


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """A folder from which packages are imported."""
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        if (getattr(sys.modules[name], "__file__", None) or "").startswith(str(tmp_path)):
            del sys.modules[name]
    importlib.invalidate_caches()


@pytest.fixture
def softening(packages):
    """The package of the page."""
    install(packages, "softening", "exponential = softening:Exponential", softening=snippet("python"))
    return importlib.import_module("softening")


@pytest.fixture
def case(small_case, softening):
    """A brittle beam that refines itself; its wake unloads."""
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
    monkeypatch.setattr("fissura.adaptivity.limits.FEWEST", 20)
    monkeypatch.setattr("fissura.adaptivity.limits.SAVING", 0.05)
    steps = list(Simulation(case).steps())
    load = np.array([s.load for s in steps])
    assert sum(s.refinements for s in steps) > 0
    assert sum(s.coarsenings for s in steps) > 0
    assert 0 < load.argmax() < len(load) - 3
    assert load[-1] < 0.5 * load.max()
    rest = np.array([s.work + s.exchanged - s.stored - s.dissipated for s in steps])
    assert np.abs(rest).max() < 1e-4 * steps[-1].work
    assert max(s.snapshot.damage.max() for s in steps) > 0.9


def test_a_law_that_does_not_remember_the_largest_strain_stays_fine(case, softening, monkeypatch):
    law = softening.Exponential
    monkeypatch.setattr(law, "loading", lambda self, strain, history: 2 * (self.effective(strain) ** 2,))
    steps = list(Simulation(case).steps())
    assert sum(s.refinements for s in steps) > 0
    assert sum(s.coarsenings for s in steps) == 0


def test_tangent_of_the_page_is_that_of_its_response(softening):
    material = Material.standard(60e9, 0.29, 2.2e6, 35.0)
    law = softening.Exponential.create(
        Material(**{**vars(material), "parameters": softening.Parameters(shear=0.5)}), np.full(50, 0.01)
    )
    rng = np.random.default_rng(1)
    history = law.initial_history() * rng.uniform(1.0, 3.0, (50, 1))
    strain = 1e-4 * rng.normal(size=(50, 3))
    differences = np.empty((50, 3, 3))
    for b in range(3):
        step = 1e-10 * np.eye(3)[b]
        ends = [law.response(strain + sign * step, history)[0] for sign in (1, -1)]
        differences[:, :, b] = (ends[0] - ends[1]) / 2e-10
    np.testing.assert_allclose(law.tangent(strain, history), differences, atol=1e-4 * material.E)


def test_case_of_the_page(softening, small_case, tmp_path):
    """Its table is validated, kept with the case, and given to the law; other values of the case leave it alone."""
    table = snippet("toml")
    path = tmp_path / "own.toml"
    path.write_text(table)
    data = small_case().model_dump(mode="json", exclude={"material"})
    case = case_from_dict({**data, "material": read_toml(path, "a case")[1]["material"]})
    assert law_from_case(case) is softening.Exponential
    assert material_from_case(case).parameters == softening.Parameters(shear=0.5)
    dumped = case.model_dump(mode="json", exclude={"source"})
    assert dumped["material"]["exponential"] == {"shear": 0.5}
    again = case_from_dict(json.loads(json.dumps(dumped)))
    assert again == case
    assert again.material.parameters.shear == 0.5
    other = case.material.model_copy(update={"f_t": 2e6})
    assert other.parameters.shear == 0.5
    assert other.model_copy(update={"law": "cusatis-cedolin"}).parameters is None
    assert case.material.model_copy(update={"exponential": {"shear": 2.0}}).parameters.shear == 2.0


def test_defaults_of_the_table_need_no_table(case):
    assert case.material.parameters.shear == 1.0


@pytest.mark.parametrize(
    ("table", "key", "words"),
    [
        ({"shear": -1}, "material.exponential.shear", "0.01"),
        ({"sheer": 1}, "material.exponential.sheer", "did you mean material.exponential.shear?"),
        (3, "material.exponential", "not a table"),
    ],
)
def test_errors_name_the_key(softening, small_case, table, key, words):
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        small_case(material__law="exponential", material__exponential=table)
    assert caught.value.key == key


def test_the_table_of_another_law_is_unknown(softening, small_case):
    with pytest.raises(InputError, match="unknown key") as caught:
        small_case(material__exponential={})
    assert caught.value.key == "material.exponential"


def test_an_unknown_law_names_those_that_are(softening, small_case):
    with pytest.raises(InputError) as caught:
        small_case(material__law="rubber")
    assert caught.value.key == "material.law"
    assert "cusatis-cedolin" in caught.value.allowed
    assert "exponential" in caught.value.allowed


@pytest.mark.parametrize(
    ("text", "entry", "words"),
    [
        ("import nowhere_at_all", "broken = bad:Law", "ModuleNotFoundError: No module named 'nowhere_at_all'"),
        ("1 / 0", "broken = bad:Law", "ZeroDivisionError"),
        ("", "broken = bad:Law", "AttributeError"),
        ("Law = 3", "broken = bad:Law", "bad:Law is not a class"),
        ("class Law:\n    create = response = tangent = len", "broken = bad:Law", "lacks limits, initial_history"),
    ],
)
def test_a_package_that_does_not_work_is_named(packages, small_case, text, entry, words):
    install(packages, "bad-laws", entry, bad=text)
    with pytest.raises(InputError) as caught:
        small_case(material__law="broken")
    assert caught.value.key == "material.law"
    assert "bad-laws" in caught.value.problem
    assert words in caught.value.problem


def test_two_packages_of_one_name(packages, small_case):
    install(packages, "one", "same = first:Law")
    install(packages, "two", "same = second:Law")
    with pytest.raises(InputError, match="offered by one and two"):
        small_case(material__law="same")


def test_a_finished_case_is_read_where_its_law_is_not_known(small_case):
    data = small_case().model_dump(mode="json", exclude={"source"})
    data["material"].update(law="of-elsewhere", **{"of-elsewhere": {"shear": 0.5}})
    case = case_from_dict(data, files_exist=False)
    assert case.material.law == "of-elsewhere"
    with pytest.raises(InputError, match="not known"):
        law_from_case(case)


def test_a_program_enters_a_law_for_itself(softening, small_case, monkeypatch):
    monkeypatch.setitem(LAWS, "mine", softening.Exponential)
    case = small_case(material__law="mine", material__mine={"shear": 0.25})
    assert law_from_case(case) is softening.Exponential
    assert case.material.parameters.shear == 0.25
    assert "mine" in LAWS
