"""The page of a run."""

import base64
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.case.registry import PICTURES
from fissura.errors import InputError
from fissura.pictures.meshes import steps_with_states
from fissura.pictures.plotting import column_title
from fissura.pictures.registered import drawn
from fissura.pictures.specimen_signs import signs_of
from fissura.reports.bodies import shown_steps, states_of
from fissura.reports.libraries import require_libraries
from fissura.reports.origin import bibtex, bound_told, cited, origin_rows, seed_told, status_told
from fissura.reports.page import rendered
from fissura.reports.view import scene_of
from fissura.results.curve import COLUMN_OF, TEXTS
from fissura.results.measured import read_measured
from fissura.results.result import Result
from fissura.specimen import Domain, domain_from_case
from fissura.text import quantities as text
from fissura.text.units import scale_of, split_unit


def run_page(result: Result) -> str:
    """Make the page of a run.

    Parameters
    ----------
    result : Result
        Any run, also one that did not finish, or left no states.

    Raises
    ------
    InputError
        The extra ``report`` is not installed.
    """
    require_libraries()
    domain, notices = _domain(result)
    states, told = _states(result)
    scene = None if domain is None else scene_of(result.case, domain, states)
    status = status_told(result)
    values = {
        "title": result.case.name,
        "subtitle": _subtitle(result),
        "notices": [*([status] if status else []), *notices, *([] if result.steps else ["The run has no steps."])],
        "warnings": list(result.summary.get("warnings") or ()),
        "has_curve": result.steps > 0,
        "has_view": scene is not None,
        "has_states": bool(states),
        "view_caption": told,
        "signs": [] if domain is None else signs_of(result.case, domain).legend,
        "pictures": _pictures(result) if result.steps else [],
        "numbers": result.table(),
        "origin": [*origin_rows(result.summary, seed_told(result)), *_folder_name(result)],
        "bound": bound_told(result),
        "source": result.case.source or _source(result),
        "resolved": json.dumps(result.case.model_dump(mode="json", exclude={"source"}), indent=1, ensure_ascii=False),
        "cite": cited(result),
        "bibtex": bibtex(result),
    }
    if not result.steps:
        return rendered("run.html", values)
    data = {"kind": "run", "curve": _columns(result), "measured": _measured(result), "scene": scene}
    return rendered("run.html", values, data)


def _pictures(result: Result) -> list[dict[str, str]]:
    """Pictures that packages and programs have added."""
    return [
        {"caption": picture.caption, "text": picture.text, "data": base64.b64encode(data).decode()}
        for _, picture, data in drawn(PICTURES, result)
        if data is not None
    ]


def _states(result: Result) -> tuple[list[dict[str, Any]], str]:
    """States for the 3D view, and what to say of them."""
    recorded = steps_with_states(result)
    if not recorded:
        return (
            [],
            "The specimen before the run, which left no states: output.vtk is 0, or the run was killed.",
        )
    states = states_of(result, shown_steps(result))
    if not states:
        return [], "The specimen before the run: its bodies do not fit into a page of 15 MB."
    told = (
        f"{text.counted(len(states), 'step')} of {result.steps}, those whose states were recorded; a larger output.vtk"
        " in the case records more. Drawn are the outer faces of bodies and the contacts with damage, where the mean of"
        " their two bodies is."
    )
    if len(states) < len(recorded):
        told += f" {len(recorded) - len(states)} more recorded steps were left out, to keep this page small."
    hidden = sum(state["cracks"]["left_out"] for state in states)
    if hidden:
        told += f" {text.count(hidden)} of the facets with damage, those that opened least, were left out likewise."
    return states, told


def _domain(result: Result) -> tuple[Domain | None, list[str]]:
    """The specimen; None, and why, where a file that describes it is gone."""
    try:
        return domain_from_case(result.case), []
    except InputError as error:
        return None, [f"The specimen cannot be drawn: {error}"]


def _folder_name(result: Result) -> list[tuple[str, str]]:
    return [] if result.folder is None else [("folder", result.folder.resolve().name)]


def _subtitle(result: Result) -> str:
    kind = "at full resolution" if result.full else "adaptive"
    parts = [f"{kind}, {text.counted(result.steps, 'step')}"]
    if result.steps:
        parts.append(f"peak load {text.force(result.peak_load)}")
    return ", ".join(parts) + "."


def _source(result: Result) -> str | None:
    """The case as it was written, where the folder has it."""
    if result.folder is None:
        return None
    try:
        return (result.folder / "case.toml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None


def _columns(result: Result) -> dict[str, Any]:
    """All columns of numbers, the unloaded state in front.

    Returns
    -------
    dict
        ``columns``: a list of ``name``, ``title`` (with the unit), ``unit`` and ``values``, (steps + 1,); ``steps``:
        numbers of the steps, 0 for the unloaded state; ``x`` and ``y``: names of the columns that are shown first.
    """
    columns = []
    for name, values in result.curve.items():
        if name in TEXTS:
            continue
        numbers = values.astype(np.float64)
        unit = split_unit(name)[1]
        factor, shown = scale_of(unit, _largest(numbers)) if unit else (1.0, "")
        title = column_title(result.case, name)
        columns.append(
            {
                "name": name,
                "title": f"{title} [{shown}]" if shown else title,
                "unit": shown,
                "values": np.concatenate([[0.0 if unit else np.nan], factor * numbers]),
            }
        )
    return {
        "columns": columns,
        "steps": np.concatenate([[0], result.curve["step"]]).astype(np.int32),
        "x": COLUMN_OF[result.case.quantity],
        "y": "load_N",
    }


def _measured(result: Result) -> dict[str, Any] | None:
    """Measured loads over the gauge in the units of the columns; None where there are none, or they cannot be read."""
    path = result.case.output.measured
    if path is None or not result.steps:
        return None
    try:
        band = read_measured(path)
    except InputError:
        return None
    x = scale_of("m", _largest(result.gauge))[0]
    y = scale_of("N", _largest(result.load_values))[0]
    return {"x": x * band.gauge, "lower": y * band.lower, "upper": y * band.upper}


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
