"""Compiled functions that every run needs: how long each takes, and the list by which helpers compile them.

Some cases are run, each in a process with an empty cache and without helpers. Functions that the first of them
compiles while it runs, and the others do, too, are on the list. `--write` writes it to src/fissura/kernels/known.json.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from common import ROOT, table

#: The list is of what the first of these needs; what others do without is left out.
CASES = ("gregoire_d50_halfnotch", "tension_hinged")

CHILD = """
import json, sys, time
from numba.core import event
from fissura.kernels import known
from fissura.kernels.state import process
process().say = False  # no helpers
begun, rows = [], []
class Listener(event.Listener):
    def on_start(self, found):
        begun.append((time.process_time(), found.data["dispatcher"], found.data["args"]))
    def on_end(self, found):
        since, one, args = begun.pop()
        if not begun:
            rows.append((time.process_time() - since, one.py_func, args))
event.register("numba:compile", Listener())
import fissura
class Enough(Exception):
    pass
def watch(state, step):
    if step.number == 20:
        raise Enough
try:
    fissura.run(sys.argv[1], output=sys.argv[2], overwrite=True, observers=[watch])
except Enough:
    pass
out = []
for seconds, function, args in rows:
    if function.__module__.startswith("fissura"):
        out.append([f"{function.__module__}.{function.__name__}", round(seconds, 2), known.types_in_words(args)])
print(json.dumps({"pace": known.pace(), "kernels": out}))
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="Write the list.")
    found = parser.parse_args()
    measured = [_measured(name) for name in CASES]
    needed = [{json.dumps([name, types]) for name, _, types in one["kernels"]} for one in measured]
    first = [row for row in measured[0]["kernels"] if all(json.dumps([row[0], row[2]]) in one for one in needed)]
    first.sort(key=lambda row: -row[1])
    print(table(["function", "compiled in [s]"], [[row[0], f"{row[1]:.2f}"] for row in first]))
    print(f"{len(first)} functions, {sum(row[1] for row in first):.1f} s")
    if found.write:
        rows = ",\n".join(json.dumps(row) for row in first)
        path = ROOT / "src" / "fissura" / "kernels" / "known.json"
        path.write_text(f'{{"pace": {measured[0]["pace"]:.5f}, "kernels": [\n{rows}\n]}}\n', encoding="utf-8")


def _measured(name: str) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": str(Path(folder) / "cache")}
        command = [sys.executable, "-c", CHILD, str(ROOT / "examples" / f"{name}.toml"), str(Path(folder) / "results")]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, env=environment)
    return dict(json.loads(done.stdout))


if __name__ == "__main__":
    main()
