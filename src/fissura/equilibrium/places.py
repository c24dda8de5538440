"""Whether loads and gauges can do anything, given the bodies that own their places."""

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import limits
from fissura.equilibrium.attach import attach_rows, owners_of
from fissura.errors import InputError
from fissura.specimen import Conditions
from fissura.tessellation import Bodies


def check_places(conditions: Conditions, bodies: Bodies, arm: float, *, start: bool) -> None:
    """Refuse what no calculation can mend: a gauge that measures nothing, a load that supports take over.

    Parameters
    ----------
    conditions : Conditions
        Supports, loads and gauges.
    bodies : Tessellation or Nuclei
        Rigid bodies.
    arm : float
        Length by which moments compare with forces [m].
    start : bool
        Whether these are the bodies of a start that is coarse, so that finer ones may help. A gauge that is only
        recorded may become one that measures something then.

    Raises
    ------
    InputError
        There is one body only; both ends of the gauge lie on one body; supports hold the bodies of the gauge or of the
        load.
    """
    if len(bodies) < 2:
        key, what = ("discretization.l_c", "the start") if start else ("discretization.l_f", "the specimen")
        raise InputError(key, f"{what} is a single rigid body", "a smaller spacing")
    leading = {drive.gauge for drive in conditions.drives if drive.quantity == "gauge"}
    gauges = [k for k in range(len(conditions.gauges)) if k in leading or not start]
    # What acts on platens acts on many bodies, whatever these are.
    loads = [load for load in conditions.loads if load.platen is None]
    keys = [key for key, load in zip(conditions.load_keys, conditions.loads, strict=False) if load.platen is None]
    held = [support for support in conditions.supports if support.platen is None]
    functionals = (*loads, *held, *(conditions.gauges[k] for k in gauges))
    if not functionals:
        return
    body = owners_of(functionals, bodies)
    rows = attach_rows(functionals, bodies, body)
    used = np.unique(rows.indices)
    dense = rows[:, used].toarray() / np.where(used % 6 < 3, 1.0, arm)
    supports = dense[len(loads) : len(loads) + len(held)]
    finer = ", or bodies that are fine there from the start (adaptivity.regions, discretization.l_c)" if start else ""
    when = " at the start" if start else ""
    ends = np.cumsum([len(f.points) for f in functionals])
    for row, k in enumerate(gauges, len(loads) + len(held)):
        gauge, key, measured = conditions.gauges[k], conditions.gauge_keys[k], dense[row]
        owner = body[ends[row] - len(gauge.points) : ends[row]]
        most = np.abs(gauge.coefficients).sum()
        if (owner == owner[0]).all() or np.linalg.norm(measured) <= limits.NO_VALUE * most:
            raise InputError(
                key,
                f"both of its ends lie on one rigid body{when}, so that it measures nothing",
                f"ends farther apart than two bodies, or on both sides of a notch{finer}",
            )
        if _spanned(measured, supports):
            raise InputError(key, f"supports hold both of its ends{when}", f"places that can move{finer}")
    for key, load in zip(keys, dense[: len(loads)], strict=True):
        if _spanned(load, supports):
            raise InputError(
                key, f"acts on bodies that the supports hold{when}, and moves nothing", f"a place beside them{finer}"
            )


def _spanned(row: FloatArray, supports: FloatArray) -> bool:
    """Whether a functional vanishes wherever the supports do, given their coefficients in rows."""
    share = np.linalg.lstsq(supports.T, row)[0]
    return bool(np.linalg.norm(row - share @ supports) <= limits.NO_VALUE * np.linalg.norm(row))
