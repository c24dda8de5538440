"""What the benchmark scripts share: their options, pairs of runs, checks, and sections of a Markdown page."""

from __future__ import annotations

import argparse
import json
import logging
import os
import platform
import shlex
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from statistics import mean, median, stdev
from typing import Any

from fissura import Case, Result, RunStopped, Simulation, load_case, run
from fissura.case import case_from_dict
from fissura.linear.direct import best_solver
from fissura.results.compare import compare_results

ROOT = Path(__file__).resolve().parent.parent

#: Variables that decide about threads; the page names those that were set.
THREADS = ("FISSURA_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")

PAGE = """# Benchmarks

Every table on this page was written by the script that is named above it; run the script again to renew it. Times are
processor times of one process (`time.process_time`, all its threads together) and depend on the machine.

Conventions: an adaptive run is compared with the run at full resolution of the same specimen, that is, of the same case
and seed. Loads are compared over the whole common curve. Load, peak, energy and stiffness differences are per cent of
the value at full resolution (loads: of its peak), positive where the adaptive run is larger.
"""


@dataclass(frozen=True)
class Check:
    """A target and whether it was met."""

    name: str
    value: float
    limit: float
    at_least: bool = False

    @property
    def met(self) -> bool:
        return bool(self.value >= self.limit if self.at_least else self.value <= self.limit)

    def __str__(self) -> str:
        sign = "at least" if self.at_least else "at most"
        return f"{self.name}: {self.value:.3g}, wanted {sign} {self.limit:g}: {'met' if self.met else 'MISSED'}"


@dataclass(frozen=True)
class Report:
    """Outcome of a script: rows for JSON, Markdown for the page, checks for the exit status."""

    script: str
    rows: list[dict[str, Any]]
    markdown: str
    checks: list[Check] = field(default_factory=list)


def options(
    description: str | None,
    cases: Sequence[str],
    seeds: Sequence[int],
    *,
    before: bool = False,
    more: Callable[[argparse.ArgumentParser], None] | None = None,
) -> argparse.Namespace:
    """Parse the options that all scripts have, and where to find an earlier version when that is asked for.

    ``more`` adds options of one script; the command that the page names repeats those with values that were changed.
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument(
        "--cases", nargs="+", default=list(cases), metavar="NAME", help="what to run, by default all: %(default)s"
    )
    parser.add_argument("--seeds", nargs="+", type=int, default=list(seeds), metavar="N", help="seeds of the nuclei")
    parser.add_argument("--json", type=Path, metavar="PATH", help="write all numbers there")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put the tables into this Markdown page")
    parser.add_argument("--check", action="store_true", help="exit with status 1 when a target is missed")
    if before:
        parser.add_argument("--before", type=Path, metavar="DIR", help="checkout of an earlier version")
    known = {action.dest for action in parser._actions}
    if more is not None:
        more(parser)
    found = parser.parse_args()
    own = [action.dest for action in parser._actions if action.dest not in known]
    words = [word for name in ("cases", "seeds", *own) for word in _changed(parser, found, name)]
    threads = [f"{name}={os.environ[name]}" for name in THREADS if name in os.environ]
    found.command = shlex.join([*threads, "python", _script(), *words])
    return found


def _script() -> str:
    """Path of the script that runs, as seen from the root of the repository."""
    path = Path(sys.argv[0]).resolve()
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name


def _changed(parser: argparse.ArgumentParser, found: argparse.Namespace, name: str) -> list[str]:
    value = getattr(found, name)
    values = [] if value is True else value if isinstance(value, list) else [value]
    return [] if value == parser.get_default(name) else [f"--{name.replace('_', '-')}", *map(str, values)]


def cpu_time(call: Callable[[], Any], repeats: int = 1) -> tuple[Any, float]:
    """What a call returns, and its processor time [s], the median of some repeats."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        out = call()
        times.append(time.process_time() - start)
    return out, median(times)


def say(text: str) -> None:
    """Report progress."""
    print(text, file=sys.stderr, flush=True)


def example(name: str, seed: int) -> Case:
    """A case of the examples folder, without pictures and snapshots."""
    case = load_case(ROOT / "examples" / f"{name}.toml")
    return changed(case, seed=seed, output={"vtk": 0, "measured": None})


def changed(case: Case, **parts: Any) -> Case:
    """The case with other values; a dictionary changes some values of a part."""
    new = {
        key: getattr(case, key).model_copy(update=value) if isinstance(value, dict) else value
        for key, value in parts.items()
    }
    return case.model_copy(update=new)


def warm_up() -> None:
    """Run a tiny beam to its end, so that imports and compiled kernels are not part of what is measured."""
    say("warming up")
    logging.getLogger("fissura").addHandler(logging.NullHandler())  # warnings of runs are columns of the tables
    start = time.perf_counter()
    beam = {
        "specimen": {"size": ["140 mm", "40 mm", "20 mm"]},
        "notch": {"face": "bottom", "position": "70 mm", "depth": "10 mm"},
        "supports": [
            {"type": "pin", "face": "bottom", "at": "20 mm"},
            {"type": "roller", "face": "bottom", "at": "120 mm"},
        ],
        "load": {"face": "top", "at": "70 mm"},
        "gauge": {"a": {"face": "bottom", "at": "65 mm"}, "b": {"face": "bottom", "at": "75 mm"}},
        "material": {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"},
        "discretization": {"l_f": "10 mm", "l_c": "20 mm"},
        "adaptivity": {"r_f": "10 mm", "r_c": "20 mm", "notch_tips": False},
        "control": {"target": "0.04 mm"},
        "output": {"vtk": 0},
    }
    case = case_from_dict(beam)
    for criterion in ("utilisation", "rankine"):
        run(changed(case, adaptivity={"criterion": criterion}))
    run(case, full=True)
    # Large enough for the iterative solver, but one step long.
    part = {"r_f": case.discretization.l_f, "r_c": 2 * case.discretization.l_f}
    large = changed(case, discretization={"l_f": 0.0032, "l_c": 0.0128}, adaptivity=part, control={"target": 5e-6})
    next(Simulation(large).steps())
    say(f"warm after {time.perf_counter() - start:.1f} s")


@dataclass(frozen=True)
class Run:
    """A run, or as much of it as there was."""

    result: Result
    finished: bool
    cpu_s: float
    wall_s: float


def measured(case: Case, *, full: bool = False) -> Run:
    """Run a case in memory; times are those of building the simulation and of all its steps."""
    cpu, wall, finished = time.process_time(), time.perf_counter(), True
    try:
        result = run(case, full=full)
    except RunStopped as error:
        say(f"  stopped: {error}")
        result, finished = error.result, False  # type: ignore[attr-defined]
    return Run(result, finished, time.process_time() - cpu, time.perf_counter() - wall)


def difference(adaptive: Run, full: Run) -> dict[str, Any]:
    """Differences of an adaptive run from full resolution [per cent], sizes and times."""
    between = compare_results(adaptive.result, full.result)
    of_adaptive, of_full = adaptive.result.summary, full.result.summary
    return {
        "finished": adaptive.finished and full.finished,
        "load_difference": 100 * between.max_load_difference,
        "peak_difference": 100 * between.peak_difference,
        "energy_difference": 100 * between.energy_difference,
        "stiffness_difference": 100 * between.stiffness_difference,
        "cpu_adaptive_s": adaptive.cpu_s,
        "cpu_full_s": full.cpu_s,
        "cpu_ratio": full.cpu_s / adaptive.cpu_s,
        "wall_adaptive_s": adaptive.wall_s,
        "wall_full_s": full.wall_s,
        "bodies_start": of_adaptive["bodies_start"],
        "bodies_end": of_adaptive["bodies_end"],
        "bodies_full": of_adaptive["bodies_full"],
        "steps_adaptive": adaptive.result.steps,
        "steps_full": full.result.steps,
        "factorizations_per_step_full": of_full["factorizations"] / full.result.steps,
        "factorizations_per_step_adaptive": of_adaptive["factorizations"] / adaptive.result.steps,
        "refinements": of_adaptive["refinements"],
        "max_elastic_utilisation": of_adaptive["max_elastic_utilisation"],
        "energy_balance_adaptive": 100 * of_adaptive["energy_balance_error"],
        "energy_balance_full": 100 * of_full["energy_balance_error"],
    }


def middle(rows: Iterable[dict[str, Any]], key: str) -> float:
    """Median of a column."""
    return median(float(row[key]) for row in rows)


def worst(rows: Iterable[dict[str, Any]], key: str) -> float:
    """The value of a column that is farthest from zero, as a size."""
    return max(abs(float(row[key])) for row in rows)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; all columns but the first are set flush right."""
    lines = [heads, ["---"] + ["---:"] * (len(heads) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def shown(values: Iterable[float], digits: int) -> str:
    """Mean of values, and their standard deviation where there are several."""
    values = list(values)
    spread = f" ± {stdev(values):.{digits}f}" if len(values) > 1 else ""
    return f"{mean(values):.{digits}f}{spread}"


def machine() -> dict[str, Any]:
    """The machine and the libraries that times depend on."""
    return {
        "cores": os.cpu_count(),
        "processor": _processor(),
        "platform": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in ("numpy", "scipy", "numba")},
        "solver": best_solver().__name__,
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")


def write_section(page: Path, name: str, text: str) -> None:
    """Replace one section of a page, or append it; the rest of the page stays as it is."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    old = page.read_text(encoding="utf-8") if page.exists() else PAGE
    section = f"{begin}\n{text.strip()}\n{end}"
    if begin in old and end in old:
        before, _, rest = old.partition(begin)
        new = before + section + rest.partition(end)[2]
    else:
        new = f"{old.rstrip()}\n\n{section}\n"
    page.write_text(new, encoding="utf-8")


def main(produce: Callable[[argparse.Namespace], Report], found: argparse.Namespace) -> int:
    """Run a script and do with its report what the options ask for; returns the exit status."""
    warm_up()
    report = produce(found)
    here = machine()
    described = ", ".join(
        [f"{here['cores']} cores ({here['processor']})", here["platform"], f"Python {here['python']}"]
        + [f"{name} {here[name]}" for name in ("numpy", "scipy", "numba")]
        + [f"solver {here['solver']}"]
    )
    command = f"{found.command} --write {found.write or 'docs/benchmarks.md'}"
    title, _, body = report.markdown.strip().partition("\n")
    text = f"{title}\n\nMade by `{command}` on {described}.\n\n{body.strip()}\n"
    print(text)
    if found.json:
        data = {"command": found.command, "machine": here, "rows": report.rows}
        data["checks"] = [asdict(check) | {"met": check.met} for check in report.checks]
        found.json.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    if found.write:
        write_section(found.write, report.script, text)
        say(f"written: {found.write}")
    for check in report.checks:
        say(str(check))
    return 1 if found.check and not all(check.met for check in report.checks) else 0
