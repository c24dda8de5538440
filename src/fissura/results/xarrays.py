"""Curves and fields over steps as datasets of xarray, where that is installed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.simulation.step import Snapshot
from fissura.text.units import split_unit

if TYPE_CHECKING:
    from fissura.results.run_data import RunData

Fields = Literal["curve", "bodies", "contacts"]
"""What there are datasets of."""

UNITS = {"Nm": "N m"}
"""Units that names of columns write otherwise."""

Variables = dict[str, tuple[tuple[str, ...], str, NDArray[Any]]]
"""Name of a variable -> its dimensions after the step, its unit, its values at one step."""


def dataset_of(result: RunData, what: Fields) -> Any:
    """Make a dataset; see `Result.to_xarray`."""
    try:
        xarray = import_module("xarray")
    except ImportError:
        raise InputError("xarray", "is not installed; datasets need it", "pip install xarray") from None
    if what not in get_args(Fields):
        raise InputError("what", f"{what!r} is not known", ", ".join(get_args(Fields)))
    about = {"case": result.case.name, "seed": result.case.seed, "full": int(result.full)}
    if what == "curve":
        return xarray.Dataset(_columns(result), {"step": result.curve["step"]}, about)
    if not result.snapshots:
        raise InputError(str(result.folder or result.case.name), "has no states of steps")
    shots = list(result.snapshots.values())
    variables, coordinates = _bodies(shots) if what == "bodies" else _contacts(shots)
    return xarray.Dataset(variables, {"step": list(result.snapshots), **coordinates}, about)


def _columns(result: RunData) -> dict[str, Any]:
    found = {}
    stems = Counter(split_unit(column)[0] for column in result.curve)
    for column, values in result.curve.items():
        stem, unit = split_unit(column)
        if column != "step":
            name = stem if stems[stem] == 1 else column  # forces and moments may differ in their units only
            found[name] = ("step", values, {"units": UNITS.get(unit, unit)} if unit else {})
    return found


def _bodies(shots: list[Snapshot]) -> tuple[dict[str, Any], dict[str, Any]]:
    nuclei = np.unique(np.concatenate([shot.tessellation.nucleus for shot in shots]))
    rows = [np.searchsorted(nuclei, shot.tessellation.nucleus) for shot in shots]
    x = np.empty((len(nuclei), 3))
    for shot, row in zip(shots, rows, strict=True):
        x[row] = shot.tessellation.x
    variables = [_body_variables(shot) for shot in shots]
    coordinates = {"nucleus": nuclei, "axis": list("xyz"), "x": (("nucleus", "axis"), x, {"units": "m"})}
    return _joined(variables, rows, "nucleus", len(nuclei)), coordinates


def _body_variables(shot: Snapshot) -> Variables:
    found: Variables = {
        "displacement": (("axis",), "m", shot.displacement[:, :3]),
        "rotation": (("axis",), "rad", shot.displacement[:, 3:]),
        "stress": (("axis", "axis_of_traction"), "Pa", shot.stress),
        "largest_principal_stress": ((), "Pa", np.linalg.eigvalsh(shot.stress)[:, -1]),
        "criterion": ((), "", shot.criterion),
        "fine": ((), "", shot.tessellation.fine),
        "volume": ((), "m^3", shot.tessellation.volume),
    }
    if shot.body_factor is not None:
        found["strength_factor"] = ((), "", shot.body_factor)
    return found


def _contacts(shots: list[Snapshot]) -> tuple[dict[str, Any], dict[str, Any]]:
    joined = [shot.tessellation.nucleus[shot.tessellation.contacts.bodies] for shot in shots]
    ordered = np.sort(np.concatenate(joined), axis=1)
    pairs, number = np.unique(ordered, axis=0, return_inverse=True)
    rows = np.split(number.ravel(), np.cumsum([len(some) for some in joined])[:-1])
    variables = [_contact_variables(shot) for shot in shots]
    coordinates = {
        "direction": list("NML"),
        "axis": list("xyz"),
        **{f"nucleus_{name}": ("contact", pairs[:, k]) for k, name in enumerate("ab")},
    }
    return _joined(variables, rows, "contact", len(pairs)), coordinates


def _contact_variables(shot: Snapshot) -> Variables:
    contacts = shot.tessellation.contacts
    found: Variables = {
        "opening": ((), "m", shot.opening),
        "damage": ((), "", shot.damage),
        "strain": (("direction",), "", shot.strain),
        "traction": (("direction",), "Pa", shot.traction),
        "fine": ((), "", contacts.fine),
        "length": ((), "m", contacts.length),
        "area": ((), "m^2", contacts.area),
        "centroid": (("axis",), "m", contacts.centroid),
    }
    if shot.contact_factor is not None:
        found["strength_factor"] = ((), "", shot.contact_factor)
    return found


def _joined(steps: list[Variables], rows: list[NDArray[Any]], dimension: str, count: int) -> dict[str, Any]:
    """Variables over all steps: the values of a step stand in its rows, nan everywhere else."""
    found: dict[str, Any] = {}
    for name, (more, unit, first) in steps[0].items():
        values = np.full((len(steps), count, *first.shape[1:]), np.nan)
        for k, (step, row) in enumerate(zip(steps, rows, strict=True)):
            values[k, row] = step[name][2]
        attributes: Mapping[str, str] = {"units": unit} if unit else {}
        found[name] = (("step", dimension, *more), values, attributes)
    return found
