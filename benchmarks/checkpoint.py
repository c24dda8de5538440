"""What it costs to save a run so that it can be resumed: time, and size of the checkpoint for each body.

Runs write all their files, with checkpoints as often as by default. Counted are the checkpoints, the one at the end
among them, and what is noted for them after every step.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import fissura
from common import Check, Report, example, main, options, say, table
from fissura.running.saving import CheckpointWriter

#: Cases, each adaptive and at full resolution.
CASES = ("beam_d100", "beam_d200", "beam_d400")
MOST_SHARE, MOST_BYTES = 1.0, 1000.0

TEXT = """\
*Share* is the time that checkpoints take of all the time of a run, on the clock, its pictures included; *largest* the
largest checkpoint; *apart* is the part of it that goes with steps and not with bodies: the curve.
"""


def produce(found: argparse.Namespace) -> Report:
    rows = []
    for name in found.cases:
        for full in (False, True):
            say(f"{name}, {'full' if full else 'adaptive'}")
            rows.append(_row(name, full))
            say(f"  {rows[-1]}")
    heads = [
        "case",
        "bodies",
        "steps",
        "time [s]",
        "checkpoints",
        "share [%]",
        "largest [kB]",
        "apart [kB]",
        "B a body",
    ]
    lines = [
        [
            f"`{row['case']}`, {'full' if row['full'] else 'adaptive'}",
            *(str(row[key]) for key in ("bodies", "steps")),
            f"{row['wall_s']:.0f}",
            str(row["checkpoints"]),
            f"{row['share']:.2f}",
            *(f"{row[key] / 1e3:.0f}" for key in ("bytes", "curve_bytes")),
            f"{row['per_body']:.0f}",
        ]
        for row in rows
    ]
    text = "\n".join(["## Checkpoints", TEXT, table(heads, lines)])
    checks = [
        Check("share of the time, largest [%]", max(row["share"] for row in rows), MOST_SHARE),
        Check("bytes for each body, most", max(row["per_body"] for row in rows), MOST_BYTES),
    ]
    return Report("checkpoint", rows, text, checks)


def _row(name: str, full: bool) -> dict[str, Any]:
    spent, sizes = [0.0], [0]
    write, add = CheckpointWriter.write, CheckpointWriter.add

    def timed(call: Callable[..., None]) -> Callable[..., None]:
        def run(*rest: Any, **more: Any) -> None:
            began = time.perf_counter()
            call(*rest, **more)
            spent[0] += time.perf_counter() - began

        return run

    with tempfile.TemporaryDirectory() as folder:

        def measured(writer: CheckpointWriter, *rest: Any, **more: Any) -> None:
            write(writer, *rest, **more)
            sizes.append((Path(folder) / "checkpoint.npz").stat().st_size)

        with (
            patch.object(CheckpointWriter, "write", timed(measured)),
            patch.object(CheckpointWriter, "add", timed(add)),
        ):
            began = time.perf_counter()
            result = fissura.run(example(name, 1), full=full, output=folder)
            wall = time.perf_counter() - began
    curve = sum(values.nbytes for values in result.curve.values())
    return {
        "case": name,
        "full": full,
        "bodies": int(result.summary["bodies_end"]),
        "steps": result.steps,
        "wall_s": wall,
        "checkpoints": len(sizes) - 1,
        "share": 100.0 * spent[0] / wall,
        "bytes": max(sizes),
        "curve_bytes": curve,
        "per_body": (max(sizes) - curve) / result.summary["bodies_end"],
    }


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, CASES, [1])))
