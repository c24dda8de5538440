"""The table of Poisson's ratio against alpha that the package brings along, from periodic saturated structures.

Writes src/fissura/bulk_elasticity.csv with --write; without, compares that table with new structures. Modulus of
elasticity follows from ``E_macro = E (1 - 2 nu)``, which is exact. Some minutes with the defaults.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from fissura.bulk import bulk_law
from fissura.elasticity.homogenise import Homogenisation
from fissura.elasticity.stiffness import isotropic_part
from fissura.tessellation.periodic import PeriodicCell

TABLE = Path(__file__).resolve().parent.parent / "src" / "fissura" / "bulk_elasticity.csv"

ALPHA = (
    *(0.01, 0.0125, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05, 0.0625, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25),
    *(0.275, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0),
)

HEAD = """\
# Poisson's ratio nu of the bulk against alpha, tangential over normal stiffness of contacts: mean and standard error
# over {seeds} periodic structures of saturated nuclei in cubes of side {side:g} l_min ({bodies:.0f} bodies on average).
# E_macro = E (1 - 2 nu) exactly. Made by: python benchmarks/bulk_elasticity.py --side {side:g} --seeds {seeds} --write
alpha,nu,standard_error
"""

#: Largest relative difference of E between the table and new structures, beside three standard errors.
LIMIT = 0.003


def ratios(alphas: tuple[float, ...], side: float, seeds: range) -> tuple[np.ndarray, float]:
    """Poisson's ratios, one row for each seed, and the mean number of bodies."""
    rows, bodies = [], []
    for seed in seeds:
        cell = PeriodicCell.placed(side, 1.0, np.random.default_rng(np.random.SeedSequence(seed)))
        structure = Homogenisation(cell)
        rows.append([isotropic_part(structure.stiffness(alpha)).nu for alpha in alphas])
        bodies.append(len(cell))
        print(f"seed {seed}: {len(cell)} bodies, {time.process_time():.0f} s", file=sys.stderr, flush=True)
    return np.array(rows), float(np.mean(bodies))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--side", type=float, default=10.0, help="side of the cubes in l_min")
    parser.add_argument("--seeds", type=int, default=60, help="number of structures")
    parser.add_argument("--first", type=int, default=1, help="seed of the first one")
    parser.add_argument("--write", action="store_true", help="write the table")
    found = parser.parse_args()
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
    law, missed = bulk_law(), 0
    for a, m, e in zip(alphas, mean, error, strict=True):
        E, expected = law.macroscopic(1.0, a)
        off = (1.0 - 2.0 * m) / E - 1.0
        limit = LIMIT + 6.0 * e / E
        missed += abs(off) > limit
        print(f"alpha {a:g}: nu {m:.5f} ± {e:.5f}, table {expected:.5f}; E off by {off:+.3%}, allowed {limit:.3%}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
