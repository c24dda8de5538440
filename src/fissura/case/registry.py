"""What a case names: laws, criteria, shapes, gauges, solvers, pictures, and where the code of each name is.

Each kind is a `Registry`: entries of Fissura, of other packages (entry points), and of the running program. Cases are
read with this module, so it imports no room; what is behind a name is imported when it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fissura.case.named import Registry, table_of

if TYPE_CHECKING:
    from fissura.contact import ContactLaw
    from fissura.pictures.registered import Picture

#: What a law must have before any contact is known.
_LAW = (
    *("create", "limits", "initial_history", "damage", "intact", "unloaded", "loading"),
    *("response", "tangent", "utilisation"),
)


def _no_law(thing: Any) -> str:
    if not isinstance(thing, type):
        return "is not a class"
    missing = [name for name in _LAW if not callable(getattr(thing, name, None))]
    return f"lacks {', '.join(missing)}" if missing else ""


def _no_table(thing: Any) -> str:
    if not callable(thing):
        return "cannot be called"
    return "" if table_of(thing) else "has no table: no class derived from fissura.case.Part as type of its argument"


LAWS: Registry[type[ContactLaw]] = Registry(
    "contact law",
    "material.law",
    "fissura.laws",
    {
        "cusatis-cedolin": "fissura.contact.law:CusatisCedolin",
        "cusatis-cedolin-closing": "fissura.contact.closing:ClosingCusatisCedolin",
        "cusatis-cedolin-two-energies": "fissura.contact.two_energies:TwoEnergies",
    },
    plain=("cusatis-cedolin", "cusatis-cedolin-closing"),
    wrong=_no_law,
)
"""Contact laws: classes with what `fissura.contact.ContactLaw` has; ``Parameters`` is the model of their table."""

CRITERIA: Registry[Callable[[Any], Any]] = Registry(
    "refinement criterion",
    "adaptivity.criterion",
    "fissura.criteria",
    {
        "rankine": "fissura.adaptivity.criterion:rankine",
        "utilisation": "fissura.adaptivity.criterion:utilisation",
    },
)
"""Refinement criteria: functions from an `ElasticState` to one value per body, 1 at its strength."""

SOLVERS: Registry[Callable[..., Any]] = Registry(
    "linear solver",
    "solver.linear",
    "fissura.solvers",
    {
        "amg": "fissura.linear.symmetric:aggregation",
        "direct": "fissura.linear.symmetric:direct",
        "two-level": "fissura.linear.two_level:TwoLevel",
    },
)
"""Linear solvers: what makes a `LinearSolver` of a `Pattern`, nuclei (n, 3), a relative error in the energy norm, and
`threads`, which it may leave unused."""

SUPPORTS: Registry[Callable[[Any, str], list[Any]]] = Registry(
    "kind of support",
    "supports.type",
    "fissura.supports",
    {name: f"fissura.specimen.supports:{name}" for name in ("clamp", "guide", "pin", "roller")},
)
"""Kinds of support: functions from a `Place`, and its key for messages, to functionals that are held at zero."""

SHAPES: Registry[Callable[[Any, float], Any]] = Registry(
    "shape",
    "specimen.shape",
    "fissura.shapes",
    {name: f"fissura.specimen.build:{name}_of" for name in ("box", "cylinder", "mesh", "outline")},
    plain=("box", "outline", "cylinder", "mesh"),
    wrong=_no_table,
)
"""Shapes: functions of their table, whose name is theirs, and the spacing of fine nuclei [m] to a `Solid`, or to that
and notices. Those of Fissura have their keys in ``[specimen]`` itself."""

GAUGES: Registry[Callable[[Any, Any], Any]] = Registry(
    "kind of gauge",
    "gauge",
    "fissura.gauges",
    {"opening": "fissura.specimen.gauge_kinds:opening"},
    plain=("opening",),
    wrong=_no_table,
)
"""Kinds of gauge: functions of their table, whose name is theirs, and of `Places`, to a `Functional`. That of Fissura
has its keys in ``[gauge]`` itself."""


def _no_picture(thing: Any) -> str:
    missing = [name for name in ("draw", "caption", "text") if not hasattr(thing, name)]
    return f"lacks {', '.join(missing)}" if missing else ""


PICTURES: Registry[Picture] = Registry("picture of a run", "picture", "fissura.pictures", {}, wrong=_no_picture)
"""Pictures for the page of a run, which draw a `Result`."""

ENSEMBLE_PICTURES: Registry[Picture] = Registry(
    "picture of an ensemble",
    "picture",
    "fissura.ensemble_pictures",
    {
        name: f"fissura.ensemble.pictures:{name.upper()}"
        for name in (
            *("curves", "curves_by_value", "peaks_by_value", "peaks", "papers"),
            *("crack_starts", "convergence"),
        )
    },
    wrong=_no_picture,
)
"""Pictures for the page of an ensemble, which draw an `EnsembleResult`."""
