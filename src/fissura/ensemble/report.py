"""One page about an ensemble: ``report.html``, which needs no other file and no network."""

from __future__ import annotations

import base64
import math
from functools import partial
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from fissura.ensemble.groups import group_rows
from fissura.ensemble.pictures import PICTURES
from fissura.ensemble.statistics import QUANTITIES
from fissura.ensemble.table import varied_keys
from fissura.files import write_atomically
from fissura.folder import Folder
from fissura.results import quantities as text
from fissura.results.lettering import attempted, rendered
from fissura.results.pictures import DPI
from fissura.results.provenance import versions

if TYPE_CHECKING:
    from fissura.ensemble.result import EnsembleResult

__all__ = ["write_report"]

TEXTS = {
    "curves": "Each thin line is a run. Mean and band are taken at the same gauge, or at the same dissipated energy if "
    "the gauge of any run turns back. A run that has ended does not count beyond its end; where runs are missing, the "
    "mean is dashed and the band is paler. Runs that stopped early are no part of either.",
    "curves_by_value": "A colour for each point of the study; where it has several runs, these are thin lines, and the "
    "thick one is their mean, up to where the first of them ends.",
    "peaks_by_value": "Dots are runs, lines join means where all other values are the same. Bars are 95 % intervals "
    "of the mean by Student's t. All points have the same seeds: differences between them are surer than bars say.",
    "peaks": "Fitted by maximum likelihood. p is the probability of a worse fit by the test of Anderson and Darling if "
    "the distribution is the right one.",
    "papers": "The distribution is a straight line. Points are at median ranks (i − 0.3)/(n + 0.4). Bounds are for the "
    "fitted line, at each probability for itself, by a parametric bootstrap of pivots.",
    "crack_starts": "The centroid of the first contact that opened by G_t/f_t of the material's means: it has "
    "lost about two thirds of its strength in tension there.",
    "convergence": "Intervals of the mean by Student's t, of the coefficient of variation after Vangel (1996), for "
    "independent runs from a Gaussian population.",
}

FORMATS: dict[str, text.Formatter] = {
    "peak_load_N": text.force,
    "gauge_at_peak_m": text.length,
    "dissipated_energy_J": text.energy,
    "initial_stiffness_N_per_m": text.stiffness,
    "bodies_end": lambda value: f"{value:.0f}" if math.isfinite(value) else "-",
    "cpu_s": text.seconds,
}


def write_report(result: EnsembleResult) -> None:
    """Write ``report.html``, and its pictures into the folder ``pictures``.

    Parameters
    ----------
    result : EnsembleResult
        An ensemble; pictures that would show nothing are left out.
    """
    from jinja2 import Environment

    template = (files("fissura.ensemble") / "templates" / "report.html").read_text(encoding="utf-8")
    page = (
        Environment(autoescape=True)
        .from_string(template)
        .render(
            name=result.plan.case.name,
            runs=result.plan.runs * len(result.plan.points),
            version=versions()["fissura"],
            overview=result.table(),
            unfinished=result.unfinished(),
            pictures=_pictures(result),
            statistics=(_by_point if result.plan.vary else _statistics)(result),
            table=_table(result),
            source=result.plan.case.source,
        )
    )
    write_atomically(result.folder / "report.html", page.encode(errors="replace"))


def _pictures(result: EnsembleResult) -> list[dict[str, str]]:
    folder, own = result.folder / "pictures", Folder.kept(result.folder, "ensemble")
    folder.mkdir(exist_ok=True)
    shown = []
    for name, (draw, caption) in PICTURES.items():
        figure = attempted(f"{name}.png", partial(draw, result))
        path = folder / f"{name}.png"
        if figure is None:
            if f"pictures/{path.name}" in own.names():
                path.unlink(missing_ok=True)
            continue
        own.add(f"pictures/{path.name}")
        data = attempted(path.name, partial(rendered, figure, form="png", dpi=DPI))
        if data is None:
            continue
        write_atomically(path, data)
        note = TEXTS[name]
        if name == "convergence" and result.plan.sampling == "latin-hypercube":
            note += " Only all runs together are a Latin hypercube, and its mean scatters less than the interval says."
        shown.append({"caption": caption, "text": note, "data": base64.b64encode(data).decode()})
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


def _table(result: EnsembleResult) -> dict[str, Any]:
    keys = varied_keys(result.rows)
    heads = ["run", "status", *keys, "seed", "seed of field", *QUANTITIES.values(), "crack start x, y, z [mm]"]
    rows = []
    numbers = result.rows["number"]
    for k in np.lexsort((numbers, result.rows["kind"] == "companion")).tolist():
        number = int(numbers[k])
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
    return {"heads": heads, "rows": rows}
