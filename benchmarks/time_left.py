"""How far off the time left is that runs tell: recorded runs are replayed.

Cases are run once, with `--record`: after each step the processor time and the share that is done are kept in
benchmarks/time_left.json, times scaled so that each run takes 60 s. The replay shows for each run the largest ratio of
told and true time left, either way round, after a tenth of the run, and for how much of the rest a time is told. Times
below a tenth of what has gone by are told as "almost done", and count as a tenth.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

from common import ROOT, table
from fissura import load_case, run
from fissura.progress.time_left import TimeLeft
from fissura.results.done import Done

#: Recorded runs; those of the second group were not used to choose the constants.
FITTED = (
    "gregoire_d50_halfnotch", "beam_d100", "beam_d100 full", "beam_d200", "beam_d200 full", "beam_d100_cycles",
    "nooru_mohamed", "four_point_shear", "compression_glued", "tension_hinged", "winkler_lpanel", "random_notched",
)  # fmt: skip
OTHERS = ("unnotched_beam", "random_unnotched", "beam_350", "long_beam_weight", "four_point_bending", "tension_fixed")
RECORDS = Path(__file__).with_suffix(".json")
#: Wall time of a run as it is replayed [s], largest ratio, and least time that is told apart [s].
SPAN, LIMIT, LEAST = 60.0, 3.0, 1.0

Record = list[tuple[float, float]]


def replayed(record: Record) -> tuple[float, float]:
    """Largest ratio after a tenth of a run, and the share of the rest of its time for which a time is told."""
    left, end = TimeLeft(), record[-1][0]
    worst, told, before = 1.0, 0.0, record[0][0]
    for now, share in record:
        found = left.after(now, share)
        if now >= 0.1 * end and found is not None:
            least = max(LEAST, 0.1 * now)
            a, b = max(found, least), max(end - now, least)
            worst, told = max(worst, a / b, b / a), told + now - before
        before = now
    return worst, told / (0.9 * end)


def recorded(name: str) -> Record:
    """Run a case, and note when it was how far."""
    file, _, full = name.partition(" ")
    case, rows = load_case(ROOT / "examples" / f"{file}.toml"), []
    done, begin = Done(case), [0.0]
    run(
        case,
        full=bool(full),
        on_start=lambda _: begin.__setitem__(0, time.process_time()),
        on_step=lambda step: rows.append((time.process_time() - begin[0], done.after(step.done, step.load))),
    )
    return [(round(SPAN * now / rows[-1][0], 3), round(share, 5)) for now, share in rows]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--record", action="store_true", help="Run all cases again.")
    if parser.parse_args().record:
        RECORDS.write_text(json.dumps({name: recorded(name) for name in FITTED + OTHERS}), encoding="utf-8")
    records = json.loads(RECORDS.read_text(encoding="utf-8"))
    rows = [[name, *replayed(record), name in FITTED] for name, record in records.items()]
    head = ["run", "largest ratio", "told for [%]", "fitted"]
    print(table(head, [[n, f"{worst:.2f}", f"{100 * told:.0f}", "yes" if f else "no"] for n, worst, told, f in rows]))
    return int(max(row[1] for row in rows) > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
