"""The table of Poisson's ratio against alpha that the package brings along, from periodic saturated structures.

Writes src/fissura/case/macroscopic_elasticity.csv with --write; without, compares that table with new structures.
Modulus of elasticity follows from ``E_macro = E (1 - 2 nu)``, which is exact. Some minutes with the defaults. With
--density 0.65 sequential placement gives up at that many nuclei in a cube of side l_min, and its values are compared
with those that pictures show for it.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from fissura.case.macroscopic import macroscopic_elasticity
from fissura.elasticity.homogenise import Homogenisation
from fissura.elasticity.pictures import SPARSE
from fissura.elasticity.stiffness import isotropic_part
from fissura.tessellation.periodic import PeriodicCell, periodic_cell

TABLE = Path(__file__).resolve().parent.parent / "src" / "fissura" / "case" / "macroscopic_elasticity.csv"

ALPHA = (
    *(0.01, 0.0125, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05, 0.0625, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25),
    *(0.275, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0),
)

HEAD = """\
# Poisson's ratio nu of the bulk against alpha, tangential over normal stiffness of contacts: mean and standard error
# over {seeds} periodic structures of saturated nuclei in cubes of side {side:g} l_min ({bodies:.0f} bodies on average).
# E_macro = E (1 - 2 nu) exactly. Made by:
# python benchmarks/macroscopic_elasticity.py --side {side:g} --seeds {seeds} --write
alpha,nu,standard_error
"""

#: Largest relative difference of E between the table and new structures, beside three standard errors.
LIMIT = 0.003


def sparse_cell(side: float, density: float, rng: np.random.Generator) -> PeriodicCell:
    """A cell of which sequential placement has left out the last nuclei."""
    x = np.empty((0, 3))
    while len(x) < round(density * side**3):
        p = rng.random(3) * side
        away = x - p - side * np.round((x - p) / side)
        if (np.einsum("na,na->n", away, away) >= 1.0).all():
            x = np.concatenate([x, [p]])
    return periodic_cell(x, side, 1.0, gap=1.5)


def ratios(
    alphas: tuple[float, ...], side: float, seeds: range, density: float | None = None
) -> tuple[np.ndarray, float]:
    """Poisson's ratios, one row for each seed, and the mean number of bodies."""
    rows, bodies = [], []
    for seed in seeds:
        rng = np.random.default_rng(np.random.SeedSequence(seed))
        cell = PeriodicCell.placed(side, 1.0, rng) if density is None else sparse_cell(side, density, rng)
        structure = Homogenisation(cell)
        rows.append([isotropic_part(structure.stiffness(alpha)).nu for alpha in alphas])
        bodies.append(len(cell))
        print(f"seed {seed}: {len(cell)} bodies, {time.process_time():.0f} s", file=sys.stderr, flush=True)
    return np.array(rows), float(np.mean(bodies))


def compare_sparse(side: float, density: float, seeds: range) -> int:
    """Compare structures that are not saturated with the values known for them."""
    nu, _ = ratios(tuple(row[0] for row in SPARSE), side, seeds, density)
    mean, error = nu.mean(axis=0), nu.std(axis=0, ddof=1) / np.sqrt(len(nu))
    for (a, E, known), m, e in zip(SPARSE, mean, error, strict=True):
        print(f"alpha {a:g}: E {1 - 2 * m:.4f} ± {2 * e:.4f}, nu {m:.4f} ± {e:.4f}; known {E:g}, {known:g}")
    known = np.array(SPARSE)[:, 2]
    return int((np.abs(mean - known) > LIMIT + 3.0 * error).any())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--side", type=float, default=10.0, help="side of the cubes in l_min")
    parser.add_argument("--seeds", type=int, default=60, help="number of structures")
    parser.add_argument("--first", type=int, default=1, help="seed of the first one")
    parser.add_argument("--write", action="store_true", help="write the table")
    parser.add_argument("--density", type=float, help="nuclei in a cube of side l_min, fewer than saturation has")
    found = parser.parse_args()
    if found.density is not None:
        return compare_sparse(found.side, found.density, range(found.first, found.first + found.seeds))
    alphas = ALPHA if found.write else (0.015, 0.06, 0.11, 0.29, 0.62)
    nu, bodies = ratios(alphas, found.side, range(found.first, found.first + found.seeds))
    mean, error = nu.mean(axis=0), nu.std(axis=0, ddof=1) / np.sqrt(found.seeds)
    if found.write:
        mean[-1] = error[-1] = 0.0  # exact for alpha = 1
        text = HEAD.format(seeds=found.seeds, side=found.side, bodies=bodies)
        text += "".join(f"{a:g},{m:.6f},{e:.6f}\n" for a, m, e in zip(alphas, mean, error, strict=True))
        TABLE.write_text(text, encoding="utf-8")
        print(text)
        return 0
    law, missed = macroscopic_elasticity(), 0
    for a, m, e in zip(alphas, mean, error, strict=True):
        E, expected = law.macroscopic(1.0, a)
        off = (1.0 - 2.0 * m) / E - 1.0
        limit = LIMIT + 6.0 * e / E
        missed += abs(off) > limit
        print(f"alpha {a:g}: nu {m:.5f} ± {e:.5f}, table {expected:.5f}; E off by {off:+.3%}, allowed {limit:.3%}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
