"""What moves on the page of an ensemble: its curves, and its specimen in 3D with the places where cracks started."""

from collections.abc import Mapping
from contextlib import suppress
from html import escape
from typing import Any

import numpy as np

from fissura.ensemble.band import Band
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.study_pictures import colours
from fissura.errors import InputError
from fissura.pictures.specimen_signs import signs_of
from fissura.reports.view import Marks, scene_of
from fissura.results.load_path import LoadPath
from fissura.results.names import load_name, value_axis
from fissura.specimen import domain_from_case
from fissura.text.units import scale_of

MOST_LINES = 300
"""Curves of runs on a page, at most."""

Trace = dict[str, Any]


def page_data(result: EnsembleResult) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the JavaScript of a page draws, and what its template says of that.

    Parameters
    ----------
    result : EnsembleResult
        An ensemble or a parameter study.

    Returns
    -------
    data : dict
        For `fissura.reports.page.rendered`.
    told : dict
        ``views``: names of the views of the curves; ``drawn``: how many of the curves there are; ``signs``: the legend
        of the 3D view, None where there is none; ``marked``: how many places are marked in it.
    """
    views = _views(result)
    scene: dict[str, Any] | None = None
    told: dict[str, Any] = {"signs": None, "marked": 0}
    case = result.plan.case
    try:
        domain = domain_from_case(case)
        marks = None if result.plan.vary else _starts(result)
        scene = scene_of(case, domain, marks=marks)
        told = {"signs": signs_of(case, domain).legend, "marked": 0 if marks is None else len(marks[1])}
    except InputError:
        pass  # a file that describes the specimen is gone
    names = [view["name"] for view in views]
    data = {"kind": "ensemble", "lines": {"views": views} if views else None, "scene": scene}
    return data, told | {"views": names, "drawn": min(len(result.paths), MOST_LINES)}


def _views(result: EnsembleResult) -> list[dict[str, Any]]:
    """The curves over what is controlled; where that turns back, mean and band over the dissipated energy, too."""
    if not result.paths:
        return []
    case, paths = result.plan.case, _some(result.paths)
    x, x_unit = scale_of("m", max(float(path.value.max()) for path in result.paths.values()))
    y, y_unit = scale_of("N", max(float(np.abs(path.load).max()) for path in result.paths.values()))
    band = None if result.plan.vary else result.band
    over_energy = band is not None and band.over == "dissipated energy"
    shade = _shades(result)
    lines = [_line(number, path.value * x, path.load * y, *shade[number]) for number, path in paths.items()]
    lines += [_companion(path, x, y) for path in result.companion_paths.values()][:MOST_LINES]
    labels = {"y": f"{load_name(case)} [{y_unit}]"}
    value = value_axis(case, case.quantity)
    first = _named_once(lines) + ([] if band is None or over_energy else _band(band, x, y))
    views = [{"name": f"over the {value}", "x": f"{value} [{x_unit}]", **labels, "traces": first}]
    if band is not None and over_energy:
        u, u_unit = scale_of("J", float(band.abscissa[-1]))
        lines = []
        for number, path in paths.items():
            with suppress(InputError):  # it stopped before it dissipated anything
                energy, (load, *_) = path.over_energy()
                lines.append(_line(number, energy * u, load * y, *shade[number]))
        traces = _named_once(lines) + _band(band, u, y)
        views.append({"name": "over the dissipated energy", "x": f"dissipated energy [{u_unit}]", **labels})
        views[-1]["traces"] = traces
    return views


def _some(paths: Mapping[int, LoadPath]) -> dict[int, LoadPath]:
    """Evenly many of some curves."""
    numbers = list(paths)
    chosen = np.unique(np.linspace(0, len(numbers) - 1, min(len(numbers), MOST_LINES)).round().astype(int))
    return {numbers[k]: paths[numbers[k]] for k in chosen.tolist()}


def _shades(result: EnsembleResult) -> dict[int, tuple[str, str]]:
    """Name and colour of the curve of each run: by point of a study, else by whether it finished."""
    if result.plan.vary:
        points, known = result.plan.points, colours(len(result.plan.points))
        of = zip(result.runs["number"].tolist(), result.runs["point"].tolist(), strict=True)
        return {number: (points[k].label, known[k]) for number, k in of}
    status = zip(result.runs["number"].tolist(), result.runs["status"].tolist(), strict=True)
    return {k: ("runs", "--light") if ended == "finished" else ("stopped early", "--second") for k, ended in status}


def _line(number: int, x: Any, y: Any, name: str, colour: str) -> Trace:
    hover = f"run {number}<br>%{{x:.4g}}, %{{y:.4g}}<extra></extra>"
    line = {"color": colour, "width": 1}
    return {"x": x, "y": y, "mode": "lines", "name": name, "line": line, "opacity": 0.6, "hovertemplate": hover}


def _companion(path: LoadPath, x: float, y: float) -> Trace:
    line = {"color": "--ink", "width": 1.5, "dash": "dash"}
    return {"x": path.value * x, "y": path.load * y, "mode": "lines", "name": "deterministic", "line": line}


def _named_once(traces: list[Trace]) -> list[Trace]:
    """Curves of one name as one entry of the legend, which shows and hides all of them; names letter by letter."""
    seen: set[str] = set()
    for trace in traces:
        name = trace["name"]
        trace |= {"name": escape(name, quote=False), "legendgroup": name, "showlegend": name not in seen}
        seen.add(name)
    return traces


def _band(found: Band, x: float, y: float) -> list[Trace]:
    """Mean and percentiles; dashed and paler where not every run counts any more."""
    until = found.until
    traces: list[Trace] = []
    for part, alpha in ((slice(0, until), 0.35), (slice(until - 1, None), 0.15)):
        at = found.abscissa[part] * x
        if len(at) < 2:
            continue
        low, high = found.percentiles[0, part] * y, found.percentiles[2, part] * y
        whole = alpha > 0.3
        edge = {"width": 0, "color": "--accent"}
        around = {"x": np.concatenate([at, at[::-1]]), "y": np.concatenate([low, high[::-1]]), "fill": "toself"}
        around |= {"mode": "lines", "fillcolor": f"rgba(64, 128, 192, {alpha})", "line": edge, "hoverinfo": "skip"}
        traces.append(around | {"name": "5 % to 95 %", "legendgroup": "band", "showlegend": whole})
        name = "mean" if whole else f"mean of those left (at least {int(found.count.min())})"
        line = {"color": "--accent", "width": 2.5, "dash": "solid" if whole else "dash"}
        traces.append({"x": at, "y": found.mean[part] * y, "mode": "lines", "name": name, "line": line})
    return traces


def _starts(result: EnsembleResult) -> Marks | None:
    """Where cracks started, with the peak loads of their runs; None where nothing started."""
    runs = result.runs
    places = np.stack([runs[f"crack_start_{axis}_m"] for axis in "xyz"], axis=1)
    peaks = np.abs(runs["peak_load_N"])
    known = np.isfinite(places).all(axis=1) & np.isfinite(peaks)
    if not known.any():
        return None
    factor, unit = scale_of("N", float(peaks[known].max()))
    return "starts", places[known], factor * peaks[known], f"peak load of the run [{unit}]"
