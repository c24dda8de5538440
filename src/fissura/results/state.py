"""States as ``.npz``, to be looked at again without running: the last one, and others that were saved."""

from pathlib import Path
from typing import Any

import numpy as np

from fissura.errors import InputError
from fissura.files.archive import read_archive, write_archive
from fissura.simulation.step import Moment, Snapshot, Step
from fissura.tessellation.tessellation import Contacts, Polygons, SurfaceFacets, Tessellation

LAST = "state_last.npz"
"""Name of the file of the last state."""

FORMAT = "fissura-state"
FORMAT_VERSION = 1

FIELDS = ("displacement", "stress", "criterion", "strain", "traction", "tangents", "damage", "opening")
OPTIONAL = ("body_factor", "contact_factor")  # only of runs with a random field
BODIES = ("nucleus", "x", "fine", "volume")
CONTACTS = ("bodies", "area", "centroid", "normal", "length", "fine")
SURFACE = ("body", "area", "centroid", "normal", "surface", "names")
POLYGONS = ("points", "offsets", "facet")


def write_state(path: Path, step: Step | Moment) -> None:
    """Write the state of a step.

    The archive holds ``format``, ``format_version``, ``step``, ``gauge`` [m], ``load`` [N], the fields of
    `Snapshot` under their names, and the tessellation as ``bodies.*``, ``contacts.*``,
    ``contacts.polygons.*``, ``surface.*`` and ``surface.polygons.*``.
    """
    snapshot = step.snapshot
    tessellation = snapshot.tessellation
    arrays: dict[str, Any] = {
        "step": step.number,
        "gauge": step.gauge,
        "load": step.load,
    }
    for prefix, owner, names in (
        ("", snapshot, FIELDS),
        ("bodies.", tessellation, BODIES),
        ("contacts.", tessellation.contacts, CONTACTS),
        ("contacts.polygons.", tessellation.contacts.polygons, POLYGONS),
        ("surface.", tessellation.surface, SURFACE),
        ("surface.polygons.", tessellation.surface.polygons, POLYGONS),
    ):
        arrays.update({prefix + name: np.asarray(getattr(owner, name)) for name in names})
    arrays.update({name: value for name in OPTIONAL if (value := getattr(snapshot, name)) is not None})
    write_archive(path, FORMAT, FORMAT_VERSION, arrays)


def read_state(path: str | Path) -> tuple[int, Snapshot]:
    """Read a state that `write_state` wrote.

    Returns
    -------
    step : int
        Number of the step.
    snapshot : Snapshot
        Its state.

    Raises
    ------
    InputError
        The file is missing, is something else, or is newer than this version of Fissura.
    """
    key, allowed = str(path), f"a {FORMAT} file of version 1 to {FORMAT_VERSION}"
    arrays = read_archive(path, FORMAT, FORMAT_VERSION)
    try:
        tessellation = Tessellation(
            **_part(arrays, "bodies.", BODIES),
            contacts=Contacts(
                **_part(arrays, "contacts.", CONTACTS),
                polygons=Polygons(**_part(arrays, "contacts.polygons.", POLYGONS)),
            ),
            surface=SurfaceFacets(
                **_part(arrays, "surface.", SURFACE[:-1]),
                names=tuple(str(name) for name in arrays["surface.names"]),
                polygons=Polygons(**_part(arrays, "surface.polygons.", POLYGONS)),
            ),
        )
        present = tuple(name for name in OPTIONAL if name in arrays)
        fields = _part(arrays, "", FIELDS + present)
        return int(arrays["step"]), Snapshot(tessellation=tessellation, **fields)
    except KeyError as error:
        raise InputError(key, f"lacks the array {error}", allowed) from None
    except (IndexError, TypeError, ValueError) as error:
        raise InputError(key, f"is damaged ({error})", allowed) from None


def state_file(number: int) -> str:
    """Name of the file of a step that is not the last one."""
    return f"state_{number:04d}.npz"


def read_states(folder: Path) -> dict[int, Snapshot]:
    """Read all states in a folder, by the numbers of their steps.

    Raises
    ------
    InputError
        A file is damaged or newer than this version of Fissura.
    """
    named = sorted(path for path in folder.glob("state_*.npz") if path.stem.removeprefix("state_").isdecimal())
    found = dict(read_state(path) for path in (*named, folder / LAST) if path.exists())
    return dict(sorted(found.items()))


def _part(arrays: dict[str, Any], prefix: str, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: arrays[prefix + name] for name in names}
