"""The fine nuclei of a specimen: its identity at every resolution (theory section 5)."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.case.files import check_file, read_text
from fissura.errors import InputError
from fissura.tessellation.mirror import MirrorZones, mirror_zones
from fissura.tessellation.placement import place

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.specimen import Box

__all__ = ["Nuclei", "nuclei_from_case", "read_nuclei"]

_KEY = "discretization.nuclei"

#: Distance in spacings within which two nuclei are the same but for round-off.
_SAME = 1e-6

#: Largest files that are read.
_MOST_BYTES, _MOST_BYTES_OF_TEXT = 2_000_000_000, 100_000_000


@dataclass(frozen=True)
class Nuclei:
    """All fine nuclei of a specimen, placed once.

    Attributes
    ----------
    x : (n, 3) array
        Positions [m].
    priority : (n,) array
        Fixed random rank, 0 first; mirrored twins share theirs.
    twin : (n,) array
        Index of the mirror image, -1 for none.
    spacing : float
        Smallest distance ``l_f`` [m].
    widest : (n,) array
        Largest spacing at each nucleus with which notches can be represented [m], infinite far from them.
    given : int
        How many of them a file gave; the others were added.
    """

    x: NDArray[np.float64]
    priority: NDArray[np.int64]
    twin: NDArray[np.int64]
    spacing: float
    widest: NDArray[np.float64]
    given: int = 0

    def __len__(self) -> int:
        return len(self.x)

    @classmethod
    def placed(
        cls,
        box: Box,
        l_f: float,
        zones: MirrorZones,
        rng: np.random.Generator,
        given: NDArray[np.float64] | None = None,
    ) -> Nuclei:
        """Saturate a box with nuclei and give each a random priority; arguments as for :func:`place`."""
        x, twin = place(box, l_f, zones, rng, given)
        priority = rng.permutation(len(x))
        paired = twin >= 0
        priority[paired] = np.minimum(priority[paired], priority[twin[paired]])
        return cls(x, priority, twin, l_f, zones.widest(x))


def read_nuclei(path: Path) -> NDArray[np.float64]:
    """Read nuclei from a file: ``.npy`` with shape (n, 3), or text with ``x y z`` in metres on each line.

    Raises
    ------
    InputError
        Missing or unreadable file, wrong shape, values that are not finite.
    """
    key, allowed = _KEY, "x y z on each line, in m, or .npy of shape (n, 3)"
    x: NDArray[Any]
    try:
        with warnings.catch_warnings(action="ignore"):  # numpy warns of empty files; the shape tells as much
            if path.suffix == ".npy":
                check_file(path, key, allowed, _MOST_BYTES)
                x = np.lib.format.open_memmap(path, mode="r")  # takes no memory for what the file does not hold
            else:
                x = np.loadtxt(io.StringIO(read_text(path, key, allowed, _MOST_BYTES_OF_TEXT)), ndmin=2)
    except InputError:
        raise
    except Exception as error:  # NumPy raises many kinds for damaged files
        raise InputError(key, f"{path} does not hold numbers: {error}", allowed) from error
    if x.ndim != 2 or x.shape[1] != 3 or not len(x):
        raise InputError(key, f"{path} holds an array of shape {x.shape}", "one row of x y z per nucleus")
    if x.dtype.kind not in "iuf" or not np.isfinite(x).all():
        raise InputError(key, f"{path} holds values that are not finite numbers", "finite coordinates in m")
    return np.array(x, dtype=np.float64, order="C")


def nuclei_from_case(case: Case, box: Box) -> Nuclei:
    """Place the fine nuclei of a case's specimen, beginning with those of its nuclei file if there is one.

    Nuclei from a file stay where they are, and all of them are used; beside a notch they get mirrored twins. Gaps are
    filled up to saturation.

    Raises
    ------
    InputError
        A nuclei file that cannot be used, or notches too close to each other.
    """
    part = case.discretization
    rng = np.random.default_rng(np.random.SeedSequence(case.seed))
    zones = mirror_zones(box, part.l_f)
    if part.nuclei is None:
        return Nuclei.placed(box, part.l_f, zones, rng)
    given = read_nuclei(part.nuclei)
    margin = 1e-9 * max(box.size)  # round-off must not decide on which side of a face a nucleus lies
    outside = np.any((given <= margin) | (given >= np.asarray(box.size) - margin), axis=1) | ~box.contains(given)
    if outside.any():
        row = int(np.argmax(outside))
        raise InputError(
            _KEY,
            f"nucleus {row + 1} at {tuple(given[row].tolist())} m is not inside the specimen",
            f"coordinates between 0 and {box.size} m, outside of notches",
        )
    nuclei = replace(Nuclei.placed(box, part.l_f, zones, rng, given), given=len(given))
    _check_used(given, nuclei)
    return nuclei


def _check_used(given: NDArray[np.float64], nuclei: Nuclei) -> None:
    """Every given nucleus must be one of the specimen's.

    Raises
    ------
    InputError
        Some are not: they are closer than the spacing to others, or do not go with a notch.
    """
    distance, place = cKDTree(nuclei.x).query(given)
    used = np.zeros(len(given), bool)
    used[np.unique(place, return_index=True)[1]] = True  # of two at one place the first
    unused = np.flatnonzero(~used | (distance > _SAME * nuclei.spacing))
    if not len(unused):
        return
    row = int(unused[0])
    # It is one of the two nearest itself; a single nucleus has no other.
    gaps, others = (np.ravel(found) for found in cKDTree(given).query(given[row], k=2))
    near = next((k for k in range(2) if others[k] != row and gaps[k] < nuclei.spacing), None)
    if near is None:
        reason = (
            "is closer to the plane of a notch than l_f/2, or to the mirror image of another nucleus in it than l_f"
        )
    else:
        l_f = 1e3 * nuclei.spacing
        reason = f"is {1e3 * gaps[near]:.4g} mm from nucleus {others[near] + 1}, less than l_f = {l_f:.4g} mm"
    raise InputError(
        _KEY,
        f"{len(unused)} of {len(given)} nuclei cannot be used; nucleus {row + 1} at {tuple(given[row].tolist())} m"
        f" {reason}",
        "nuclei at least l_f apart, beside a notch mirror images of each other; leave others out, gaps are filled",
    )
