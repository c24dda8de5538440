"""Linear solvers on notched beams of growing size at full resolution: two-level, direct, smoothed aggregation.

Only the spacing of the nuclei changes from row to row. Cracked: contacts across a part of the ligament, from the notch
on, have lost 99 per cent of their stiffness. Needs PyAMG; with --write it also draws docs/images/solver_iterations.png.
"""

from __future__ import annotations

import argparse
import json
import os
import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common import ROOT, Check, Report, changed, example, main, options, say, table
from fissura import Case
from fissura.contact import law_from_case
from fissura.equilibrium import System
from fissura.linear.amg import SmoothedAggregation
from fissura.linear.assembly import assemble_secant
from fissura.linear.direct import best_solver
from fissura.linear.two_level import TwoLevel
from fissura.machine.kernel_threads import KernelThreads
from fissura.material import material_from_case
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case
from solver_figure import draw
from solver_memory import TOLERANCE

FloatArray = NDArray[np.float64]

#: Numbers of bodies, roughly.
SIZES = (1000, 2000, 5000, 10_000, 30_000, 100_000)
#: Bodies up to which the direct solver runs along: it needs 2.6 GB for 30 000.
DIRECT_UP_TO = 40_000
#: Bodies in the bars with a whole face held.
BARS = (5000, 20_000, 100_000)
#: Shares of the ligament that are cracked, and bodies of the beam of that figure.
CRACKS, CRACKED = (0.0, 0.25, 0.5, 0.75, 0.9, 0.97), 10_000
#: Targets: growth of the cost per body from 10 000 to 100 000 bodies, direct over two-level at 30 000 and amg over
#: two-level anywhere, products of the matrix with a vector per solution, peak memory per body [kB].
GROWTH, OVER_DIRECT, OVER_AMG, PRODUCTS, MEMORY = 1.5, 10.0, 1.0, 60.0, 15.0
#: Bodies in the beams that threads share, and the numbers of domains and threads that are compared.
SHARED, TEAMS = (30_000, 100_000), ((1, 1), (4, 1), (4, 2), (4, 4))
#: From this number of bodies on the two-level solver is chosen by `auto`, and has to keep the target for products.
AUTO = 2000
#: Repetitions of what is quick, of which the median counts.
REPEATS = 5

TEXT = f"""\
Relative error {TOLERANCE:g} in energy norm. Processor times per body; *wall* is the wall time of all three parts.
Preparation: once for a discretization. Setup: for new entries of the matrix. Products: preparation, setup and solve
together, in products of the matrix in compressed rows (scipy) with a vector, timed in the same process in between.
Iterations: sound, and with a crack through 50 and 90 % of the ligament.
"""
COMPARED = """\
Ratios of processor times in one process, the other solver over two-level: setup and one solve, setup and two solves;
both without what is done once for a discretization, which for the direct solver is its symbolic phase (preparation).
"""
REMEMBERED = """\
Peak memory [kB per body] of preparation, setup and one solve, beyond the matrix: growth of the peak resident size of a
process that holds the matrix and has compiled kernels and libraries loaded (`benchmarks/solver_memory.py`). Matrix:
entries, compressed rows and block structure.
"""
THREADS = """\
Preparation, setup and one solve by teams of threads; each domain may be worked on by another one, and what lies between
domains, the tail, by one only. Processor time of all threads, and of the one that does most: the wall time where every
thread has a processor of its own. *Wall* is what the clock said, with whatever else ran. Solutions of four domains must
be the same bit for bit.
"""
FACES = """\
Bars of `examples/tension_bar.toml`, one whole face clamped, the other pulled: the support is kept as six rows that
touch all held bodies, beside a matrix that would otherwise hold a dense block of their size.
"""


def produce(found: argparse.Namespace) -> Report:
    _beam_row(found.cases[0], found.seeds[0], SIZES[0] // 4, memory=False)  # compiled kernels are not measured
    rows = [_beam_row(name, seed, size) for name in found.cases for seed in found.seeds for size in SIZES]
    rows += [_bar_row(found.seeds[0], size) for size in BARS]
    for size in SHARED:
        rows += _team_rows(found.cases[0], found.seeds[0], size)
    crack = [_crack_row(found.cases[0], found.seeds[0])]
    if found.write:
        path = ROOT / "docs" / "images" / "solver_iterations.png"
        draw([row for row in rows if row["kind"] == "size"], crack[0], path)
        say(f"written: {path}")
    return Report("linear_solvers", rows + crack, _markdown(rows), _checks(rows))


def _system(name: str, seed: int, size: int) -> tuple[Case, System]:
    case = example(name, seed)
    # At spacing l there are about 0.85 V / l^3 bodies, more near the surface than inside.
    spacing = (0.85 * float(np.prod(case.specimen.size)) / size) ** (1 / 3)
    case = changed(case, discretization={"l_f": spacing, "l_c": 4 * spacing})
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    tessellation = discretize(nuclei, domain, np.zeros(len(nuclei)))
    system = System(tessellation, material_from_case(case), law_from_case(case), conditions_from_case(case, domain))
    say(f"{name}, seed {seed}: {len(tessellation)} bodies")
    return case, system


def _secant(system: System, history: FloatArray) -> FloatArray:
    """Entries of the secant stiffness."""
    return assemble_secant(system.geometry, system.pattern, system.secant_moduli(history))


def _timed(call: Callable[[], Any]) -> tuple[Any, float, float]:
    wall, cpu = time.perf_counter(), time.process_time()
    out = call()
    return out, time.process_time() - cpu, time.perf_counter() - wall


def _two_level(system: System, data: FloatArray) -> dict[str, Any]:
    """Medians of processor times of the parts, and of products in between."""
    matrix, x = system.pattern.matrix(data), system.tessellation.x
    parts: list[tuple[float, ...]] = []
    for _ in range(REPEATS):
        solver, preparation, a = _timed(lambda: TwoLevel(system.pattern, x, TOLERANCE, reference=data))
        _, setup, b = _timed(lambda s=solver: s.factor(data, symmetric=True))
        u, solve, c = _timed(lambda s=solver: s.solve(system.load))
        product = min(_timed(lambda v=u: matrix @ v)[1] for _ in range(3))
        parts.append((preparation, setup, solve, preparation + setup + solve, a + b + c, product))
    values = np.median(parts, axis=0)
    keys = ("preparation_s", "setup_s", "solve_s", "total_s", "wall_s", "product_s")
    row = dict(zip(keys, map(float, values), strict=True))
    row |= {"iterations": solver.iterations, "clusters": solver.clusters, "products": row["total_s"] / row["product_s"]}
    return row | {"per_body_us": 1e6 * row["total_s"] / len(x)}


def _beam_row(name: str, seed: int, size: int, *, memory: bool = True) -> dict[str, Any]:
    case, system = _system(name, seed, size)
    bodies, sound = len(system.tessellation), _secant(system, system.virgin())
    row = {"kind": "size", "case": name, "seed": seed, "bodies": bodies} | _two_level(system, sound)
    solver = TwoLevel(system.pattern, system.tessellation.x, TOLERANCE, reference=sound)
    for share in (0.5, 0.9):
        solver.factor(_cracked(system, case, share), symmetric=True)
        solver.solve(system.load)
        row[f"iterations_{100 * share:.0f}"] = solver.iterations
    row |= _amg(system, sound, row)
    names = ["two-level", "amg"]
    if bodies <= DIRECT_UP_TO:
        row |= _direct(system, sound, row)
        names.append("direct")
    return row | (_memory(system, names) if memory else {})


def _cracked(system: System, case: Case, share: float) -> FloatArray:
    """Entries of the secant stiffness with a crack from the notch through a share of the ligament."""
    notch, x = case.notch[0], system.tessellation.x
    bodies = system.tessellation.contacts.bodies[system.damageable]
    sides = x[bodies, 0] < notch.position
    below = x[bodies, 1].mean(axis=1) < notch.depth + share * (case.specimen.size[1] - notch.depth)
    history = system.virgin().copy()
    history[(sides[:, 0] != sides[:, 1]) & below & (share > 0.0), 0] = 0.99
    return _secant(system, history)


def _amg(system: System, data: FloatArray, two_level: dict[str, Any]) -> dict[str, Any]:
    solver = SmoothedAggregation(system.pattern, system.tessellation.x, TOLERANCE)
    _, setup, _ = _timed(lambda: solver.factor(data, symmetric=True))
    _, solve, _ = _timed(lambda: solver.solve(system.load))
    row = {"amg_iterations": solver.iterations, "amg_setup_s": setup, "amg_solve_s": solve}
    return row | _ratios("amg", setup, solve, two_level)


def _direct(system: System, data: FloatArray, two_level: dict[str, Any]) -> dict[str, Any]:
    direct = best_solver()(system.pattern)
    _, first, _ = _timed(lambda: direct.factor(data, symmetric=True))
    _, factor, wall = _timed(lambda: direct.factor(data, symmetric=True))
    _, solve, _ = _timed(lambda: direct.solve(system.load))
    row = {"direct_preparation_s": first - factor, "direct_factor_s": factor, "direct_solve_s": solve}
    return row | {"direct_wall_s": wall} | _ratios("direct", factor, solve, two_level)


def _ratios(name: str, setup: float, solve: float, two_level: dict[str, Any]) -> dict[str, float]:
    a, b = two_level["setup_s"], two_level["solve_s"]
    return {f"{name}_ratio": (setup + solve) / (a + b), f"{name}_ratio_two": (setup + 2 * solve) / (a + 2 * b)}


def _memory(system: System, names: list[str]) -> dict[str, float]:
    """Peak memory of solvers in processes of their own [kB per body]."""
    _, small = _system("beam_d100", 1, 500)
    bodies, out = len(system.tessellation), {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "matrix.pickle"
        problems = [(s.pattern, s.tessellation.x, _secant(s, s.virgin()), s.load) for s in (small, system)]
        with path.open("wb") as file:
            pickle.dump(problems, file, protocol=5)
        for name in names:
            command = [sys.executable, str(ROOT / "benchmarks" / "solver_memory.py"), str(path), name]
            # Freed memory goes back to the system, so that none of it hides in the baseline.
            environment = {**os.environ, "MALLOC_MMAP_THRESHOLD_": "65536"}
            found = json.loads(subprocess.run(command, check=True, capture_output=True, env=environment).stdout)
            out[f"memory_{name}"] = found["beyond"] / bodies / 1e3
            out["memory_matrix"] = found["matrix"] / bodies / 1e3
    return out


def _bar_row(seed: int, size: int) -> dict[str, Any]:
    _, system = _system("tension_bar", seed, size)
    row = {"kind": "bar", "bodies": len(system.tessellation), "held": len(system.pattern.low_rank.bodies)}
    return row | _two_level(system, _secant(system, system.virgin()))


def _team_rows(name: str, seed: int, size: int) -> list[dict[str, Any]]:
    """Medians of times with one domain and with several, worked on by different numbers of threads."""
    _, system = _system(name, seed, size)
    data, x = _secant(system, system.virgin()), system.tessellation.x
    rows: list[dict[str, Any]] = []
    for domains, threads in TEAMS:
        times: list[tuple[float, ...]] = []
        workers = KernelThreads(threads)
        for _ in range(REPEATS):
            clocks = (time.process_time, time.thread_time, time.perf_counter)
            begin = [clock() for clock in clocks]
            solver = TwoLevel(system.pattern, x, TOLERANCE, reference=data, threads=workers, domains=domains)
            solver.factor(data, symmetric=True)
            u = solver.solve(system.load)
            times.append(tuple(1e6 * (clock() - b) / len(x) for clock, b in zip(clocks, begin, strict=True)))
        total, busiest, wall = np.median(times, axis=0)
        row = {"kind": "threads", "bodies": len(x), "domains": domains, "threads": threads, "hash": hash(u.tobytes())}
        row |= {"tail": 100 * solver.tail, "iterations": solver.iterations, "total": total, "busiest": busiest}
        rows.append(row | {"clock": wall})
    return rows


def _crack_row(name: str, seed: int) -> dict[str, Any]:
    """Iterations against crack length: two-level, the same with clusters that reach across the crack, and amg."""
    case, system = _system(name, seed, CRACKED)
    sound = _secant(system, system.virgin())
    whole = np.full_like(sound, 0.0)  # against nothing, every contact counts as intact
    x = system.tessellation.x
    solvers = {
        "two_level": TwoLevel(system.pattern, x, TOLERANCE, reference=sound),
        "bridging": TwoLevel(system.pattern, x, TOLERANCE, reference=whole),
        "amg": SmoothedAggregation(system.pattern, x, TOLERANCE),
    }
    row: dict[str, Any] = {"kind": "crack", "bodies": len(x), "share": list(CRACKS)}
    for key, solver in solvers.items():
        row[key] = []
        for share in CRACKS:
            solver.factor(_cracked(system, case, share), symmetric=True)
            solver.solve(system.load)
            row[key].append(solver.iterations)
    return row


#: Columns of the tables: key, head, format.
COLUMNS = [
    ("bodies", "bodies", ".0f"),
    ("iterations", "iterations", ".0f"),
    ("iterations_50", "50 %", ".0f"),
    ("iterations_90", "90 %", ".0f"),
    ("preparation_us", "preparation [µs]", ".1f"),
    ("setup_us", "setup [µs]", ".1f"),
    ("solve_us", "solve [µs]", ".1f"),
    ("per_body_us", "together [µs]", ".1f"),
    ("wall_us", "wall [µs]", ".1f"),
    ("product_us", "product [µs]", ".2f"),
    ("products", "products", ".0f"),
]
RATIOS = [
    ("bodies", "bodies", ".0f"),
    ("direct_ratio", "direct / two-level, one solve", ".1f"),
    ("direct_ratio_two", "two solves", ".1f"),
    ("direct_preparation_s", "direct: preparation [s]", ".2f"),
    ("direct_factor_s", "factor [s]", ".3f"),
    ("direct_solve_s", "solve [s]", ".3f"),
    ("amg_ratio", "amg / two-level, one solve", ".1f"),
    ("amg_iterations", "amg: iterations", ".0f"),
    ("amg_setup_s", "setup [s]", ".2f"),
    ("amg_solve_s", "solve [s]", ".2f"),
]
MEMORIES = [
    ("bodies", "bodies", ".0f"),
    ("memory_matrix", "matrix", ".1f"),
    ("memory_two-level", "two-level", ".1f"),
    ("memory_direct", "direct", ".1f"),
    ("memory_amg", "amg", ".1f"),
]
TEAM_COLUMNS = [
    COLUMNS[0],
    ("domains", "domains", ".0f"),
    ("tail", "tail [%]", ".1f"),
    ("threads", "threads", ".0f"),
    COLUMNS[1],
    ("total", "all threads [µs]", ".1f"),
    ("busiest", "busiest thread [µs]", ".1f"),
    ("clock", "wall [µs]", ".1f"),
]
HELD = [COLUMNS[0], ("held", "held", ".0f"), COLUMNS[1], *COLUMNS[4:]]


def _lines(rows: list[dict[str, Any]], columns: list[tuple[str, str, str]]) -> str:
    for row in rows:
        row |= {f"{key}_us": 1e6 * row[f"{key}_s"] / row["bodies"] for key in ("preparation", "setup", "solve")}
        row |= {f"{key}_us": 1e6 * row[f"{key}_s"] / row["bodies"] for key in ("wall", "product")}
    return _cells(rows, columns)


def _cells(rows: list[dict[str, Any]], columns: list[tuple[str, str, str]]) -> str:
    cells = [[f"{row[key]:{form}}" if key in row else "–" for key, _, form in columns] for row in rows]
    return table([head for _, head, _ in columns], cells)


def _markdown(rows: list[dict[str, Any]]) -> str:
    beams, bars, teams = ([row for row in rows if row["kind"] == kind] for kind in ("size", "bar", "threads"))
    parts = ["## Linear solvers", TEXT, _lines(beams, COLUMNS), "### Direct solver and smoothed aggregation", COMPARED]
    parts += [_lines(beams, RATIOS), _crossing(beams), "### Memory", REMEMBERED, _lines(beams, MEMORIES)]
    parts += ["### Whole faces held", FACES, _lines(bars, HELD), "### Threads", THREADS, _cells(teams, TEAM_COLUMNS)]
    return "\n\n".join(part.strip() for part in parts)


def _crossing(rows: list[dict[str, Any]]) -> str:
    compared = sorted((row["bodies"], row["direct_ratio"]) for row in rows if "direct_ratio" in row)
    slower = [bodies for bodies, ratio in compared if ratio < 1.0]
    faster = [bodies for bodies, ratio in compared if ratio >= 1.0 and bodies > max(slower, default=0)]
    if not faster:
        return "Direct solution is faster at all sizes that were compared."
    if not slower:
        return f"Two-level is faster than direct from the smallest size on, {faster[0]} bodies."
    return f"Direct and two-level cross between {max(slower)} and {faster[0]} bodies."


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    beams = [row for row in rows if row["kind"] == "size"]

    def near(size: int) -> list[dict[str, Any]]:
        return [row for row in beams if 0.7 * size < row["bodies"] < 1.4 * size]

    growth = median(r["per_body_us"] for r in near(100_000)) / median(r["per_body_us"] for r in near(10_000))
    memory = max(row["memory_two-level"] + row["memory_matrix"] for row in beams if row["bodies"] > AUTO)
    return [
        Check("cost per body, 100 000 bodies over 10 000", growth, GROWTH),
        *_team_checks([row for row in rows if row["kind"] == "threads"]),
        Check("direct over two-level at 30 000", min(r["direct_ratio"] for r in near(30_000)), OVER_DIRECT, True),
        Check("amg over two-level", min(row["amg_ratio"] for row in beams), OVER_AMG, True),
        Check(
            f"products from {AUTO} bodies on",
            max(r["products"] for r in rows if r["kind"] != "threads" and r["bodies"] > AUTO),
            PRODUCTS,
        ),
        Check("peak memory with the matrix, kB per body", memory, MEMORY),
    ]


def _team_checks(rows: list[dict[str, Any]]) -> list[Check]:
    """For the largest beam: what threads cost in all, what two of them save, and that they change nothing."""
    largest = [row for row in rows if row["bodies"] == max(row["bodies"] for row in rows)]
    alone = next(row for row in largest if row["domains"] == 1)
    two = next(row for row in largest if row["threads"] == 2)
    different = len({row["hash"] for row in largest if row["domains"] > 1}) - 1
    return [
        Check("all threads over one alone, processor time", two["total"] / alone["total"], 1.1),
        Check("one alone over the busiest of two", alone["total"] / two["busiest"], 1.5, at_least=True),
        Check("solutions that depend on the number of threads", different, 0),
    ]


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1])))
