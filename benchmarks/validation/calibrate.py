"""Known constants found again by fissura calibrate, and how often its 95 % intervals hold them: docs/calibrate.md.

First the half-notched beam of Grégoire et al.: curves of it are computed with known f_t and G_t and seeds of their own,
and the tool finds these constants from them. Then many experiments on small beams, each with other seeds for what is
"measured" and for what is computed: the share of the experiments in which an interval holds the true value is to be
95 %. Last, four constants from two tests. What is in the folder of `--keep` is not run again.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import above  # noqa: F401
import numpy as np
from small_beams import TRUE, TWO, Experiment, experiment, row_of, structures

import fissura
from common import ROOT, Check, Report, main, options, say, table
from fissura.batch.processes import computed
from fissura.machine.threads import threads_each
from fissura.results.curve_writer import CurveWriter

#: Seed of the "measured" specimens, far from those of what is computed.
MEASURED = 700


def known(specimens: int, number: int, keep: Path) -> dict[str, Any]:
    """The tool on curves of the half-notched beam that were computed with known constants and seeds of each number."""
    say(f"the half-notched beam, {specimens} specimens, experiment {number}")
    folder, row = keep / f"beam{specimens}-{number}", keep / f"beam{specimens}-{number}.json"
    if row.is_file():
        return dict(json.loads(row.read_text()))
    case = fissura.load_case(ROOT / "examples" / "gregoire_d50_halfnotch.toml").with_({"output.measured": None})
    with tempfile.TemporaryDirectory() as place:
        files = []
        for k in range(specimens):
            seed = MEASURED + 10 * (number - 1) + k
            curve = fissura.run(case.with_({**TRUE, "seed": seed})).curve
            files.append(Path(place) / f"measured{k}.csv")
            writer = CurveWriter(files[-1], ["gauge_m", "load_N"])
            for gauge, load in zip(curve["gauge_m"], curve["load_N"], strict=True):
                writer.write({"gauge_m": gauge, "load_N": load})
            writer.close()
        before, begun = os.times(), time.perf_counter()
        found = fissura.calibrate(case, files, output=folder, seed=case.seed + number - 1, overwrite=folder.is_dir())
        after, wall = os.times(), time.perf_counter() - begun
    spent = sum(after[:4]) - sum(before[:4])
    estimates = {key: (e.value, e.error, e.low, e.high) for key, e in found.estimates.items()}
    out = row_of(f"{specimens}", estimates) | {
        "number": number,
        "runs": found.runs,
        "converged": found.converged,
        "correlation": float(found.correlation[0, 1]),
        "cpu_s": spent,
        "wall_s": wall,
    }
    row.write_text(json.dumps(out))
    return out


def produce(found: argparse.Namespace) -> Report:
    """Run everything."""
    beams = [known(count, number, found.keep) for count in found.beams for number in range(1, found.repeats + 1)]
    tasks = [
        Experiment("small", number, specimens, 6, 40)
        for specimens in found.specimens
        for number in range(1, found.experiments + 1)
    ]
    tasks += [Experiment("energies", number, 3, 6, 60) for number in range(1, found.energies + 1)]
    done = {task: json.loads(path.read_text()) for task in tasks if (path := _path(found.keep, task)).is_file()}
    with threads_each(1):
        for task, row in computed(experiment, [task for task in tasks if task not in done], found.workers):
            assert row is not None, "the process that computed an experiment died"
            done[task] = row
            path = _path(found.keep, task)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(row))
            say(f"{task.of}, {task.specimens} specimens, experiment {task.number}: {row['runs']} runs")
    small = {
        count: [done[task] for task in tasks if task.of == "small" and task.specimens == count]
        for count in found.specimens
    }
    place = found.keep / "structures.json"
    if found.structures and not place.is_file():
        found.keep.mkdir(parents=True, exist_ok=True)
        place.write_text(json.dumps(structures(found.structures, 12)))
    scatter = json.loads(place.read_text()) if found.structures else {}
    energies = [done[task] for task in tasks if task.of == "energies"]
    return Report(
        "validation_calibrate",
        [*beams, *(row | {"specimens": count} for count, of in small.items() for row in of), *energies],
        _markdown(beams, small, scatter, energies),
        _checks(beams, small),
    )


def _path(keep: Path, task: Experiment) -> Path:
    return keep / f"{task.of}{task.specimens}" / f"{task.number:03d}.json"


def _markdown(
    beams: list[dict[str, Any]],
    rows: dict[int, list[dict[str, Any]]],
    scatter: dict[str, Any],
    energies: list[dict[str, Any]],
) -> str:
    known_table = table(
        ("specimens", "experiment", "f_t [MPa], true 2.8", "off by", "G_t [J/m²], true 50", "off by", "correlation",
         "runs", "processor time", "wall time"),
        [
            (
                row["name"],
                f"{row['number']}",
                f"{row['f_t'] / 1e6:.3f} ± {row['f_t_error'] / 1e6:.3f}",
                f"{_off(row, 'f_t'):+.2f} errors",
                f"{row['G_t']:.1f} ± {row['G_t_error']:.1f}",
                f"{_off(row, 'G_t'):+.2f} errors",
                f"{row['correlation']:+.2f}",
                f"{row['runs']}",
                f"{row['cpu_s']:.0f} s",
                f"{row['wall_s'] / 60:.1f} min",
            )
            for row in beams
        ],
    )  # fmt: skip
    coverage = table(
        ("specimens", "experiments", "f_t inside", "G_t inside", "f_t off [errors]", "G_t off [errors]", "f_t", "G_t",
         "runs, mean and most", "converged"),
        [
            (
                f"{count}",
                f"{len(of)}",
                *(f"{np.mean([row[f'{name}_inside'] for row in of]):.0%}" for name in ("f_t", "G_t")),
                *(_shown([_off(row, name) for row in of]) for name in ("f_t", "G_t")),
                *(_error(of, name) for name in ("f_t", "G_t")),
                f"{np.mean([row['runs'] for row in of]):.0f}, {max(row['runs'] for row in of)}",
                f"{np.mean([row['converged'] for row in of]):.0%}",
            )
            for count, of in rows.items()
            if of
        ],
    )  # fmt: skip
    parts = [
        "## Known constants found again",
        "The half-notched beam of Grégoire et al., its curves computed with f_t = 2.8 MPa and G_t = 50 J/m² and other"
        " seeds, started from the values of the example. Each experiment has other seeds for what is measured and for"
        " what is computed. Times are those of all processes, on 2 cores that had much other work:",
        known_table,
        "Small beams (100 x 30 x 15 mm, l_f 6 mm), each experiment with seeds of its own for what is measured and"
        " what is computed, started 20 to 30 % below the true values and 30 to 40 % above, in turn. *Inside*: how"
        " often the 95 % interval holds the true value. *Off*: mean and standard deviation of the difference"
        " of logarithms in standard errors. The last columns are mean standard errors, and the scatter of the"
        " estimates themselves, with its own standard error.",
        coverage,
    ]
    if scatter:
        parts += [
            "The same small beams without any search: how far `f_t` and `G_t` of single random structures are apart,"
            " standard deviations of logarithms, from curves with the true constants and the mean derivative.",
            table(
                ("structures", "number", "f_t", "G_t"),
                [
                    (name, f"{of['count']}", _of_structures(of, "f_t"), _of_structures(of, "G_t"))
                    for name, of in scatter.items()
                ],
            ),
        ]
    if energies:
        parts += [
            "Four constants from two tests: small beams with and without the notch, by the law with two energies"
            " (`initial` 0.2, `tail` 0.35), three specimens of each. Correlations are those of f_t and G_t, initial and"
            " tail, and the largest of all; *left*: how far the search would go on, in standard errors of the seeds.",
            _of_energies(energies),
        ]
    return "\n\n".join(parts)


def _of_structures(of: dict[str, Any], name: str) -> str:
    return f"{of[name]:.1%} ± {of[name] / np.sqrt(2.0 * (of['count'] - 1)):.1%}"


def _of_energies(rows: list[dict[str, Any]]) -> str:
    found = []
    for row in rows:
        correlation = np.array(row["correlation"])
        largest = correlation[np.triu_indices(4, 1)]
        found.append(
            (
                row["name"],
                *(
                    f"{row[name] / unit:.{digits}f} ± {row[f'{name}_error'] / unit:.{digits}f} ({_off(row, name):+.1f})"
                    for name, unit, digits in (("f_t", 1e6, 2), ("G_t", 1, 0), ("initial", 1, 2), ("tail", 1, 2))
                ),
                f"{correlation[0, 1]:+.2f}",
                f"{correlation[2, 3]:+.2f}",
                f"{largest[np.abs(largest).argmax()]:+.2f}",
                f"{row['runs']}",
                f"{row['move']:.1f}",
            )
        )
    heads = ("experiment", "f_t [MPa], true 2.8 (off by so many errors)", "G_t [J/m²], true 50", "initial, true 0.2",
             "tail, true 0.35", "f_t, G_t", "initial, tail", "largest", "runs of both", "left")  # fmt: skip
    return table(heads, found)


def _off(row: dict[str, Any], name: str) -> float:
    """Difference of the logarithms of found and true value in standard errors, in which intervals are symmetric."""
    true = {key.rpartition(".")[2]: value for key, value in (TRUE | TWO).items()}[name]
    return float(np.log(row[name] / true) * row[name] / row[f"{name}_error"])


def _shown(values: list[float]) -> str:
    return f"{np.mean(values):+.2f} ± {np.std(values, ddof=1) if len(values) > 1 else 0.0:.2f}"


def _error(rows: list[dict[str, Any]], name: str) -> str:
    true = TRUE[f"material.{name}"]
    told = np.sqrt(np.mean([(row[f"{name}_error"] / true) ** 2 for row in rows]))
    seen = np.std([row[name] / true for row in rows], ddof=1) if len(rows) > 1 else 0.0
    unsure = seen / np.sqrt(2.0 * max(len(rows) - 1, 1))
    return f"{told:.1%} told, {seen:.1%} ± {unsure:.1%} seen"


def _checks(beams: list[dict[str, Any]], rows: dict[int, list[dict[str, Any]]]) -> list[Check]:
    checks = [
        Check(f"{row['name']} specimens, {name}: off in standard errors", abs(_off(row, name)), 2.6)
        for row in beams
        for name in ("f_t", "G_t")
    ]
    checks += [Check(f"{row['name']} specimens: runs", row["runs"], 40) for row in beams]
    for count, of in rows.items():
        for name in ("f_t", "G_t"):
            inside = float(np.mean([row[f"{name}_inside"] for row in of])) if of else 0.0
            checks.append(Check(f"{count} specimens, {name}: share inside", inside, 0.8, at_least=True))
    return checks


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--beams", nargs="*", type=int, default=[1, 3], metavar="N", help="measured half-notched beams")
    parser.add_argument("--repeats", type=int, default=4, metavar="N", help="experiments of each of these")
    parser.add_argument("--specimens", nargs="*", type=int, default=[1, 3], metavar="N", help="measured small beams")
    parser.add_argument("--experiments", type=int, default=20, metavar="N", help="experiments of each")
    parser.add_argument("--energies", type=int, default=4, metavar="N", help="experiments with four unknowns")
    parser.add_argument("--structures", type=int, default=40, metavar="N", help="specimens whose scatter is told")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="experiments side by side")
    keep = ROOT / "results" / "validation" / "calibrate"
    parser.add_argument("--keep", type=Path, default=keep, help="folder for what was computed, which is not done again")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["all"], [1], more=_more)))
