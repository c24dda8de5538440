import numpy as np
import pytest
from numba import njit

from equilibrium.models import beam, beam_system, secant_entries
from fissura import Simulation
from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.linear.block_cholesky import IncompleteCholesky
from fissura.linear.blocks import held_bodies, lower_blocks, multiply
from fissura.linear.dissection import dissected_order, domain_count
from fissura.linear.krylov import _orthogonalized, _pieces, gmres
from fissura.linear.two_level import TwoLevel
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads
from fissura.machine.threads import VARIABLE

FINE = {"discretization": {"l_f": 0.005, "l_c": 0.01}}
DOMAINS = 3


@njit(nogil=True)
def _filled(begin, end, out):  # type: ignore[no-untyped-def]
    for k in range(begin, end):
        out[k] += k
    return end - begin


@pytest.fixture(scope="module")
def sound():
    return beam_system(beam(**FINE))


@pytest.fixture(scope="module")
def dissected(sound):
    order, bounds = dissected_order(sound.pattern, held_bodies(sound.pattern, low_rank=False), DOMAINS)
    return lower_blocks(sound.pattern, order, bounds)


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_every_piece_is_done_once_and_results_keep_their_order(threads):
    out, bounds = np.zeros(100), [0, 7, 7, 50, 90, 100]
    assert KernelThreads(threads).run(_filled, bounds, out) == [7, 0, 43, 40, 10]
    np.testing.assert_array_equal(out, np.arange(100))


def test_an_error_in_a_piece_comes_out():
    def kernel(begin, end):
        if begin == 2:
            raise ValueError("piece")

    for threads in (1, 2):
        with pytest.raises(ValueError, match="piece"):
            KernelThreads(threads).run(kernel, [0, 1, 2, 3])


def test_threads_are_as_many_as_asked_for(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    assert 1 <= KernelThreads().count <= 4
    assert KernelThreads(7).count == 7
    monkeypatch.setenv(VARIABLE, "3")
    assert KernelThreads().count == 3
    assert KernelThreads(1).count == 1


@pytest.mark.parametrize("value", ["", "0", "-1", "two", "1.5", "²"])
def test_a_wrong_number_in_the_environment_is_reported(monkeypatch, value):
    monkeypatch.setenv(VARIABLE, value)
    with pytest.raises(InputError, match=VARIABLE):
        KernelThreads()


def test_a_case_says_how_many_threads():
    data = beam().model_dump()
    assert beam().solver.threads == 0
    assert case_from_dict(data | {"solver": {"threads": 2}}).solver.threads == 2
    with pytest.raises(InputError, match="threads"):
        case_from_dict(data | {"solver": {"threads": -1}})


def test_a_run_uses_the_threads_of_its_case():
    case = case_from_dict(beam().model_dump() | {"solver": {"threads": 3}})
    assert Simulation(case)._discretization.system.threads.count == 3


def test_a_small_structure_is_one_domain_and_starts_no_thread(sound):
    threads = KernelThreads(2)
    solver = TwoLevel(sound.pattern, sound.tessellation.x, threads=threads)
    solver.factor(secant_entries(sound, sound.virgin()), symmetric=True)
    solver.solve(sound.load)
    assert [domain_count(n) for n in (1, 14_999, 15_000, 30_000, 10**6)] == [1, 1, 2, 4, 4]
    assert threads._pool is None


def test_domains_do_not_touch_each_other(sound, dissected):
    """Every coupling of two domains has an end in the tail; supports come last of all."""
    domain = np.searchsorted(dissected.bounds, np.arange(len(dissected.order)), side="right")
    row, column = domain[dissected.rows], domain[dissected.indices]
    in_tail = row > DOMAINS
    assert np.array_equal(row[~in_tail], column[~in_tail])
    assert 0 < in_tail.sum() < 0.5 * len(row)
    np.testing.assert_array_equal(np.sort(dissected.order), np.arange(len(dissected.order)))
    held = held_bodies(sound.pattern, low_rank=False)
    assert held[dissected.order[-held.sum() :]].all()


def test_product_is_that_of_the_matrix(sound, dissected):
    data = secant_entries(sound, sound.virgin())
    u = np.random.default_rng(1).normal(size=(len(sound.tessellation), 6))
    expected = sound.pattern.product(data, u.ravel()).reshape(-1, 6)
    found = multiply(dissected, dissected.gather(data, threads=KernelThreads(2)), u[dissected.order], KernelThreads(2))
    np.testing.assert_allclose(found, expected[dissected.order], rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_solutions_do_not_depend_on_the_number_of_domains_beyond_the_tolerance(sound):
    data = secant_entries(sound, sound.virgin())
    found, iterations = [], []
    for domains in (1, 2, 6):
        solver = TwoLevel(sound.pattern, sound.tessellation.x, domains=domains)
        solver.factor(data, symmetric=True)
        found.append(solver.solve(sound.load))
        iterations.append(solver.iterations)
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], rtol=0.0, atol=1e-6 * np.abs(found[0]).max())
    assert max(iterations) <= iterations[0] + 5


def test_solutions_do_not_depend_on_the_number_of_threads(sound):
    """Bit for bit, with a crack, and twice with the same solver."""
    history = sound.virgin().copy()
    history[::7, 0] = 0.99
    found = set()
    for threads in (1, 2, 3, 4, 2):
        solver = TwoLevel(sound.pattern, sound.tessellation.x, threads=KernelThreads(threads), domains=DOMAINS)
        for data in (secant_entries(sound, sound.virgin()), secant_entries(sound, history)):
            solver.factor(data, symmetric=True)
        found.add((solver.solve(sound.load).tobytes(), solver.apply(sound.control).tobytes(), solver.iterations))
    assert len(found) == 1


def test_pivots_that_fail_in_one_domain_are_mended_in_all(sound, monkeypatch):
    """The share that is added to the diagonal is the same for domains and tail, whoever needs it."""
    data = secant_entries(sound, sound.virgin()).copy()
    form = lower_blocks(sound.pattern, *dissected_order(sound.pattern, held_bodies(sound.pattern), DOMAINS))
    blocks = form.gather(data)
    for place in (form.bounds[1] - 1, len(form.order) - 1):
        worse = blocks.copy()
        row = slice(form.indptr[place], form.indptr[place + 1] - 1)
        worse[row] *= 10.0
        found = set()
        for threads in (1, 2):
            factor = IncompleteCholesky(form, KernelThreads(threads))
            factor.factor(worse)
            found.add((factor.share, factor.shifted, factor.solve(np.ones((len(form.order), 6))).tobytes()))
        assert len(found) == 1
        assert factor.share > 0.0


def test_long_vectors_are_made_orthogonal_in_pieces():
    rng = np.random.default_rng(2)
    n = 200_001
    assert _pieces(179_999) == (0, 179_999)
    assert _pieces(n)[0] == 0
    assert _pieces(n)[-1] == n
    assert len(_pieces(n)) == 5
    basis = list(np.linalg.qr(rng.normal(size=(n, 3)))[0].T.copy())
    start = rng.normal(size=n)
    results = set()
    for threads in (1, 2, 4):
        image = start.copy()
        *shares, left = _orthogonalized(basis, image, KernelThreads(threads))
        results.add(image.tobytes())
    assert len(results) == 1
    np.testing.assert_allclose([own @ image for own in basis], 0.0, atol=1e-10)
    np.testing.assert_allclose(sum(s * own for s, own in zip(shares, basis, strict=True)) + image, start, atol=1e-12)
    assert left == pytest.approx(np.linalg.norm(image), rel=1e-12)


def test_gmres_is_the_same_for_any_team():
    n = 200_000
    diagonal = np.linspace(1.0, 3.0, n)
    found = {
        gmres(lambda v: (v, diagonal * v), np.ones(n), 1e-8, 40, threads).solution.tobytes()
        for threads in (SINGLE_THREAD, KernelThreads(2))
    }
    assert len(found) == 1
    np.testing.assert_allclose(diagonal * np.frombuffer(found.pop()), 1.0, atol=1e-6)


@pytest.mark.parametrize("asked", ["x", "-1", "0", "1.5", "", "10001", "9" * 5000, "１"])
def test_odd_numbers_of_threads_in_the_environment(monkeypatch, asked):
    monkeypatch.setenv(VARIABLE, asked)
    with pytest.raises(InputError, match="1 to 10000") as caught:
        KernelThreads()
    assert caught.value.key == VARIABLE
    assert len(str(caught.value)) < 300
