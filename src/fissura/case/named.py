"""Things by the name that a case gives: of Fissura, of other packages, and of the running program."""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar, get_type_hints

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from fissura.case.report import fail
from fissura.case.units import show
from fissura.errors import InputError

T = TypeVar("T")

#: Names are keys of tables and files, too.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")


class Registry(MutableMapping[str, T], Generic[T]):
    """Things of one kind by the name that a case gives.

    ``registry["mine"] = thing`` adds one for the running program; other processes do not know it. A package offers its
    own by entry points, which every process finds.

    Parameters
    ----------
    what : str
        What one of them is, for messages.
    key : str
        Where a case names one.
    group : str
        Entry points by which other packages offer them.
    built_in : mapping of str to str
        Those of Fissura: where the code is, ``module:attribute``.
    plain : collection of str, optional
        Those of them without a table of their own: a case with one of these is read without its code.
    wrong : callable, optional
        Tells what a thing lacks to be one of them; an empty text where nothing.

    Examples
    --------
    >>> from fissura.case.registry import CRITERIA
    >>> sorted(CRITERIA)
    ['rankine', 'utilisation']
    >>> CRITERIA["largest-shear"] = lambda state: abs(state.stress[:, 0, 1]) / state.strength
    >>> del CRITERIA["largest-shear"]
    """

    def __init__(
        self,
        what: str,
        key: str,
        group: str,
        built_in: Mapping[str, str],
        *,
        plain: tuple[str, ...] = (),
        wrong: Callable[[Any], str] = lambda thing: "" if callable(thing) else "cannot be called",
    ) -> None:
        self.what, self.key, self.group = what, key, group
        self._built_in, self._plain, self._wrong = dict(built_in), plain, wrong
        self._added: dict[str, T] = {}

    def __setitem__(self, name: str, thing: T) -> None:
        if not _NAME.fullmatch(name):
            raise InputError(
                self.key, f"{name!r} is no name", "a letter, then letters, digits, - and _, up to 40 of them"
            )
        wrong = self._wrong(thing)
        if wrong:
            raise InputError(self.key, f"{name!r} is no {self.what}: it {wrong}", f"a {self.what}")
        self._added[name] = thing

    def __delitem__(self, name: str) -> None:
        del self._added[name]

    def __iter__(self) -> Iterator[str]:
        others = {*self._added, *(point.name for point in self._offered())} - {*self._built_in}
        return iter([*self._built_in, *sorted(others)])

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return name in self._added or name in self._built_in or any(point.name == name for point in self._offered())

    def __getitem__(self, name: str) -> T:
        if name in self._added:
            return self._added[name]
        if name in self._built_in:
            module, attribute = self._built_in[name].split(":")
            found: T = getattr(import_module(module), attribute)
            return found
        points = [point for point in self._offered() if point.name == name]
        if not points:
            raise KeyError(name)
        if len({point.value for point in points}) > 1:
            owners = " and ".join(sorted({_owner(point) for point in points}))
            raise InputError(self.key, f"{name!r} is offered by {owners}", "one of these packages installed")
        return self._loaded(points[0])

    def named(self, name: str, key: str | None = None) -> T:
        """The thing of a name.

        Parameters
        ----------
        name : str
            As a case gives it.
        key : str, optional
            Where it does so.

        Raises
        ------
        InputError
            There is none, several packages offer one, or the package that does so cannot be imported or offers
            something else.
        """
        try:
            return self[name]
        except KeyError:
            raise InputError(key or self.key, f"{name!r} is not known", ", ".join(self)) from None

    def table(self, name: str) -> type[BaseModel] | None:
        """Model of the table that a case may have for a name; None where there is none.

        It is the attribute ``Parameters`` of a class, and the type of the first argument of a function.

        Raises
        ------
        InputError
            See :meth:`named`.
        """
        if name in self._plain and name not in self._added:
            return None
        return table_of(self.named(name))

    def _offered(self) -> list[EntryPoint]:
        return [point for point in entry_points(group=self.group) if _NAME.fullmatch(point.name)]

    def _loaded(self, point: EntryPoint) -> T:
        """What is behind an entry point."""
        owner = _owner(point)
        allowed = f"a package {owner} that works with this version, or another {self.what.split()[-1]}"
        try:
            found: Any = point.load()
        except Exception as error:  # the code is not ours: it may raise anything
            problem = f"{point.name!r} of {owner} cannot be imported ({point.value}): {type(error).__name__}: {error}"
            raise InputError(self.key, problem, allowed) from error
        wrong = self._wrong(found)
        if wrong:
            problem = f"{point.name!r} of {owner} is no {self.what}: {point.value} {wrong}"
            raise InputError(self.key, problem, allowed)
        thing: T = found
        return thing


def _owner(point: EntryPoint) -> str:
    """Package that has an entry point."""
    return point.dist.name if point.dist is not None else point.module


def table_of(thing: Any) -> type[BaseModel] | None:
    """Model of the table of a thing; see :meth:`Registry.table`."""
    if isinstance(thing, type):
        found = getattr(thing, "Parameters", None)
    else:
        try:
            found = get_type_hints(thing).get(next(iter(inspect.signature(thing).parameters), ""))
        except (NameError, TypeError, ValueError):  # types that are not there while it runs
            found = None
    return found if isinstance(found, type) and issubclass(found, BaseModel) else None


class NameIn:
    """Type of a key of a case whose value is a name in a registry: ``Annotated[str, NameIn(LAWS)]``.

    Parameters
    ----------
    registry : Registry
        Where the name must be. Cases that were run elsewhere, and are only looked at, may have others.
    *also : str
        What else the key may be.
    """

    def __init__(self, registry: Registry[Any], *also: str) -> None:
        self._registry, self._also = registry, also

    @property
    def names(self) -> tuple[str, ...]:
        """All that may be said."""
        return (*self._also, *self._registry)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self._known, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {**handler(schema), "enum": list(self.names)}

    def _known(self, name: str, info: ValidationInfo) -> str:
        if name not in self._also and name not in self._registry and (info.context or {}).get("files_exist", True):
            fail(f"{show(name)} is not known", ", ".join(filter(None, self.names)))
        return name
