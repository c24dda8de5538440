"""One page about an ensemble: ``report.html``, which needs no other file and no network."""

import base64
import math
import os
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from fissura.case.registry import ENSEMBLE_PICTURES
from fissura.ensemble.groups import group_rows
from fissura.ensemble.interactive import page_data
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.statistics import QUANTITIES
from fissura.ensemble.table import varied_keys
from fissura.ensemble.task import Kind
from fissura.errors import InputError
from fissura.files.atomic import write_atomically
from fissura.files.folder import Folder
from fissura.pictures.registered import drawn
from fissura.reports.libraries import have_libraries
from fissura.reports.origin import origin_rows
from fissura.reports.page import rendered, write_page
from fissura.results.provenance import versions
from fissura.results.summary import read_summary
from fissura.text import quantities as text

MOVING = ("curves", "curves_by_value")
"""Pictures that a page with curves that move need not show."""

FORMATS: dict[str, text.Formatter] = {
    "peak_load_N": text.force,
    "gauge_at_peak_m": text.length,
    "dissipated_energy_J": text.energy,
    "initial_stiffness_N_per_m": text.stiffness,
    "bodies_end": lambda value: f"{value:.0f}" if math.isfinite(value) else "-",
    "cpu_s": text.seconds,
}


MOST_ROWS = 2000
"""Runs that the table of a page lists, at most."""


def write_report(result: EnsembleResult, path: Path | None = None) -> Path:
    """Write the page of an ensemble, and its pictures into the folder ``pictures``.

    Curves and specimen move where the extra ``report`` is installed; elsewhere there are pictures only.

    Parameters
    ----------
    result : EnsembleResult
        An ensemble; pictures that would show nothing are left out.
    path : Path, optional
        File to write; by default ``report.html`` in the folder of the ensemble; pictures get no files of their own
        elsewhere.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        The page would be larger than 15 MB.
    OSError
        A file cannot be written.
    """
    page = result.folder / "report.html" if path is None else path
    data, interactive = page_data(result) if have_libraries() else (None, None)
    pictures = _pictures(result, keep=path is None)
    values = {
        "title": f"{result.plan.case.name}: {result.plan.runs * len(result.plan.points)} runs",
        "overview": result.table(),
        "unfinished": result.unfinished(),
        "interactive": interactive,
        "varied": bool(result.plan.vary),
        "curves": len(result.paths),
        "pictures": [picture for picture in pictures if interactive is None or picture["name"] not in MOVING],
        "statistics": (_by_point if result.plan.vary else _statistics)(result),
        "table": _table(result, page.parent),
        "origin": _origin(result),
        "source": result.plan.case.source or _source(result),
    }
    write_page(rendered("report.html", values, data, package="fissura.ensemble"), page)
    return page


def _pictures(result: EnsembleResult, *, keep: bool) -> list[dict[str, str]]:
    """Pictures of the page, which are files of their own, too, where they are to be kept."""
    folder, own = result.folder / "pictures", Folder.kept(result.folder, "ensemble") if keep else None
    if own is not None:
        folder.mkdir(exist_ok=True)
    shown = []
    for name, picture, data in drawn(ENSEMBLE_PICTURES, result):
        path = folder / f"{name}.png"
        if data is None:
            if own is not None and f"pictures/{path.name}" in own.names():
                path.unlink(missing_ok=True)
            continue
        if own is not None:
            own.add(f"pictures/{path.name}")
            write_atomically(path, data)
        note = picture.text
        if name == "convergence" and result.plan.sampling == "latin-hypercube":
            note += " Only all runs together are a Latin hypercube, and its mean scatters less than the interval says."
        shown.append({"name": name, "caption": picture.caption, "text": note, "data": base64.b64encode(data).decode()})
    return shown


def _statistics(result: EnsembleResult) -> dict[str, Any]:
    heads = ["runs", "mean", "CoV", "smallest", "5 %", "median", "95 %", "largest"]
    rows = []
    for name, label in QUANTITIES.items():
        found, show = result.statistics.rows[name], FORMATS[name]
        if found["n"]:
            values = [show(found[key]) for key in ("mean", "smallest", "p05", "median", "p95", "largest")]
            rows.append([label, found["n"], values[0], text.per_cent(found["cov"]), *values[1:]])
    return {"heads": heads, "rows": rows}


def _by_point(result: EnsembleResult) -> dict[str, Any]:
    """Peaks at each point of a parameter study."""
    heads = [*result.plan.vary, "runs", "mean peak load", "95 % from", "to", "CoV", "mean gauge at peak"]
    rows = []
    table = group_rows(result.groups)
    for k, point in enumerate(result.plan.points):
        row = {name: column[k].item() for name, column in table.items()}
        peak = [text.force(row[f"{name}_peak_load_N"]) for name in ("mean", "low", "high")]
        gauge = text.length(row["mean_gauge_at_peak_m"])
        rows.append([k + 1, *point.given.values(), row["counted"], *peak, text.per_cent(row["cov_peak_load"]), gauge])
    return {"heads": heads, "rows": rows}


def _table(result: EnsembleResult, seen_from: Path) -> dict[str, Any]:
    """The table of runs, with links from a folder to the pages of those that have one."""
    keys = varied_keys(result.rows)
    heads = ["run", "status", *keys, "seed", "seed of field", *QUANTITIES.values(), "crack start x, y, z [mm]"]
    rows, links = [], []
    numbers = result.rows["number"]
    for k in np.lexsort((numbers, result.rows["kind"] == "companion")).tolist()[:MOST_ROWS]:
        number = int(numbers[k])
        links.append(_link(result, number, result.rows["kind"][k].item(), seen_from))
        row = {name: column[k] for name, column in result.rows.items()}
        start = [1e3 * float(row[f"crack_start_{axis}_m"]) for axis in "xyz"]
        rows.append(
            [
                number if row["kind"] == "run" else f"deterministic {number or ''}".strip(),
                row["status"],
                *(result.plan.points[int(row["point"])].given[key] for key in keys),
                row["seed"],
                row["field_seed"] if row["field_seed"] >= 0 else "-",
                *(FORMATS[name](float(row[name])) if row[name] != -1 else "-" for name in QUANTITIES),
                ", ".join(f"{value:.1f}" for value in start) if np.isfinite(start).all() else "-",
            ]
        )
    return {"heads": heads, "rows": rows, "links": links, "count": len(numbers)}


def _link(result: EnsembleResult, number: int, kind: Kind, seen_from: Path) -> str:
    """Address of the page of a run, relative to a folder; empty where there is none."""
    page = result.place(number, kind) / "report.html"
    return quote(Path(os.path.relpath(page, seen_from)).as_posix()) if page.is_file() else ""


def _origin(result: EnsembleResult) -> list[tuple[str, str]]:
    """Names and values of program, machine and date, of the run that was computed first among those that are whole."""
    for kind, number in zip(result.rows["kind"].tolist(), result.rows["number"].tolist(), strict=True):
        try:
            return origin_rows(read_summary(result.place(number, kind)), f"{result.plan.master}, of the ensemble")
        except InputError:
            continue
    return [("Fissura", versions()["fissura"])]


def _source(result: EnsembleResult) -> str | None:
    """The case as it was written, where the folder has it."""
    try:
        return (result.folder / "case.toml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
