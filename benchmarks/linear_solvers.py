"""Two-level conjugate gradients against a direct solver, on notched beams of growing size at full resolution.

Only the spacing of the nuclei changes from row to row. Cracked: contacts across the lower half of the ligament have
lost 99 per cent of their stiffness.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from common import Check, Report, changed, example, main, options, say, table
from fissura import Case
from fissura.contact import law_from_case
from fissura.equilibrium import System
from fissura.equilibrium.direct import best_solver
from fissura.equilibrium.two_level import TwoLevel
from fissura.material import material_from_case
from fissura.specimen import conditions_from_case, specimen_from_case
from fissura.tessellation import discretize, nuclei_from_case

#: Numbers of bodies, roughly.
SIZES = (1000, 2000, 5000, 10_000, 30_000)
#: Bodies up to which the direct solver runs along: it needs 2.6 GB for 30 000.
DIRECT_UP_TO = 12_000
#: Relative error of the two-level solution in the energy norm.
TOLERANCE = 1e-6
#: Most iterations, and from how many bodies on two-level is to be faster.
ITERATIONS, CROSSING = 60, 3000

TEXT = f"""\
Bodies at full resolution; iterations to a relative error of {TOLERANCE:g} in energy norm; processor times in seconds.
Preparation: once for a discretization (the direct solver's symbolic analysis, with its first factorization taken off).
Setup: for new entries of the matrix. One product of the matrix in compressed rows (scipy) with a vector took the time
of the column; the solve is also given in such products. Ratio: time of one factorization and two solves, direct over
two-level, without preparation.
"""


def produce(found: argparse.Namespace) -> Report:
    _row(found.cases[0], found.seeds[0], SIZES[0] // 4)  # compiled kernels are not part of what is measured
    rows = [_row(name, seed, size) for name in found.cases for seed in found.seeds for size in SIZES]
    return Report("linear_solvers", rows, _markdown(rows), _checks(rows))


def _system(case: Case) -> System:
    box = specimen_from_case(case)
    nuclei = nuclei_from_case(case, box)
    tessellation = discretize(nuclei, box, np.zeros(len(nuclei)))
    return System(tessellation, material_from_case(case), law_from_case(case), conditions_from_case(case, box))


def _timed(call: Callable[[], Any]) -> tuple[Any, float]:
    start = time.process_time()
    out = call()
    return out, time.process_time() - start


def _row(name: str, seed: int, size: int) -> dict[str, Any]:
    case = example(name, seed)
    # A beam at spacing l has about 0.85 V / l^3 bodies, more near its surface than inside.
    spacing = (0.85 * float(np.prod(case.specimen.size)) / size) ** (1 / 3)
    system = _system(changed(case, discretization={"l_f": spacing, "l_c": 4 * spacing}))
    bodies = len(system.tessellation)
    say(f"{name}, seed {seed}: {bodies} bodies")
    sound = system.secant(system.virgin())
    solver, preparation = _timed(lambda: TwoLevel(system.pattern, system.tessellation.x, TOLERANCE, reference=sound))
    _, setup = _timed(lambda: solver.factor(sound, symmetric=True))
    u, solve = _timed(lambda: solver.solve(system.load))
    row = {"case": name, "seed": seed, "bodies": bodies, "iterations": solver.iterations, "clusters": solver.clusters}
    row |= {"preparation_s": preparation, "setup_s": setup, "solve_s": solve}
    matrix = system.pattern.matrix(sound)
    times = [_timed(lambda: matrix @ u)[1] for _ in range(7)]
    row |= {"product_s": float(np.median(times)), "products": solve / float(np.median(times))}
    row |= {"per_body_us": 1e6 * (setup + solve) / bodies}
    row |= {"residual": float(np.linalg.norm(matrix @ u - system.load) / np.linalg.norm(system.load))}
    solver.factor(_cracked(system, case), symmetric=True)
    solver.solve(system.load)
    row |= {"iterations_cracked": solver.iterations}
    return row | (_direct(system, sound, u, setup + 2 * solve) if bodies <= DIRECT_UP_TO else {})


def _cracked(system: System, case: Case) -> np.ndarray[Any, Any]:
    """Entries of the secant stiffness with a crack from the notch through half of the ligament."""
    notch, x = case.notch[0], system.tessellation.x
    bodies = system.tessellation.contacts.bodies[system.active]
    sides = x[bodies, 0] < notch.position
    depth = case.specimen.size[1]
    below = x[bodies, 1].mean(axis=1) < notch.depth + 0.5 * (depth - notch.depth)
    history = system.virgin().copy()
    history[(sides[:, 0] != sides[:, 1]) & below, 0] = 0.99
    return system.secant(history)


def _direct(system: System, data: np.ndarray[Any, Any], u: np.ndarray[Any, Any], two_level: float) -> dict[str, Any]:
    direct = best_solver()(system.pattern)
    _, first = _timed(lambda: direct.factor(data, symmetric=True))
    _, factor = _timed(lambda: direct.factor(data, symmetric=True))
    expected, solve = _timed(lambda: direct.solve(system.load))
    return {
        "direct_preparation_s": first - factor,
        "direct_factor_s": factor,
        "direct_solve_s": solve,
        "ratio": (factor + 2 * solve) / two_level,
        "difference": float(np.abs(u - expected).max() / np.abs(expected).max()),
    }


#: Columns of the table: key, head, format.
COLUMNS = [
    ("bodies", "bodies", ".0f"),
    ("iterations", "iterations", ".0f"),
    ("iterations_cracked", "cracked", ".0f"),
    ("preparation_s", "preparation [s]", ".3f"),
    ("setup_s", "setup [s]", ".3f"),
    ("solve_s", "solve [s]", ".3f"),
    ("per_body_us", "setup + solve per body [µs]", ".0f"),
    ("product_s", "product [s]", ".4f"),
    ("products", "solve in products", ".0f"),
    ("direct_preparation_s", "direct: preparation [s]", ".2f"),
    ("direct_factor_s", "factor [s]", ".3f"),
    ("direct_solve_s", "solve [s]", ".3f"),
    ("ratio", "ratio", ".1f"),
]


def _markdown(rows: list[dict[str, Any]]) -> str:
    lines = [[f"{row[key]:{form}}" if key in row else "–" for key, _, form in COLUMNS] for row in rows]
    return "\n".join(["## Linear solvers", TEXT, table([head for _, head, _ in COLUMNS], lines), "", _crossing(rows)])


def _crossing(rows: list[dict[str, Any]]) -> str:
    compared = sorted((row["bodies"], row["ratio"]) for row in rows if "ratio" in row)
    slower = [bodies for bodies, ratio in compared if ratio < 1.0]
    faster = [bodies for bodies, ratio in compared if ratio >= 1.0 and bodies > max(slower, default=0)]
    if not faster:
        return "Direct solution is faster at all sizes that were compared."
    if not slower:
        return f"Two-level is faster from the smallest size on, {faster[0]} bodies."
    return f"The two cross between {max(slower)} and {faster[0]} bodies."


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    most = max(max(row["iterations"], row["iterations_cracked"]) for row in rows)
    large = [row["ratio"] for row in rows if "ratio" in row and row["bodies"] >= CROSSING]
    checks = [Check("most iterations", most, ITERATIONS)]
    if large:
        checks.append(Check(f"smallest ratio from {CROSSING} bodies on", min(large), 1.0, at_least=True))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1])))
