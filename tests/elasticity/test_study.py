"""Prisms and studies: agreement with runs, statistics, fits, tables."""

import csv

import numpy as np
import pytest

from fissura.elasticity import answers
from fissura.elasticity.specimen import Prism, prism_case
from fissura.elasticity.study import KINDS, LayerFit, Row, Study, spread, structure_seeds, study
from fissura.simulation.loop import Simulation


@pytest.fixture(scope="module")
def small():
    return study((0.3, 1.0, 0.3), (5, 4), structure_seeds(3), aspect=1.5)


def test_a_prism_has_the_stiffness_of_a_run():
    """From end to end: load over displacement as a run at full resolution finds it."""
    case = prism_case(0.05, 2.0, 0.01, 3, 30e9, 0.29)
    simulation = Simulation(case, full=True)
    modulus = simulation.start().start.stiffness * 0.1 / 0.05**2
    prism = Prism(0.05, 2.0, 0.01, 3)
    assert len(prism) == simulation.bodies_full
    assert prism.constants(0.29, 30e9).E_whole == pytest.approx(modulus, rel=1e-4)


def test_a_prism_without_lateral_stiffness_ratio_has_no_lateral_strain():
    found = Prism(5.0, 2.0, 1.0, 1).constants(1.0)
    assert found.nu == pytest.approx(0.0, abs=2e-3)
    assert found.E_gauge == pytest.approx(1.0, abs=0.03)


def test_size_of_bodies_does_not_matter_in_a_prism():
    a, b = Prism(4.0, 1.0, 1.0, 2).constants(0.2), Prism(0.04, 1.0, 0.01, 2).constants(0.2)
    assert (b.E_whole, b.E_gauge, b.nu) == pytest.approx((a.E_whole, a.E_gauge, a.nu), rel=1e-6)


def test_loose_corners_do_not_count():
    """Seed 6 has a corner body with two contacts, on the end that is held."""
    prism = Prism(8.0, 2.0, 1.0, 6)
    touching = np.bincount(prism.system.tessellation.contacts.bodies.ravel())
    assert touching.min() == 2
    assert 0.6 < prism.constants(0.29).E_whole < 0.7


def test_study_is_complete_and_repeats_itself(small):
    assert [(r.kind, r.alpha, r.size) for r in small.rows] == [
        (kind, alpha, size) for kind in KINDS for alpha in (0.3, 1.0) for size in (4, 5)
    ]
    again = study((0.3, 1.0), (4, 5), (1, 2, 3), aspect=1.5)
    for a, b in zip(small.rows, again.rows, strict=True):
        assert np.array_equal(a.E, b.E)
        assert np.array_equal(a.nu, b.nu)
    for row in small.of("periodic", alpha=1.0):
        np.testing.assert_allclose(row.E, 1.0, rtol=1e-12)
    for row in small.of("periodic"):
        np.testing.assert_allclose(row.E, 1.0 - 2.0 * row.nu, rtol=1e-12)


def test_progress_counts_structures():
    seen = []
    study((0.5,), (4,), (1, 2), on_structure=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_spread():
    values = np.array([1.0, 2.0, 3.0, 4.0])
    mean, deviation, half = spread(values)
    assert mean == 2.5
    assert deviation == pytest.approx(np.sqrt(5.0 / 3.0))
    assert half == pytest.approx(3.1824463 * deviation / 2.0)  # Student's 0.975 quantile with three degrees of freedom
    assert spread(np.array([7.0]))[0] == 7.0
    assert np.isnan(spread(np.array([7.0]))[1:]).all()


def test_layer_fit_finds_what_was_put_in():
    sizes = np.repeat([4.0, 6.0, 8.0, 12.0], 3)
    exact = LayerFit.of(sizes, 0.64 * (1.0 + 0.2 / sizes))
    assert (exact.E_bulk, exact.c) == pytest.approx((0.64, 0.2), rel=1e-10)
    rng = np.random.default_rng(1)
    off = []
    for _ in range(300):
        fit = LayerFit.of(sizes, 0.64 * (1.0 + 0.2 / sizes) + 0.05 * rng.normal(size=12) * sizes**-1.5)
        off.append(((fit.E_bulk - 0.64) / fit.E_bulk_error, (fit.c - 0.2) / fit.c_error))
    # Errors are about as large as they say: Student's distribution with ten degrees of freedom.
    np.testing.assert_allclose(np.std(off, axis=0), np.sqrt(10 / 8), rtol=0.15)


def test_too_few_structures_have_no_fit():
    rows = tuple(Row("gauge", 0.3, size, 10.0, np.array([0.6]), np.array([0.2])) for size in (4.0, 6.0))
    assert Study(rows, 2.0).layer("gauge", 0.3) is None
    assert Study(rows[:1], 2.0).layer("gauge", 0.3) is None
    assert answers.layer_table(Study(rows, 2.0))[1] == []


def test_tables_and_files(small, tmp_path):
    heads, rows = answers.study_table(small, 60e9)
    assert all(len(row) == len(heads) for row in rows)
    assert len(rows) == 12
    assert rows[2][heads.index("E")] == "60 GPa"  # alpha 1 in a periodic cell
    heads, rows = answers.layer_table(small)
    assert [row[:2] for row in rows][:2] == [["prism, gauge", "0.3"], ["prism, gauge", "1"]]
    names = answers.write(small, tmp_path, 60e9)
    assert sorted(names) == sorted(path.name for path in tmp_path.glob("[!.]*"))
    with (tmp_path / "elastic.csv").open() as file:
        table = list(csv.DictReader(file))
    assert len(table) == 12
    for line, row in zip(table, small.rows, strict=True):
        assert line["structure"] == row.kind
        assert float(line["E_ratio"]) == pytest.approx(row.E.mean(), rel=1e-9)
        assert float(line["E_Pa"]) == pytest.approx(60e9 * row.E.mean(), rel=1e-9)
        assert float(line["nu_ci95"]) == pytest.approx(spread(row.nu)[2], rel=1e-8, abs=1e-12)
