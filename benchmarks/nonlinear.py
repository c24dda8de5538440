"""Nonlinear iteration: robustness and cost over specimens, notches, sizes, resolutions and brittleness; and why so.

The first table runs every case of the set with the package as it is, and one case in other seeds. The second one runs
the set again with one choice changed at a time.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product
from typing import Any
from unittest.mock import patch

import numpy as np

from common import Check, Report, main, measured, middle, options, say, table, worst
from fissura import Case
from fissura.case import case_from_dict
from fissura.equilibrium import StepSolver, limits

#: Fracture energies [J/m^2]: brittle and ductile.
ENERGIES = (8.0, 100.0)
#: Depths of the specimens [mm].
SIZES = (60.0, 100.0)
#: Seeds for the robustness of the set beyond the first one.
MORE_SEEDS = 30
#: The part of the set that takes most of the time: left out where choices are compared.
LARGEST = (", 100, 8, full", ", 100, 100, full")

TEXT = """\
Three specimens (beam with a notch through half of its depth, beam with one through a fifth, prism in tension with a
saw cut) in two sizes (depth in the name), adaptive and full, brittle and ductile (`G_t` in J/m² in the name): steps,
Newton or secant corrections for each accepted step, the most for one step, preconditioner iterations and factorizations
for each accepted step, attempts that were cut, processor time, largest residual of an accepted step. Adaptive runs are
not calibrated: specimens 30 to 50 mm thick hold one or two coarse bodies of 32 mm, and the factor that would give them
the stiffness of full resolution is beyond its limits, in the prism most of all. Such a start is refused unless
`adaptivity.calibrate = false`; this table is about iterations, not about how far loads are from full resolution.
"""

VARIANTS_TEXT = """\
The set, without the larger specimens at full resolution, with one choice changed at a time: runs that did not reach
their end, attempts that were cut, the most corrections for one step, corrections, preconditioner iterations and
factorizations for each accepted step (mean of all runs), and processor time of all runs in units of the package as it
is.
"""


def produce(found: argparse.Namespace) -> Report:
    _row(*next(chosen for chosen in _set() if chosen[0].startswith("prism")))  # compiles what other cases do not need
    rows = []
    for name, case, full in _set():
        rows.append(_row(name, case, full))
        say(f"{name}: {rows[-1]['corrections']:.1f} corrections a step, {rows[-1]['cpu_s']:.1f} s")
    seeds = [_row(f"{name}, seed {seed}", case, full) for seed, (name, case, full) in _more_seeds()]
    base = [row for row in rows if not row["case"].endswith(LARGEST)]
    variants = [_summed("**as it is**", base, base)]
    for text, change in VARIANTS.items():
        with change():
            chosen = [_row(name, case, full) for name, case, full in _set() if not name.endswith(LARGEST)]
        variants.append(_summed(text, chosen, base))
        say(f"{text}: {variants[-1]['cpu']:.2f}, {variants[-1]['failed']} failed")
    checks = [
        Check("cases", len(rows), 12, at_least=True),
        Check("runs of the set that failed", sum(not row["finished"] for row in rows), 0),
        Check("other seeds that failed", sum(not row["finished"] for row in seeds), 0),
        Check("largest residual of an accepted step over the tolerance", worst(rows + seeds, "residual") / 1e-4, 1.0),
    ]
    return Report("nonlinear", [*rows, *seeds, *variants], _markdown(rows, seeds, variants), checks)


def _beam(depth: float, notch: float) -> dict[str, Any]:
    middle_x = 1.75 * depth
    return {
        "specimen": {"size": [_mm(3.5 * depth), _mm(depth), _mm(0.5 * depth)]},
        "notch": {"face": "bottom", "position": _mm(middle_x), "depth": _mm(notch * depth)},
        "supports": [
            {"type": "pin", "face": "bottom", "at": _mm(0.5 * depth)},
            {"type": "roller", "face": "bottom", "at": _mm(3.0 * depth)},
        ],
        "load": {"face": "top", "at": _mm(middle_x)},
        "gauge": {"a": {"face": "bottom", "at": _mm(middle_x - 5)}, "b": {"face": "bottom", "at": _mm(middle_x + 5)}},
    }


def _prism(depth: float) -> dict[str, Any]:
    return {
        "specimen": {"size": [_mm(3.0 * depth), _mm(depth), _mm(0.5 * depth)]},
        "notch": {"face": "bottom", "position": _mm(1.5 * depth), "depth": _mm(0.3 * depth), "width": "2 mm"},
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "right", "direction": [1, 0, 0]},
        "gauge": {
            "a": {"face": "bottom", "at": _mm(1.5 * depth - 5)},
            "b": {"face": "bottom", "at": _mm(1.5 * depth + 5)},
        },
    }


def _mm(value: float) -> str:
    return f"{value:g} mm"


def _set(seed: int = 1) -> Iterator[tuple[str, Case, bool]]:
    specimens: dict[str, Callable[[float], dict[str, Any]]] = {
        "beam 1/2": lambda depth: _beam(depth, 0.5),
        "beam 1/5": lambda depth: _beam(depth, 0.2),
        "prism": _prism,
    }
    for (name, specimen), depth, energy, full in product(specimens.items(), SIZES, ENERGIES, (False, True)):
        ductile = energy > 50.0
        data = specimen(depth) | {
            "seed": seed,
            "material": {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": f"{energy:g} J/m^2"},
            "discretization": {"l_f": "8 mm", "l_c": "32 mm"},
            "adaptivity": {"r_f": "32 mm", "r_c": "48 mm", "calibrate": False},
            "control": {"target": "0.2 mm" if ductile else "0.06 mm"},
            "output": {"vtk": 0},
        }
        kind = "full" if full else "adaptive"
        yield f"{name}, {depth:g}, {energy:g}, {kind}", case_from_dict(data), full


def _more_seeds() -> Iterator[tuple[int, tuple[str, Case, bool]]]:
    """One case of the set after another, each in another seed."""
    for seed in range(2, 2 + MORE_SEEDS):
        chosen = list(_set(seed))
        yield seed, chosen[7 * (seed - 2) % len(chosen)]


def _row(name: str, case: Case, full: bool) -> dict[str, Any]:
    counts = {"corrections": 0, "iterations": 0, "attempts": 0, "failures": 0}
    original = StepSolver.solve

    def counted(self: StepSolver, *rest: Any, **more: Any) -> Any:
        state = original(self, *rest, **more)
        counts["attempts"] += 1
        counts["failures"] += state is None
        counts["iterations"] += self.linear_iterations
        return state

    with patch.object(StepSolver, "solve", counted):
        found = measured(case, full=full)
    curve, steps = found.result.curve, max(found.result.steps, 1)
    return {
        "case": name,
        "finished": found.finished,
        "steps": found.result.steps,
        "corrections": float(np.sum(curve["iterations"])) / steps,
        "most": int(np.max(curve["iterations"])),
        "iterations": counts["iterations"] / steps,
        "factorizations": float(np.sum(curve["factorizations"])) / steps,
        "failures": counts["failures"],
        "cpu_s": found.cpu_s,
        "residual": float(np.max(curve["residual"])),
        "bodies": int(found.result.summary["bodies_end"]),
    }


def _constant(module: Any, **values: Any) -> Callable[[], Any]:
    @contextmanager
    def change() -> Iterator[None]:
        with patch.multiple(module, **values):
            yield

    return change


#: What to change, by the text of the table's row.
VARIANTS: dict[str, Callable[[], Any]] = {
    "linear equations exact (1e-6)": _constant(limits, LEAST_EXACT=1e-6, MOST_EXACT=1e-6),
    "linear equations to 0.01": _constant(limits, LEAST_EXACT=1e-2),
    "linear equations to 0.3": _constant(limits, LEAST_EXACT=0.3),
    "preparation for every correction": _constant(limits, PREPARATION=-1),
    "preparation after 5 iterations too many": _constant(limits, PREPARATION=5),
    "preparation after 80 iterations too many": _constant(limits, PREPARATION=80),
    "no line search": _constant(limits, SMALLEST_CUT=1.0),
    "after Newton: secant": _constant(limits, SHARES_OF_TANGENT=(0.0,)),
    "after Newton: 0.5 tangent": _constant(limits, SHARES_OF_TANGENT=(0.5,)),
    "after Newton: 0.9 tangent": _constant(limits, SHARES_OF_TANGENT=(0.9,)),
    "never Newton: secant": _constant(limits, SHARES_OF_TANGENT=(0.0,), STALLS=0),
    "never Newton: 0.9 tangent and less": _constant(limits, STALLS=0),
}


def _summed(text: str, chosen: list[dict[str, Any]], rows: list[dict[str, Any]]) -> dict[str, Any]:
    mean = {
        key: float(np.mean([row[key] for row in chosen])) for key in ("corrections", "iterations", "factorizations")
    }
    cpu = sum(row["cpu_s"] for row in chosen) / sum(row["cpu_s"] for row in rows)
    counts = {"failed": sum(not row["finished"] for row in chosen), "cut": sum(row["failures"] for row in chosen)}
    return {"case": text, "cpu": cpu, "most": max(row["most"] for row in chosen)} | counts | mean


COLUMNS = [
    ("bodies", "bodies", "d"),
    ("steps", "steps", "d"),
    ("corrections", "corrections", ".1f"),
    ("most", "most", "d"),
    ("iterations", "iterations", ".1f"),
    ("factorizations", "factorizations", ".2f"),
    ("failures", "cut", "d"),
    ("cpu_s", "CPU [s]", ".1f"),
    ("residual", "residual", ".1e"),
]


def _markdown(rows: list[dict[str, Any]], seeds: list[dict[str, Any]], variants: list[dict[str, Any]]) -> str:
    heads = ["case", *(head for _, head, _ in COLUMNS)]
    lines = [[_name(row), *(f"{row[key]:{form}}" for key, _, form in COLUMNS)] for row in rows]
    failed = sum(not row["finished"] for row in seeds)
    more = (
        f"{len(seeds)} more runs, cases of the set in other seeds: {failed} failed; corrections a step"
        f" {middle(seeds, 'corrections'):.1f} (median), {worst(seeds, 'most'):.0f} at most for one step."
    )
    means = ("corrections", "iterations", "factorizations", "cpu")
    changed = [
        [v["case"], *(f"{v[key]}" for key in ("failed", "cut", "most")), *(f"{v[key]:.2f}" for key in means)]
        for v in variants
    ]
    columns = ["choice", "failed", "cut", "most", "corrections", "iterations", "factorizations", "CPU"]
    parts = ["## Nonlinear iteration", TEXT, table(heads, lines), "", more, "", VARIANTS_TEXT, table(columns, changed)]
    return "\n".join(parts)


def _name(row: dict[str, Any]) -> str:
    return row["case"] if row["finished"] else f"{row['case']} (stopped early)"


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [1])))
