"""The result of a study as tables: every run as CSV, what they say together as Markdown."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from fissura.files.atomic import csv_bytes, write_atomically
from fissura.study.definition import Limits
from fissura.study.measures import Measures
from fissura.study.result import StudyResult
from fissura.study.statistics import correlations, fails, localisation, spread

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
    write_atomically(paths[0], _csv(result.found))
    write_atomically(paths[1], markdown(result).encode())
    return paths


def _csv(found: Sequence[Measures]) -> bytes:
    """One row for each run; fractions are not per cent here."""
    rows = [m.row() for m in found]
    names = list(rows[0]) if rows else ["specimen"]
    return csv_bytes([names, *([_cell(row.get(name, "")) for name in names] for row in rows)])


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return value


Cell = Callable[[Sequence[Measures], Limits], str]


def _spread(value: Callable[[Measures], float], form: str, *, smallest: bool = False) -> Cell:
    """Median of a value, and in brackets the worst."""

    def cell(runs: Sequence[Measures], _: Limits) -> str:
        of = spread((value(m) for m in runs if m.compared), smallest=smallest)
        if not math.isfinite(of.median):
            return "-"
        return f"{_number(of.median, form)} ({_number(of.worst, form.removeprefix('+'))})"

    return cell


def _medians(form: str, *names: str, factor: float = 1.0) -> Cell:
    """Medians of several values."""

    def cell(runs: Sequence[Measures], _: Limits) -> str:
        usable = [m for m in runs if m.compared]
        medians = (spread(factor * getattr(m, name) for m in usable).median for name in names)
        return form.format(*medians) if usable else "-"

    return cell


def _ends(runs: Sequence[Measures], _: Limits) -> str:
    ends = Counter(m.end for m in runs if m.end != "target")
    return ", ".join([f"{len(runs)}", *(f"{end} {count}" for end, count in ends.items())])


def _right(runs: Sequence[Measures], limits: Limits) -> str:
    return f"{sum(not fails(m, limits) for m in runs)}"


BODIES, OVERHEAD = ("bodies_start", "bodies_end", "bodies_full"), ("repeated", "refining")

COLUMNS: dict[str, tuple[str, Cell]] = {
    "runs": ("runs", _ends),
    "right": ("within limits", _right),
    "load": ("load [%]", _spread(lambda m: 100 * m.load, ".2f")),
    "peak": ("peak [%]", _spread(lambda m: 100 * m.peak, "+.2f")),
    "energy": ("energy [%]", _spread(lambda m: 100 * m.energy, "+.2f")),
    "stiffness": ("stiffness [%]", _spread(lambda m: 100 * m.stiffness, "+.2f")),
    "crack": ("on the crack [%]", _spread(lambda m: 100 * m.crack / m.crack_full, ".1f", smallest=True)),
    "overlap": ("overlap [%]", _spread(lambda m: 100 * m.overlap, ".1f", smallest=True)),
    "utilisation": ("elastic utilisation", _spread(lambda m: m.used, ".2f")),
    "bodies": (
        "bodies, start → end (full)",
        _medians("{:.0f} → {:.0f} ({:.0f})", "bodies_start", "bodies_end", "bodies_full"),
    ),
    "refinements": ("refinements", _spread(lambda m: float(m.refinements), ".0f")),
    "overhead": (
        "repeated, re-tessellated [% of time]",
        _medians("{:.0f}, {:.0f}", "repeated", "refining", factor=100.0),
    ),
    "cpu": ("processor time [s] (full)", _medians("{:.1f} ({:.1f})", "cpu", "cpu_full")),
    "ratio": ("ratio", _spread(lambda m: m.cpu_ratio, ".2f", smallest=True)),
    "effort": ("effort, ratio", _spread(lambda m: m.effort_ratio, ".2f", smallest=True)),
}
"""Columns of the table of specimens and variations: head, and what stands in it for the runs of a row."""


def summary_rows(result: StudyResult, found: Sequence[Measures]) -> list[dict[str, str]]:
    """Rows of the table: for each specimen and variation the values of `COLUMNS` as text, and their names."""
    groups: dict[tuple[str, str], list[Measures]] = {}
    for m in found:
        groups.setdefault((m.variation, m.specimen), []).append(m)
    return [
        {"variation": variation, "specimen": specimen}
        | {key: cell(runs, result.specimen(specimen).limits) for key, (_, cell) in COLUMNS.items()}
        for (variation, specimen), runs in groups.items()
    ]


def markdown(result: StudyResult) -> str:
    """Every table of a study, as one page."""
    parts = [f"# {' '.join(result.study.name.split())}", _progress(result), TEXT]
    for variation in result.study.variations:
        rows = summary_rows(result, result.of(variation=variation.name))
        if rows:
            heads = ["specimen", *(head for head, _ in COLUMNS.values())]
            lines = [[row["specimen"], *(row[key] for key in COLUMNS)] for row in rows]
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
            where = crack = "-"
            if m.compared:
                where = f"{100 * abs(m.at):.0f} % {'before' if m.at < 0 else 'after'}"
                crack = f"{100 * m.crack / m.crack_full:.1f}"
            run = [m.variation, m.specimen, f"{m.seed}", ", ".join(missed)]
            lines.append([*run, where, f"{m.used:.2f}", crack, m.message[:90] or "-"])
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
    return table(heads, lines) if lines else "None."


def _correlations(result: StudyResult) -> str:
    blocks = []
    groups = {"all": [entry.name for entry in result.study.specimens], **result.types()}
    for name, specimens in groups.items():
        found = [m for m in result.of(specimens) if m.compared]
        if len(found) < 3:
            continue
        forms = {"rank": ".2f", "linear": ".2f", "covering": ".3g", "excess": ".1f"}
        lines = [
            [f"`{c.name}`", *(_number(getattr(c, name), form) for name, form in forms.items())]
            for c in correlations(found)
        ]
        heads = ["indicator", "of ranks", "of logarithms", "covering", "exaggerates"]
        blocks.append(f"### {name}: {len(found)} runs\n\n{table(heads, lines)}")
    return "\n\n".join(blocks) or "Too few runs."


def _places(result: StudyResult) -> str:
    lines = []
    for t in localisation(result.of(result.free)):
        apart = f"{1e3 * abs(t.adaptive - t.full).max():.1f}"
        count = [f"{len(t.same)}", f"{t.same.sum()}"]
        lines.append([t.variation, t.specimen, *count, apart, f"{t.statistic:.2f}", f"{t.probability:.2f}"])
    heads = ["variation", "specimen", "seeds", "same crack", "farthest apart [mm]", "statistic", "p"]
    return table(heads, lines) if lines else "Too few runs."


def _number(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else ("∞" if math.isinf(value) else "-")
