"""Adaptive against full resolution of the same specimen: how far apart, and how much cheaper.

Both runs of a seed follow each other in one process, so that a busy machine slows both.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

from common import Check, Report, difference, example, main, measured, middle, options, say, table, worst

#: Smallest median ratio of processor times by case.
FASTER = {"beam_d100": 3.0, "beam_d200": 8.0}
#: Largest differences for every seed [per cent].
LIMITS = {"load_difference": 1.0, "peak_difference": 0.5, "energy_difference": 1.0}
#: Largest mean number of factorizations per accepted step at full resolution.
FACTORIZATIONS = {"beam_d100": 7.0}

#: Columns of the tables: key, head, format.
DIFFERENCES = [
    ("load_difference", "load, largest [%]", ".2f"),
    ("peak_difference", "peak [%]", "+.2f"),
    ("energy_difference", "energy [%]", "+.2f"),
    ("stiffness_difference", "stiffness [%]", "+.2f"),
    ("max_elastic_utilisation", "elastic utilisation", ".2f"),
    ("energy_balance_adaptive", "energy balance, adaptive [%]", "+.2f"),
    ("energy_balance_full", "energy balance, full [%]", "+.2f"),
]
COST = [
    ("bodies_start", "bodies at start", ".0f"),
    ("bodies_end", "at end", ".0f"),
    ("bodies_full", "full", ".0f"),
    ("factorizations_per_step_full", "factorizations per step, full", ".1f"),
    ("cpu_adaptive_s", "processor time, adaptive [s]", ".1f"),
    ("cpu_full_s", "full [s]", ".1f"),
    ("cpu_ratio", "ratio", ".1f"),
    ("wall_adaptive_s", "wall time, adaptive [s]", ".1f"),
    ("wall_full_s", "full [s]", ".1f"),
]

TEXT = """\
*Elastic utilisation* is the largest traction over strength that any contact without a damage law ever carried. *Energy
balance* is (work − stored − dissipated) / work at the end. *Worst* is the largest size; for the ratio the smallest.
"""


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name in found.cases:
        for seed in found.seeds:
            say(f"{name}, seed {seed}: adaptive")
            adaptive = measured(example(name, seed))
            say(f"  {adaptive.cpu_s:.1f} s; full")
            full = measured(example(name, seed), full=True)
            rows.append({"case": name, "seed": seed, **difference(adaptive, full)})
            say(f"  {full.cpu_s:.1f} s; load {rows[-1]['load_difference']:.2f} % apart")
    return Report("same_specimen", rows, _markdown(rows), _checks(rows))


def _markdown(rows: list[dict[str, Any]]) -> str:
    parts = ["## The same specimen, adaptive and at full resolution", TEXT]
    for name in dict.fromkeys(row["case"] for row in rows):
        of_case = [row for row in rows if row["case"] == name]
        parts += [f"### `{name}`\n", _table(of_case, DIFFERENCES), "", _table(of_case, COST), ""]
    return "\n".join(parts)


def _table(rows: list[dict[str, Any]], columns: list[tuple[str, str, str]]) -> str:
    lines = [[_seed(row), *(format(row[key], form) for key, _, form in columns)] for row in rows]
    lines.append(["**median**", *(format(middle(rows, key), form) for key, _, form in columns)])
    lines.append(["**worst**", *(_worst(rows, key, form) for key, _, form in columns)])
    return table(["seed", *(head for _, head, _ in columns)], lines)


def _seed(row: dict[str, Any]) -> str:
    return f"{row['seed']}" if row["finished"] else f"{row['seed']} (stopped early)"


def _worst(rows: list[dict[str, Any]], key: str, form: str) -> str:
    smallest = key == "cpu_ratio"
    return format(min(row[key] for row in rows) if smallest else worst(rows, key), form.lstrip("+"))


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    checks = [Check("runs that stopped early", sum(not row["finished"] for row in rows), 0)]
    for name in dict.fromkeys(row["case"] for row in rows):
        of_case = [row for row in rows if row["case"] == name]
        for key, limit in LIMITS.items():
            for row in of_case:
                checks.append(Check(f"{name}, seed {row['seed']}, {key} [%]", abs(row[key]), limit))
        if name in FASTER:
            checks.append(Check(f"{name}, median cpu_ratio", middle(of_case, "cpu_ratio"), FASTER[name], at_least=True))
        if name in FACTORIZATIONS:
            mean = sum(row["factorizations_per_step_full"] for row in of_case) / len(of_case)
            checks.append(Check(f"{name}, mean factorizations per step, full", mean, FACTORIZATIONS[name]))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100", "beam_d200"], [1, 2, 3, 4, 5])))
