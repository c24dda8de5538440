"""Contact laws by the name that a case file gives: those of Fissura, and those of other packages.

Cases are read with this module, so it imports no room; a law is imported when it is asked for.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any

from fissura.errors import InputError

if TYPE_CHECKING:
    from pydantic import BaseModel

    from fissura.contact import ContactLaw

__all__ = ["BUILT_IN", "GROUP", "LAWS", "known_laws", "law_named", "parameters_of"]

#: Entry points by which other packages offer laws.
GROUP = "fissura.laws"

#: Module and class of the laws of Fissura, by name.
BUILT_IN: dict[str, tuple[str, str]] = {
    "cusatis-cedolin": ("fissura.contact.law", "CusatisCedolin"),
    "cusatis-cedolin-closing": ("fissura.contact.closing", "ClosingCusatisCedolin"),
    "cusatis-cedolin-two-energies": ("fissura.contact.two_energies", "TwoEnergies"),
}

#: Those of them all of whose constants are in ``[material]``: a case with one of these is read without its code.
_WITHOUT_TABLE = ("cusatis-cedolin", "cusatis-cedolin-closing")

#: Laws that a program has added for itself, by name: ``LAWS["mine"] = Mine``. Other processes do not know them.
LAWS: dict[str, type[ContactLaw]] = {}

_KEY = "material.law"

#: What a law must have before any contact is known.
_METHODS = (
    *("create", "limits", "initial_history", "damage", "intact", "unloaded", "loading"),
    *("response", "tangent", "utilisation"),
)


def _offered(name: str | None = None) -> list[EntryPoint]:
    """Entry points of a name, or all of them."""
    found = entry_points(group=GROUP)
    return list(found if name is None else found.select(name=name))


def known_laws() -> tuple[str, ...]:
    """Names of all laws that a case file may give."""
    return tuple(sorted({*BUILT_IN, *LAWS, *(point.name for point in _offered())}))


def law_named(name: str) -> type[ContactLaw]:
    """The law of a name.

    Raises
    ------
    InputError
        There is none, several packages offer one, or the package that does so cannot be imported or offers something
        else.
    """
    if name in LAWS:
        return LAWS[name]
    if name in BUILT_IN:
        module, attribute = BUILT_IN[name]
        law: type[ContactLaw] = getattr(import_module(module), attribute)
        return law
    points = _offered(name)
    if not points:
        raise InputError(_KEY, f"{name!r} is not known", ", ".join(known_laws()))
    if len({point.value for point in points}) > 1:
        owners = " and ".join(sorted({_owner(point) for point in points}))
        raise InputError(_KEY, f"{name!r} is offered by {owners}", "one of these packages installed")
    return _loaded(points[0])


def _owner(point: EntryPoint) -> str:
    """Package that has an entry point."""
    return point.dist.name if point.dist is not None else point.module


def _loaded(point: EntryPoint) -> type[ContactLaw]:
    """The law behind an entry point."""
    allowed = f"a package {_owner(point)} that works with this version, or another law"
    try:
        law: Any = point.load()
    except Exception as error:  # the code is not ours: it may raise anything
        problem = (
            f"{point.name!r} of {_owner(point)} cannot be imported ({point.value}): {type(error).__name__}: {error}"
        )
        raise InputError(_KEY, problem, allowed) from error
    missing = [name for name in _METHODS if not callable(getattr(law, name, None))]
    if missing or not isinstance(law, type):
        what = f"lacks {', '.join(missing)}" if isinstance(law, type) else "is not a class"
        raise InputError(_KEY, f"{point.name!r} of {_owner(point)} is no contact law: {point.value} {what}", allowed)
    return law


def parameters_of(name: str) -> type[BaseModel] | None:
    """Model of the table ``[material.NAME]`` of a law; None where it has none.

    Raises
    ------
    InputError
        See :func:`law_named`.
    """
    if name in _WITHOUT_TABLE and name not in LAWS:
        return None
    model: type[BaseModel] | None = getattr(law_named(name), "Parameters", None)
    return model
