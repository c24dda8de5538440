"""Start-up of a run: imports, reading the case, loading compiled kernels from their cache.

Every run here is a process of its own: the command `fissura run` on a case of 1000 bodies, ended after its first step.
The same work is then repeated in that process; what the first time took longer is start-up.
"""

from __future__ import annotations

import argparse
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

from common import ROOT, Check, Report, main, options, say, table

#: Fine spacing with which a case has 1000 bodies at full resolution.
SPACING = {"beam_d100": "11.7 mm"}
#: Largest import and largest start-up [s].
IMPORT, START_UP = 0.5, 1.0
#: How often the work is repeated in a process.
REPEATS = 3

#: Programs that are measured as whole processes.
IMPORTS = {
    "python, nothing imported": "pass",
    "`import fissura`": "import fissura",
    "numpy, scipy.sparse, scipy.spatial, numba": "import numpy, scipy.sparse, scipy.spatial, numba",
    "every public name of fissura": "import fissura; [getattr(fissura, name) for name in fissura.__all__]",
}

#: Marks of processor and wall time: of the first time with all imports, then of the repeats.
CHILD = """
import json, sys, time
marks = {"begin": (0.0, float(sys.argv[1]))}
def mark(name):
    marks[name] = (time.process_time(), time.time())
mark("python")
import fissura.cli as cli
cli.start_light()
mark("command line")
import numpy, scipy.sparse.linalg, scipy.sparse.csgraph, scipy.spatial
mark("numpy and scipy")
import numba
mark("numba")
import fissura.case
mark("case")
import fissura.simulation.loop, fissura.running.recorder
mark("fissura")
from fissura import api
run = api.run
class Enough(Exception):
    pass
def until_first_step(case, **how):
    mark("read")
    def end(step):
        mark("first step")
        raise Enough
    run(case, **(how | {"on_start": lambda simulation: mark("built"), "on_step": end}))
api.run = until_first_step
found = []
for turn in range(1 + int(sys.argv[2])):
    if turn:
        marks = {}
        mark("begin")
    try:
        cli.app(sys.argv[3:], standalone_mode=False)
    except Enough:
        found.append(marks)
print(json.dumps(found))
"""

TEXT = """\
`fissura run` of `{name}` with `l_f` {spacing}, from the start of the process to the end of the first step; kernels come
from their cache. Medians of {count} processes.
"""

Times = tuple[float, float]


def produce(found: argparse.Namespace) -> Report:
    say("imports")
    count = len(found.seeds)
    imports = {name: _middle([_process(code) for _ in range(count)]) for name, code in IMPORTS.items()}
    rows: list[dict[str, Any]] = [_row(times, part=part) for part, times in imports.items()]
    checks = [Check("import fissura [s]", max(imports["`import fissura`"]), IMPORT)]
    sections = ["## Start-up", f"### Imports\n\nWhole processes, medians of {count}.\n", _table("program", imports), ""]
    for name in found.cases:
        for full in (False, True):
            kind = "full" if full else "adaptive"
            say(f"{name}, {kind}")
            measured = [_parts(_child(name, seed, full)) for seed in found.seeds]
            parts = {part: _middle([one[part] for one in measured]) for part in measured[0]}
            rows += [_row(times, case=name, full=full, part=part) for part, times in parts.items()]
            checks.append(Check(f"start-up of {name}, {kind} [s]", max(parts["start-up, all of it"]), START_UP))
            text = TEXT.format(name=name, spacing=SPACING[name], count=count)
            sections += [f"### `{name}`, {kind}, start-up\n", text, _table("part", parts), ""]
    return Report("start_up", rows, "\n".join(sections), checks)


def _process(code: str) -> Times:
    """Processor and wall time of a Python program from its start to its end [s]."""
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True)
    wall, after = time.perf_counter() - wall, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, wall


def _child(name: str, seed: int, full: bool) -> list[dict[str, Times]]:
    """Marks of the first time and of the repeats, after a process that fills the cache."""
    text = (ROOT / "examples" / f"{name}.toml").read_text(encoding="utf-8")
    text = re.sub(r'^l_f = ".*"$', f'l_f = "{SPACING[name]}"', text, flags=re.MULTILINE)
    with tempfile.TemporaryDirectory() as folder:
        case, output = Path(folder) / f"{name}.toml", Path(folder) / "results"
        case.write_text(text, encoding="utf-8")
        command = ["run", str(case), "--quiet", "--overwrite", "--seed", str(seed), "--output", str(output)]
        command += ["--full"] * full
        for repeats in (0, REPEATS):
            arguments = [sys.executable, "-c", CHILD, str(time.time()), str(repeats), *command]
            answer = subprocess.run(arguments, check=True, stdout=subprocess.PIPE, cwd=folder)
    return list(json.loads(answer.stdout))


def _parts(marks: list[dict[str, Times]]) -> dict[str, Times]:
    """Parts of the first time: its imports, what else it takes longer than the repeats, and the repeats."""
    first, repeats = marks[0], marks[1:]

    def took(name: str, since: str) -> Times:
        return _minus(first[name], first[since])

    def again(name: str, since: str) -> Times:
        return _middle([_minus(one[name], one[since]) for one in repeats])

    work = again("first step", "begin")
    return {
        "Python": took("python", "begin"),
        "typer, rich": took("command line", "python"),
        "numpy, scipy": took("numpy and scipy", "command line"),
        "numba": took("numba", "numpy and scipy"),
        "pydantic, models of a case": took("case", "numba"),
        "fissura's other modules": took("fissura", "case"),
        "reading the case": _minus(took("read", "fissura"), again("read", "begin")),
        "loading kernels, while building": _minus(took("built", "read"), again("built", "read")),
        "the same, in the first step": _minus(took("first step", "built"), again("first step", "built")),
        "start-up, all of it": _minus(took("first step", "begin"), work),
        "the work itself": work,
        "from process start to first step": took("first step", "begin"),
    }


def _minus(a: Times, b: Times) -> Times:
    return a[0] - b[0], a[1] - b[1]


def _middle(times: list[Times]) -> Times:
    return median(one[0] for one in times), median(one[1] for one in times)


def _row(times: Times, **what: Any) -> dict[str, Any]:
    return what | {"cpu_s": times[0], "wall_s": times[1]}


def _table(head: str, parts: dict[str, Times]) -> str:
    rows = [[part, f"{cpu:.3f}", f"{wall:.3f}"] for part, (cpu, wall) in parts.items()]
    return table([head, "processor [s]", "wall [s]"], rows)


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1, 2, 3, 4, 5, 6, 7])))
