"""Peaks of runs with far too distant targets, against short steps: whether a run finds its peak whatever its steps.

Steps are at most a fiftieth of the target. Each specimen runs to 60 % of its peak with targets of 0.1 mm to 100 mm, and
once with short steps for comparison. Where damage jumps before the peak, a run says that its peak may depend on steps.
"""

from __future__ import annotations

import argparse
import sys
from itertools import product
from typing import Any

from common import Check, Report, changed, example, main, measured, options, say, table, worst

#: Targets, and the longest steps of the comparison [m].
TARGETS, SHORT = (1e-4, 1e-3, 1e-2, 1e-1), 5e-7
#: Largest difference of a peak without a warning [per cent], and cases for which that holds.
LIMIT, FIRM = 1.0, ("beam_d100", "beam_d200", "random_notched")

TEXT = """\
Peak against that of a run with steps of at most 0.5 µm, in per cent: median (largest size) over the seeds, and how
many of the runs warn that damage jumped before their peak. Beside it the steps to 60 % of the peak.
"""


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name, seed in product(found.cases, found.seeds):
        say(f"{name}, seed {seed}")
        case = changed(example(name, seed), control={"stop_load": 0.6, "max_step": SHORT, "first_step": SHORT})
        expected = measured(case).result.peak_load
        for target in TARGETS:
            control = {"stop_load": 0.6, "target": target, "max_step": target / 50, "first_step": target / 200}
            run = measured(changed(example(name, seed), control={**control, "min_step": target / 1e5}))
            warned = any(text.startswith("control.max_step") for text in run.result.summary["warnings"])
            row = {"case": name, "seed": seed, "target": target, "steps": run.result.steps, "warned": warned}
            rows.append(row | {"peak": run.result.peak_load, "difference": 100 * (run.result.peak_load / expected - 1)})
    return Report("step_length", rows, _markdown(rows), _checks(rows))


def _markdown(rows: list[dict[str, Any]]) -> str:
    heads = ["", *(f"target {1e3 * target:g} mm" for target in TARGETS)]
    lines = []
    for name in dict.fromkeys(row["case"] for row in rows):
        chosen = [[row for row in rows if (row["case"], row["target"]) == (name, target)] for target in TARGETS]
        differences = [sorted(row["difference"] for row in some) for some in chosen]
        lines.append(
            [
                f"`{name}`",
                *(
                    f"{each[len(each) // 2]:+.2f} ({worst(some, 'difference'):.2f}), "
                    f"{sum(row['warned'] for row in some)} of {len(some)} warn, "
                    f"{min(row['steps'] for row in some)} to {max(row['steps'] for row in some)} steps"
                    for each, some in zip(differences, chosen, strict=True)
                ),
            ]
        )
    return "\n".join(["## Length of steps", TEXT, table(heads, lines)])


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    silent = [row for row in rows if not row["warned"]]
    firm = [row for row in rows if row["case"] in FIRM]
    return [
        Check(
            "largest difference of a peak without a warning [%]", worst(silent, "difference") if silent else 0, LIMIT
        ),
        *([Check(f"largest difference in {', '.join(FIRM)} [%]", worst(firm, "difference"), LIMIT)] if firm else []),
    ]


if __name__ == "__main__":
    cases = ["beam_d100", "beam_d200", "random_notched", "random_unnotched", "unnotched_beam"]
    sys.exit(main(produce, options(__doc__, cases, [1, 2, 3, 4, 5])))
