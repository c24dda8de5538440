"""Peak memory of one linear solution, in a process of its own that holds the matrix and nothing else of that size.

Called by `linear_solvers.py` with a file of two pickled problems (pattern, nuclei, entries, right-hand side), a small
and a large one, and the name of a solver. Prints JSON. The kernel counts the pages that the process touches (`VmHWM` in
/proc/self/status), so that native allocations of libraries are part of it.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import json
import pickle
import sys
import time
from pathlib import Path

import numpy as np

from fissura.case.registry import SOLVERS

#: Relative error of iterative solutions in the energy norm.
TOLERANCE = 1e-6


def _resident(key: str) -> int:
    """A line of /proc/self/status [bytes]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(key)).split()[1])


def _reset_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5")


def main(path: str, name: str) -> int:
    with open(path, "rb") as file:
        small, large = pickle.load(file)
    _solve(name, *small)  # compiled kernels and libraries are there before anything is counted
    del small
    form = large[0]
    rows = form.indptr.nbytes + form.indices.nbytes  # made when asked for: here, so that no solver is charged for them
    gc.collect()
    ctypes.CDLL("libc.so.6").malloc_trim(0)
    _reset_peak()
    before = _resident("VmRSS")
    cpu, wall = time.process_time(), time.perf_counter()
    found = _solve(name, *large)
    out = {
        "beyond": _resident("VmHWM") - before,
        "matrix": sum(part.nbytes for part in vars(form).values() if isinstance(part, np.ndarray))
        + rows
        + large[2].nbytes,
        "cpu_s": time.process_time() - cpu,
        "wall_s": time.perf_counter() - wall,
        "norm": float(np.linalg.norm(found)),
    }
    print(json.dumps(out))
    return 0


def _solve(name, form, x, data, right):  # type: ignore[no-untyped-def]
    solver = SOLVERS[name](form, x, TOLERANCE)
    solver.factor(data, symmetric=True)
    return solver.solve(right)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("path", help="file of both problems")
    parser.add_argument("solver", choices=sorted(SOLVERS))
    found = parser.parse_args()
    sys.exit(main(found.path, found.solver))
