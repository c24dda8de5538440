"""The result of a study as tables: every run as CSV, what they say together as Markdown."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from fissura.files.atomic import write_atomically
from fissura.study.measures import Measures
from fissura.study.result import StudyResult
from fissura.study.statistics import correlations, fails, localisation, spread

__all__ = ["markdown", "summary_rows", "write_tables"]

#: Columns of the table of specimens and variations: key of `summary_rows`, head.
COLUMNS = [
    ("runs", "runs"),
    ("right", "within limits"),
    ("load", "load [%]"),
    ("peak", "peak [%]"),
    ("energy", "energy [%]"),
    ("stiffness", "stiffness [%]"),
    ("crack", "on the crack [%]"),
    ("overlap", "overlap [%]"),
    ("utilisation", "elastic utilisation"),
    ("bodies", "bodies, start → end (full)"),
    ("refinements", "refinements"),
    ("overhead", "repeated, re-tessellated [% of time]"),
    ("cpu", "processor time [s] (full)"),
    ("ratio", "ratio"),
    ("effort", "effort, ratio"),
]

TEXT = """\
Each row has the median over seeds, and in brackets the worst: the largest size, for the crack and the ratio of
processor times the smallest. Differences are per cent of the value at full resolution (load: of its peak). *Load* is
the largest difference over the whole curve. *On the crack*: share of the dissipated energy within `l_f` of the crack at
full resolution, over the share that full resolution itself has. *Overlap*: energy dissipated by both in the same
contacts. *Elastic utilisation*: largest traction over strength in contacts without damage law. *Effort*: bodies
times linear iterations, which no busy machine disturbs. *Runs* that ended otherwise than at their target are counted by
what ended them; `load`: it had fallen to `control.stop_load`.
"""

_ESTIMATES = """\
Largest value of each indicator over a run, against the largest load difference of that run. *Covering*: the factor
that makes the indicator an upper bound of the error in 95 % of the runs; *exaggerates*: how many times too large that
bound is in the median.
"""

_PLACES = """\
Specimens without a notch. The position of a crack is the x with half of the energy on either side. *Same crack*: an
overlap of at least 80 %. *p*: of a Kolmogorov-Smirnov test that positions at both resolutions come from one
distribution; below 0.05, refinement would have drawn the cracks elsewhere.
"""


def write_tables(result: StudyResult, folder: Path) -> list[Path]:
    """Write ``runs.csv`` and ``study.md``; returns what was written."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / "runs.csv", folder / "study.md"]
    write_atomically(paths[0], _csv(result.found).encode())
    write_atomically(paths[1], markdown(result).encode())
    return paths


def _csv(found: Sequence[Measures]) -> str:
    """One row for each run; fractions are not per cent here."""
    buffer = io.StringIO()
    rows = [m.row() for m in found]
    writer = csv.DictWriter(buffer, list(rows[0]) if rows else ["specimen"], lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)
    return buffer.getvalue()


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return value


def summary_rows(result: StudyResult, found: Sequence[Measures]) -> list[dict[str, str]]:
    """Rows of the table: for each specimen and variation the values of `COLUMNS` as text, and ``name``."""
    groups: dict[tuple[str, str], list[Measures]] = {}
    for m in found:
        groups.setdefault((m.variation, m.specimen), []).append(m)
    return [
        {"variation": variation, "specimen": specimen, **_summary(result, specimen, runs)}
        for (variation, specimen), runs in groups.items()
    ]


def _summary(result: StudyResult, specimen: str, runs: list[Measures]) -> dict[str, str]:
    limits = result.specimen(specimen).limits
    usable = [m for m in runs if m.compared]
    ends = [m.end for m in runs if m.end != "target"]

    def per_cent(key: str) -> str:
        of = spread(100 * getattr(m, key) for m in usable)
        sign = "" if key == "load" else "+"
        return _pair(of.median, of.worst, f"{sign}.2f", ".2f")

    crack = spread((100 * m.crack / m.crack_full for m in usable), smallest=True)
    both = spread((100 * m.overlap for m in usable), smallest=True)
    used = spread((m.indicators or {}).get("utilisation", math.nan) for m in usable)
    ratio = spread((m.cpu_ratio for m in usable), smallest=True)
    effort = spread((m.effort_ratio for m in usable), smallest=True)
    start, end, full = (spread(float(getattr(m, f"bodies_{key}")) for m in usable) for key in ("start", "end", "full"))
    refined = spread(float(m.refinements) for m in usable)
    cpu, cpu_full = spread(m.cpu for m in usable), spread(m.cpu_full for m in usable)
    repeated, refining = (spread(100 * getattr(m, key) for m in usable).median for key in ("repeated", "refining"))
    return {
        "runs": f"{len(runs)}" + "".join(f", {end} {count}" for end, count in Counter(ends).items()),
        "right": f"{sum(not fails(m, limits) for m in runs)}",
        **{key: per_cent(key) for key in ("load", "peak", "energy", "stiffness")},
        "crack": _pair(crack.median, crack.worst, ".1f", ".1f"),
        "overlap": _pair(both.median, both.worst, ".1f", ".1f"),
        "utilisation": _pair(used.median, used.worst, ".2f", ".2f"),
        "bodies": "-" if not usable else f"{start.median:.0f} → {end.median:.0f} ({full.median:.0f})",
        "refinements": _pair(refined.median, refined.worst, ".0f", ".0f"),
        "overhead": "-" if not usable else f"{repeated:.0f}, {refining:.0f}",
        "cpu": _pair(cpu.median, cpu_full.median, ".1f", ".1f"),
        "effort": _pair(effort.median, effort.worst, ".2f", ".2f"),
        "ratio": _pair(ratio.median, ratio.worst, ".2f", ".2f"),
    }


def markdown(result: StudyResult) -> str:
    """Every table of a study, as one page."""
    parts = [f"# {' '.join(result.study.name.split())}", _progress(result), TEXT]
    for variation in result.study.variations:
        rows = summary_rows(result, result.of(variation=variation.name))
        if rows:
            heads = ["specimen", *(head for _, head in COLUMNS)]
            lines = [[row["specimen"], *(row[key] for key, _ in COLUMNS)] for row in rows]
            parts += [f"## {variation.name}{_changes(variation.change)}", table(heads, lines)]
    parts += ["## Runs beyond the limits", _failures(result)]
    parts += ["## Indicators of the error", _ESTIMATES, _correlations(result)]
    if result.free:
        parts += ["## Places of cracks", _PLACES, _places(result)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; all columns but the first are set flush right."""
    lines = [heads, ["---"] + ["---:"] * (len(heads) - 1), *([_in_a_cell(cell) for cell in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _in_a_cell(text: str) -> str:
    """Text that may be a message or a name of the user, without what would end a cell or a row."""
    return " ".join(text.split()).replace("|", "\\|")


def _progress(result: StudyResult) -> str:
    """How many runs there are, and how they ended."""
    adaptive = len(result.found)
    early = sum(m.end not in ("target", "load") for m in result.found)
    full, broken = (sum(counts[k] for counts in result.full.values()) for k in (0, 1))
    left = f" {result.left} runs are still to be done." if result.left else ""
    return (
        f"{adaptive} adaptive runs, {early} of which did not finish, against {full} runs at full resolution, {broken}"
        f" of which did not finish.{left}"
    )


def _changes(change: dict[str, Any], prefix: str = "") -> str:
    """What a variation changes, as in a case file."""
    parts: list[str] = []
    for key, value in change.items():
        parts += [_changes(value, f"{prefix}{key}.")] if isinstance(value, dict) else [f"`{prefix}{key} = {value!r}`"]
    text = ", ".join(parts)
    return f": {text}" if text and not prefix else text


def _failures(result: StudyResult) -> str:
    lines = []
    for m in result.found:
        missed = fails(m, result.specimen(m.specimen).limits)
        if missed:
            used = (m.indicators or {}).get("utilisation", math.nan)
            where = "-" if not m.compared else f"{100 * abs(m.at):.0f} % {'before' if m.at < 0 else 'after'}"
            crack = "-" if not m.compared else f"{100 * m.crack / m.crack_full:.1f}"
            lines.append(
                [
                    m.variation,
                    m.specimen,
                    f"{m.seed}",
                    ", ".join(missed),
                    where,
                    f"{used:.2f}",
                    crack,
                    m.message[:90] or "-",
                ]
            )
    if not lines:
        return "None."
    heads = [
        "variation",
        "specimen",
        "seed",
        "misses",
        "at load, peak",
        "elastic utilisation",
        "on the crack [%]",
        "message",
    ]
    return table(heads, lines)


def _correlations(result: StudyResult) -> str:
    blocks = []
    groups = {"all": [entry.name for entry in result.study.specimens], **result.types()}
    for name, specimens in groups.items():
        found = [m for m in result.of(specimens) if m.compared]
        if len(found) < 3:
            continue
        lines = [
            [
                f"`{c.name}`",
                _number(c.rank, ".2f"),
                _number(c.linear, ".2f"),
                _number(c.covering, ".3g"),
                _number(c.excess, ".1f"),
            ]
            for c in correlations(found)
        ]
        heads = ["indicator", "of ranks", "of logarithms", "covering", "exaggerates"]
        blocks.append(f"### {name}: {len(found)} runs\n\n{table(heads, lines)}")
    return "\n\n".join(blocks) or "Too few runs."


def _places(result: StudyResult) -> str:
    lines = [
        [
            f"{t.variation}",
            t.specimen,
            f"{len(t.same)}",
            f"{t.same.sum()}",
            f"{1e3 * abs(t.adaptive - t.full).max():.1f}",
            f"{t.statistic:.2f}",
            f"{t.probability:.2f}",
        ]
        for t in localisation(result.of(result.free))
    ]
    heads = ["variation", "specimen", "seeds", "same crack", "farthest apart [mm]", "statistic", "p"]
    return table(heads, lines) if lines else "Too few runs."


def _number(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else ("∞" if math.isinf(value) else "-")


def _pair(first: float, second: float, form: str, form_of_second: str) -> str:
    return f"{_number(first, form)} ({_number(second, form_of_second)})" if math.isfinite(first) else "-"
