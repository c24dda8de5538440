"""What vector instructions and hints to load blocks gain: the two-level solver with them and without.

Two processes, one with FISSURA_SIMD=0, hold the same beam at full resolution and take turns: setup and one solution,
in processor time. Beside the medians of both stands the median of the ratios of neighbours in time, which drifts of a
shared machine do not move.

    python benchmarks/simd.py [--repeats 11] [--bodies 2000 24000]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from statistics import median
from typing import Any

CASE = "beam_d400"


def _worker(bodies: int) -> None:
    """Solve whenever a line comes in, and tell how long it took."""
    from fissura.linear.two_level import TwoLevel
    from linear_solvers import _cracked, _secant, _system

    case, system = _system(CASE, 1, bodies)
    sound = _secant(system, system.virgin())
    solver = TwoLevel(system.pattern, system.tessellation.x, reference=sound)
    data = _cracked(system, case, 0.5)
    for _ in sys.stdin:
        begun = time.process_time()
        solver.factor(data, symmetric=True)
        middle = time.process_time()
        solver.solve(system.load)
        row = {"bodies": len(system.tessellation), "setup": middle - begun, "solve": time.process_time() - middle}
        print("row", json.dumps(row | {"iterations": solver.iterations}), flush=True)


def _started(bodies: int, folder: str, *, plain: bool) -> subprocess.Popen[str]:
    environment = {**os.environ, "FISSURA_SIMD": "0" if plain else "1", "NUMBA_CACHE_DIR": folder}
    command = [sys.executable, __file__, "--worker", str(bodies)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)


def _asked(worker: subprocess.Popen[str]) -> dict[str, Any]:
    assert worker.stdin is not None
    assert worker.stdout is not None
    worker.stdin.write("\n")
    worker.stdin.flush()
    line = next(line for line in worker.stdout if line.startswith("row"))
    return dict(json.loads(line.removeprefix("row")))


def _compared(bodies: int, repeats: int, folders: tuple[str, str]) -> None:
    workers = [_started(bodies, folder, plain=plain) for folder, plain in zip(folders, (False, True), strict=True)]
    for worker in workers:
        _asked(worker)  # compiled kernels are not measured
    pairs = [tuple(_asked(worker) for worker in workers) for _ in range(repeats)]
    for worker in workers:
        worker.communicate()
    print(f"{pairs[0][0]['bodies']} bodies, {repeats} turns; iterations {pairs[0][0]['iterations']}", flush=True)
    for part in ("setup", "solve", "both"):
        found = [[row["setup"] + row["solve"] if part == "both" else row[part] for row in pair] for pair in pairs]
        simd, plain = (median(column) for column in zip(*found, strict=True))
        ratio = median(b / a for a, b in found)
        print(f"  {part}: {simd:.4f} s, plain {plain:.4f} s; plain takes {ratio:.2f} times as long", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=11)
    parser.add_argument("--bodies", type=int, nargs="*", default=[2000, 24_000])
    parser.add_argument("--worker", type=int, help=argparse.SUPPRESS)
    found = parser.parse_args()
    if found.worker:
        _worker(found.worker)
        return
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        for bodies in found.bodies:
            _compared(bodies, found.repeats, (one, other))


if __name__ == "__main__":
    main()
