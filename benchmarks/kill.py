"""Runs that are killed at random moments and resumed each time, against runs that were left alone.

Every process is ended by SIGKILL at a moment that is uniform over a third of the time that an undisturbed run takes
after its specimen was built (over all of it until there is a checkpoint), if it has not ended by then: while it writes
its first files, between and within steps, refinements and checkpoints, and while the last files are written. Files are
compared byte by byte, times left out.
"""

from __future__ import annotations

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fissura
from common import ROOT, Check, Report, changed, load_case, main, options, say, table

sys.path.insert(0, str(ROOT / "tests"))
from sameness import assert_same

#: Cases by name: an example, and what is changed in it so that each has something else to be remembered.
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "refining": ("beam_d100", {"discretization": {"l_f": 0.006, "l_c": 0.024}, "adaptivity": {"r_f": 0.018}}),
    "coarsening": (
        "beam_d100",
        {
            "discretization": {"l_f": 0.0065, "l_c": 0.026},
            "adaptivity": {"r_f": 0.04, "r_c": 0.06, "coarsen": True, "gamma_coarse": 0.7},
            "material": {"G_t": 4.0},
            "control": {"stop_load": 0.1},
        },
    ),
    "led by energy": ("random_unnotched", {"discretization": {"l_f": 0.008, "l_c": 0.032}}),
}
#: Seconds between checkpoints, processes to kill, and how many of one run at most.
EVERY = 0.05
KILLS = 100
MOST = 12

TEXT = """\
{kills} processes were killed at random moments, and resumed each time. *Same* are the runs that had the curve, the last
state, the sections, the states for ParaView and the summary of a run that was left alone, byte by byte but for times.
"""


def child(name: str, seed: int, folder: str) -> None:
    """Run a case, or go on with it if there is a checkpoint, and say when the specimen is built."""
    from fissura.running import saving

    saving._SHARE = 1.0  # checkpoints as often as asked for, whatever they cost
    example, changes = CASES[name]
    case = changed(load_case(ROOT / "examples" / f"{example}.toml"), seed=seed, **changes)
    case = changed(case, output={"vtk": 2, "measured": None, "checkpoint": EVERY})
    resume = (Path(folder) / "checkpoint.npz").exists()
    fissura.run(case, output=folder, resume=resume, overwrite=not resume, on_start=lambda _: print("begun", flush=True))


def started(name: str, seed: int, folder: Path) -> subprocess.Popen[str]:
    """A process that runs a case; its specimen is built."""
    command = [sys.executable, str(Path(__file__).resolve()), "--child", json.dumps([name, seed, str(folder)])]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert run.stdout is not None
    run.stdout.readline()
    return run


def finished(run: subprocess.Popen[str]) -> None:
    _, told = run.communicate()
    if run.returncode:
        raise RuntimeError(told)


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    moments = random.Random(1)
    with tempfile.TemporaryDirectory() as top:
        for k, (name, seed) in enumerate(_specimens(found.cases)):
            done = sum(row["kills"] for row in rows)
            if done >= found.kills:
                break
            rows.append(_row(name, seed, Path(top) / str(k), moments, min(MOST, found.kills - done)))
            say(f"{name}, seed {seed}: {rows[-1]}")
    kills, same = (sum(row[key] for row in rows) for key in ("kills", "same"))
    lines = []
    for name in found.cases:
        own = [row for row in rows if row["case"] == name]
        numbers = [len(own), *(sum(row[key] for row in own) for key in ("kills", "before", "same"))]
        lines.append([name, *map(str, numbers)])
    heads = ["case", "runs", "kills", "before the first checkpoint", "same"]
    text = "\n".join(["## Runs that are killed", TEXT.format(kills=kills), table(heads, lines)])
    return Report("kill", rows, text, [Check("runs that differ", len(rows) - same, 0)])


def _specimens(names: list[str]) -> Iterator[tuple[str, int]]:
    seed = 0
    while True:
        seed += 1
        yield from ((name, seed) for name in names)


def _row(name: str, seed: int, folder: Path, moments: random.Random, most: int) -> dict[str, Any]:
    """One run, killed until it happens to reach its end, or often enough."""
    run = started(name, seed, folder / "alone")
    began = time.monotonic()
    finished(run)
    takes, kills, before = time.monotonic() - began, 0, 0
    while True:
        within = takes / 3.0 if (folder / "killed" / "checkpoint.npz").exists() else takes
        run = started(name, seed, folder / "killed")
        try:
            run.wait(moments.uniform(0.0, within) if kills < most else None)
        except subprocess.TimeoutExpired:
            run.send_signal(signal.SIGKILL)
            run.communicate()
            kills, before = kills + 1, before + (not (folder / "killed" / "checkpoint.npz").exists())
        else:
            finished(run)
            break
    try:
        assert_same(folder / "killed", folder / "alone")
        same = True
    except AssertionError as error:
        say(str(error))
        same = False
    return {"case": name, "seed": seed, "takes_s": takes, "kills": kills, "before": before, "same": int(same)}


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--kills", type=int, default=KILLS, metavar="N", help="processes to kill")


if __name__ == "__main__":
    if "--child" in sys.argv:
        child(*json.loads(sys.argv[-1]))
        sys.exit()
    sys.exit(main(produce, options(__doc__, list(CASES), [1], more=_more)))
