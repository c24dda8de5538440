"""Products of 6x6 blocks in vector instructions, and the plain ones that stand in for them."""

import os
import subprocess
import sys

import numpy as np
import pytest

from fissura.kernels import njit
from fissura.linear import plain, simd

times, transposed_times, prefetch, prefetch_item = (
    simd.times,
    simd.transposed_times,
    simd.prefetch,
    simd.prefetch_item,
)


@njit()
def in_vectors(blocks, k, x):
    prefetch(blocks, k)
    prefetch_item(x, k)
    own = (x[0], x[1], x[2], x[3], x[4], x[5])
    return times(blocks, k, own), transposed_times(blocks, k, own)


@njit()
def plainly(blocks, k, x):
    own = (x[0], x[1], x[2], x[3], x[4], x[5])
    return plain.times(blocks, k, own), plain.transposed_times(blocks, k, own)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_both_are_products(dtype):
    rng = np.random.default_rng(1)
    blocks, x = rng.normal(size=(4, 6, 6)).astype(dtype), rng.normal(size=6)
    for product in (in_vectors, plainly):
        for k in (0, 3):
            straight, turned = product(blocks, k, x)
            np.testing.assert_allclose(straight, blocks[k].astype(float) @ x, rtol=1e-13)
            np.testing.assert_allclose(turned, blocks[k].T.astype(float) @ x, rtol=1e-13)


SOLVED = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from equilibrium.models import beam_system
from fissura.linear import products, plain
from fissura.linear.symmetric import SymmetricSolver
assert (products.times is plain.times) == (sys.argv[2] == "0")
system = beam_system()
solver = SymmetricSolver(system.pattern, system.tessellation.x, "two-level")
solver.factor_contacts(system.geometry, system.moduli)
print(repr(float(system.control @ solver.solve(system.load))))
"""


def test_a_run_without_vector_instructions_differs_by_round_off(tmp_path):
    """In a process of its own, since kernels are compiled with one of the two."""
    found = []
    for simd_wanted in ("0", "1"):
        environment = {**os.environ, "FISSURA_SIMD": simd_wanted, "NUMBA_CACHE_DIR": str(tmp_path / simd_wanted)}
        if simd_wanted == "1":
            del environment["NUMBA_CACHE_DIR"]
        command = [sys.executable, "-c", SOLVED, os.path.dirname(os.path.dirname(__file__)), simd_wanted]
        out = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        assert out.returncode == 0, out.stderr
        found.append(float(out.stdout))
    assert found[0] == pytest.approx(found[1], rel=1e-9)
