"""Bodies and cracks of some steps as arrays for the 3D view of a page.

Drawn are the faces of bodies on the surface of the specimen, and the contacts with damage; all other contacts stay out
of sight anyway. Positions are kept in 16 bits for each axis, displacements in 16 bits of the largest of a step.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.pictures.meshes import meshes_of, steps_with_states
from fissura.pictures.result_window import skin_of
from fissura.reports.packed import packed_size, quantised
from fissura.results.result import Result

MOST_BYTES = 9_000_000
"""Letters that bodies and cracks of all steps may take in a page; libraries and curves come on top."""

MOST_STEPS = 60
"""Steps in a page, at most."""

ROOM = 1.3
"""States to read over those that would fit if they were as large as the last one."""

MM = 1e3
"""Views are in mm."""

State = dict[str, Any]


def shown_steps(result: Result) -> list[int]:
    """Steps whose states are recorded, at most `MOST_STEPS`: evenly over the dissipated energy, with peak and last."""
    return chosen(result, steps_with_states(result), MOST_STEPS)


def states_of(result: Result, steps: Iterable[int], most: int = MOST_BYTES) -> list[State]:
    """States of steps; fewer of them, or fewer cracks in them, where they would take more than they may.

    Parameters
    ----------
    result : Result
        A run.
    steps : iterable of int
        Steps with recorded states.
    most : int, optional
        Letters that all of them may take in a page.

    Returns
    -------
    list of dict
        For each step ``number``, ``skin`` and ``cracks``: polygons with ``points`` and ``moved`` (quantised, in mm,
        flat), ``sizes`` (corners of each), and values by name. ``left_out`` is how many contacts with damage are not
        there, those that opened least.
    """
    *before, last = steps
    states = [_state(result, last)]
    # The last state is the largest, or about that: what cannot fit is not even read.
    fit = int(ROOM * most / packed_size(states)) + 1
    states = [_state(result, number) for number in chosen(result, [*before, last], fit) if number != last] + states
    while (size := packed_size(states)) > most and len(states) > 1:
        kept = set(chosen(result, [state["number"] for state in states], max(int(0.9 * len(states) * most / size), 1)))
        states = [state for state in states if state["number"] in kept]
    while packed_size(states) > most and len(states[0]["cracks"]["sizes"]) > 1:
        states[0]["cracks"] = _widest_half(states[0]["cracks"])
    return states if packed_size(states) <= most else []


def chosen(result: Result, steps: Sequence[int], most: int) -> list[int]:
    """Choose steps evenly over the dissipated energy; the last one, and that of the peak, are among them.

    Parameters
    ----------
    result : Result
        The run.
    steps : sequence of int
        Steps to choose from, ascending.
    most : int
        How many to choose, 1 or more.
    """
    if len(steps) <= most:
        return list(steps)
    row = {int(number): k for k, number in enumerate(result.curve["step"])}
    energy = np.array([result.curve["dissipated_J"][row[number]] if number in row else 0.0 for number in steps])
    load = np.array([abs(result.curve["load_N"][row[number]]) if number in row else 0.0 for number in steps])
    # Where nothing is dissipated, the number of the step tells them apart.
    way = np.linspace(0.0, 1.0, len(steps)) + 9.0 * energy / max(float(np.abs(energy).max()), 1e-300)
    kept = [len(steps) - 1, int(np.argmax(load))][:most]
    while len(set(kept)) < most:
        # The step farthest from those that are kept, so that gaps between them are alike.
        gap = np.abs(way[:, None] - way[kept][None, :]).min(axis=1)
        gap[kept] = -1.0
        kept.append(int(np.argmax(gap)))
    return [steps[k] for k in sorted(set(kept))]


def _state(result: Result, number: int) -> State:
    meshes = meshes_of(result, number)
    bodies, cracks = meshes["bodies"], meshes["cracks"]
    skin = _polygons(skin_of(bodies))
    fine, stress = _values(skin, "fine"), _values(skin, "largest_principal_stress")
    skin["faces"] |= {"fine": fine.astype(np.uint8), "stress": _in_16_bits(1e-6 * stress)}
    torn = _polygons(cracks)
    opening, damage = 1e6 * _values(torn, "opening"), _values(torn, "damage")
    torn["faces"] |= {"opening": quantised(opening, 0.0, float(opening.max(initial=0.0)))}
    torn["faces"] |= {"damage": quantised(damage, 0.0, 1.0)}
    return {"number": number, "skin": skin["faces"], "cracks": torn["faces"] | {"left_out": 0}}


def _polygons(mesh: Any) -> dict[str, Any]:
    """Polygons of a mesh with corners of their own, and where to find their values."""
    corner = np.asarray(mesh.cell_connectivity, np.int64) if mesh.n_cells else np.zeros(0, np.int64)
    sizes = np.diff(np.asarray(mesh.cell_offsets)) if mesh.n_cells else np.zeros(0, np.int64)
    points = MM * np.asarray(mesh.points, np.float64)[corner].reshape(-1, 3)
    moved = MM * np.asarray(mesh.point_data["displacement"] if len(corner) else points, np.float64)[corner]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    axes = [quantised(points[:, k], float(low[k]), float(high[k])) for k in range(3)]
    most = float(np.abs(moved).max(initial=0.0))
    faces = {
        "sizes": sizes.astype(np.uint16),
        "points": axes,
        "moved": [quantised(moved[:, k], -most, most) for k in range(3)] if most > 0.0 else None,
    }
    return {"faces": faces, "mesh": mesh}


def _values(polygons: dict[str, Any], name: str) -> FloatArray:
    """Values of polygons, shape (q,)."""
    mesh = polygons["mesh"]
    return np.asarray(mesh.cell_data[name], np.float64) if mesh.n_cells else np.zeros(0)


def _in_16_bits(values: FloatArray) -> dict[str, Any]:
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    return quantised(values, low, high)


def _widest_half(cracks: dict[str, Any]) -> dict[str, Any]:
    """The half of some polygons that opened most."""
    opening, sizes = cracks["opening"]["codes"], cracks["sizes"]
    kept = np.zeros(len(sizes), bool)
    kept[np.argsort(opening, kind="stable")[len(sizes) - len(sizes) // 2 :]] = True
    corners = np.repeat(kept, sizes)

    def part(values: dict[str, Any], which: BoolArray) -> dict[str, Any]:
        return values | {"codes": values["codes"][which]}

    return {
        "sizes": sizes[kept],
        "points": [part(axis, corners) for axis in cracks["points"]],
        "moved": None if cracks["moved"] is None else [part(axis, corners) for axis in cracks["moved"]],
        "opening": part(cracks["opening"], kept),
        "damage": part(cracks["damage"], kept),
        "left_out": cracks["left_out"] + int((~kept).sum()),
    }
