from pathlib import Path

import pytest

import fissura.study.definition as module
from fissura.errors import InputError
from fissura.study.definition import FULL, load_study, merged

from .models import STUDY, write_study

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "study.toml"


def test_tasks_are_the_seeds_that_specimen_and_variation_share(study):
    tasks = [(t.seed, t.specimen, t.variation) for t in load_study(study).tasks()]
    assert tasks == [
        (1, "beam", FULL),
        (1, "beam", "default"),
        (1, "deep", FULL),
        (1, "deep", "default"),
        (2, "beam", FULL),
        (2, "beam", "default"),
        (2, "beam", "wide"),
    ]


def test_changes_arrive_in_the_cases(study):
    plan = load_study(study)
    assert plan.cases["deep", "wide"].notch[0].depth == 0.025
    assert plan.cases["deep", "wide"].adaptivity.r_f == 0.02
    assert plan.cases["beam", "default"].notch[0].depth == 0.02
    assert plan.cases["beam", "default"].adaptivity.r_f == 0.015
    assert {task.case.seed for task in plan.tasks()} == {1, 2}
    assert all(case.output.vtk == 0 for case in plan.cases.values())


def test_a_study_without_variations_has_the_default_one(tmp_path):
    text = STUDY.split("[[variations]]")[0]
    assert {t.variation for t in load_study(write_study(tmp_path, text)).tasks()} == {FULL, "default"}


def test_no_run_at_full_resolution_without_one_to_compare(tmp_path):
    text = STUDY.replace('[[variations]]\nname = "default"\n', "")
    assert {(t.specimen, t.seed) for t in load_study(write_study(tmp_path, text)).tasks()} == {("beam", 2)}


def test_merged_changes_tables_key_by_key_and_replaces_all_else():
    base = {"a": {"b": 1, "c": {"d": 2}}, "e": [1, 2]}
    assert merged(base, {"a": {"c": {"f": 3}}, "e": [4]}) == {"a": {"b": 1, "c": {"d": 2, "f": 3}}, "e": [4]}
    assert merged(base, {"a": []}) == {"a": [], "e": [1, 2]}
    assert base == {"a": {"b": 1, "c": {"d": 2}}, "e": [1, 2]}


@pytest.mark.parametrize(
    ("old", "new", "key", "said"),
    [
        ("seeds = [1, 2]", "seeds = [1, -2]", "seeds[1]", "too small"),
        ("seeds = [1, 2]", "seeds = []", "seeds", "at least one seed"),
        ("seeds = [1, 2]", "seeds = 1", "seeds", "a list of whole numbers"),
        ("seeds = [1, 2]", "sedes = [1, 2]", "sedes", "did you mean seeds"),
        ('name = "beam"\n', "", "specimens[0].name", "missing"),
        ('name = "deep"', 'name = "beam"', "specimens[1].name", "name of two"),
        ('name = "deep"', 'name = "Beam"', "specimens[1].name", "too near 'beam'"),
        ('name = "deep"', 'name = "a/b"', "specimens[1].name", "cannot name a file"),
        ('name = "deep"', 'name = ".."', "specimens[1].name", "cannot name a file"),
        ('name = "wide"', 'name = "full"', "variations[1].name", "full resolution"),
        ("seeds = [2, 3]", 'specimens = ["bean"]', "variations[1].specimens", "'bean' is not known"),
        ("adaptivity.r_f", "material.E", "variations[1].change.material", "adaptivity, discretization, solver"),
        ("adaptivity.r_f", "discretization.l_f", "variations[1].change.discretization.l_f", "full resolution"),
        ("adaptivity.r_f", "discretization.placement", "variations[1].change.discretization.placement", "full resolu"),
        ('"20 mm"', '"20 kg"', "variations[1] on specimens[0] (beam, wide): adaptivity.r_f", "kg"),
        ('"25 mm"', '"-1 mm"', "specimens[1] (deep): notch.depth", "negative"),
        ("change.notch", "change.notsch", "specimens[1] (deep): notsch", "did you mean notch"),
    ],
)
def test_errors_name_the_key(tmp_path, old, new, key, said):
    assert old in STUDY
    with pytest.raises(InputError) as caught:
        load_study(write_study(tmp_path, STUDY.replace(old, new)))
    assert caught.value.key == key
    assert said in str(caught.value)


def many(count):
    return str(list(range(count)))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("seeds = [1, 2]", f"seeds = {many(200_000)}", "seeds"),
        ("seeds = [1]", f"seeds = {many(60_000)}", "specimens[1].seeds"),
        (
            "[[variations]]",
            "".join(f'[[variations]]\nname = "v{k}"\n' for k in range(5000)) + "[[variations]]",
            "variations",
        ),
    ],
)
def test_a_study_that_never_ends_is_refused(tmp_path, old, new, key):
    with pytest.raises(InputError, match=r"at most 10+ (runs|cases)") as caught:
        load_study(write_study(tmp_path, STUDY.replace(old, new, 1)))
    assert caught.value.key == key


def test_runs_are_counted_as_they_are_made(tmp_path, monkeypatch):
    path = write_study(tmp_path)
    count = len(list(load_study(path).tasks()))
    monkeypatch.setattr(module, "MOST_RUNS", count)
    load_study(path)
    monkeypatch.setattr(module, "MOST_RUNS", count - 1)
    with pytest.raises(InputError, match=f"at most {count - 1} runs"):
        load_study(path)


def test_files_that_cannot_be_read(tmp_path):
    for path, text, problem in (
        (tmp_path / "no.toml", None, "no such file"),
        (tmp_path / "bad.toml", "seeds = ", "not TOML"),
        (tmp_path, None, "is a folder"),
    ):
        if text is not None:
            path.write_text(text)
        with pytest.raises(InputError) as caught:
            load_study(path)
        assert problem in caught.value.problem
    study = write_study(tmp_path, STUDY.replace("beam.toml", "bean.toml"))
    with pytest.raises(InputError, match=r"specimens\[0\]\.case: .*bean\.toml: .*no such file \(allowed: a case file"):
        load_study(study)


def test_the_study_of_the_benchmarks_is_valid():
    plan = load_study(BENCHMARK)
    assert {entry.type for entry in plan.study.specimens} == {
        "half-notched beam",
        "0.2-notched beam",
        "unnotched beam",
        "tension prism",
    }
    paths = [task.path for task in plan.tasks()]
    assert len(set(paths)) == len(paths) > 100
    assert plan.cases["unnotched_d200", FULL].notch == ()
