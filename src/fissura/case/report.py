"""One message for the user out of pydantic's list of errors."""

import difflib
import re
from collections.abc import Mapping
from typing import Any, NoReturn, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from fissura.case.units import show
from fissura.errors import InputError

#: Errors of defaults that only wait for another key, which is wrong itself.
WAITING = ("waiting", "default_factory_not_called")

#: What is meant by keys that other tables have.
MEANT = {"target": ("to",), "to": ("target",), "type": ("control",), "control": ("type",), "stages": ("stage",)}

Location = tuple[int | str, ...]


def fail(problem: str, allowed: str = "", key: str | tuple[int | str, ...] = ()) -> NoReturn:
    """Raise the error that `input_error` turns into the message for the user.

    Parameters
    ----------
    problem, allowed : str
        What is wrong and what would be right.
    key : str or tuple, optional
        Key inside the model being validated, or the keys and indices that lead to it; empty for the value itself.

    Raises
    ------
    PydanticCustomError
        Always.
    """
    context = {"problem": problem, "allowed": allowed, "key": (key,) if isinstance(key, str) else key}
    raise PydanticCustomError("fissura", "{problem}", context)


def input_error(error: ValidationError, model: type[BaseModel], data: Mapping[str, Any]) -> InputError:
    """Turn the errors of a validation into one that names the key as it stands in the case file.

    Keys that are not known come first: a misspelt key is also a missing one.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.
    model : type of BaseModel
        Model that was validated.
    data : mapping
        What the case file says.

    Returns
    -------
    InputError
        The first problem; it says how many more there are, and where.
    """
    details = [item for item in error.errors(include_url=False) if item["type"] not in WAITING]
    details.sort(key=lambda item: item["type"] != "extra_forbidden")
    found: dict[str, ErrorDetails] = {}
    for item in details:
        found.setdefault(_dotted(_location(item, data)), item)
    (_, first), *others = found.items()
    key, problem, allowed = _describe(first, model, data)
    if others:
        names = ", ".join(name for name, _ in others[:3]) + (", ..." if len(others) > 3 else "")
        problem += f" [and {len(others)} more problem{'s' if len(others) > 1 else ''}: {names}]"
    return InputError(key, problem, allowed)


def _location(item: ErrorDetails, data: Mapping[str, Any]) -> Location:
    """Where an error is, as the case file writes it."""
    context: dict[str, Any] = item.get("ctx", {})
    location = _as_written((*item["loc"], *context.get("key", ())), data)
    kind = item["type"]
    return (*location, "type") if kind in ("union_tag_not_found", "union_tag_invalid") else location


def _describe(item: ErrorDetails, model: type[BaseModel], data: Mapping[str, Any]) -> tuple[str, str, str]:
    """Key, problem and what is allowed."""
    context: dict[str, Any] = item.get("ctx", {})
    location = _location(item, data)
    key = _dotted(location)
    value = item["input"]
    kind = item["type"]
    if kind == "fissura":
        return key, context["problem"], context["allowed"]
    if kind == "missing":
        return key, "missing", _description(model, location)
    if kind == "extra_forbidden":
        known = _known_keys(model, location[:-1], data)
        near = [name for name in known if name in MEANT.get(str(location[-1]), ())]
        near = near or difflib.get_close_matches(str(location[-1]), known, n=1, cutoff=0.5)
        near = near or [name for name in known if name.lower() == str(location[-1]).lower()]
        hint = f"; did you mean {_dotted((*location[:-1], near[0]))}?" if near else ""
        return key, f"unknown key{hint}", ", ".join(known)
    if kind == "literal_error":
        return key, f"{show(value)} is not known", str(context["expected"]).replace("'", '"')
    if kind == "union_tag_not_found":
        return key, "missing", '"ball" or "box"'
    if kind == "union_tag_invalid":
        return key, f"{show(context['tag'])} is not known", '"ball" or "box"'
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        if isinstance(value, (list, tuple)) and value and all(isinstance(item, Mapping) for item in value):
            many = f"{len(value)} tables are given" if len(value) > 1 else f"is a list of tables, [[{key}]]"
            return key, many, f"one table, [{key}]"
        return key, f"{show(value)} is not a table", _description(model, location) or "a table"
    if kind in ("tuple_type", "list_type"):
        tables = any(_models(model, location))
        return key, f"{show(value)} is not a list", "a list of tables" if tables else _description(model, location)
    if kind == "string_type":
        return key, f"{show(value)} is not text", "text in quotes"
    return key, f"{show(value)} is wrong: {item['msg']}", ""


def _as_written(location: Location, data: Any) -> Location:
    """Drop what the file does not say: the index of a single table or value, the tag of a union."""
    written: list[int | str] = []
    for position, part in enumerate(location):
        last = position == len(location) - 1
        if isinstance(data, Mapping):
            if isinstance(part, int) or (part not in data and not last and data.get("type") == part):
                continue
            data = data.get(part)
        elif isinstance(data, (list, tuple)) and isinstance(part, int) and part < len(data):
            data = data[part]
        elif isinstance(data, (str, int, float)) and isinstance(part, int):
            continue
        else:
            data = None
        written.append(part)
    return tuple(written)


def _dotted(location: Location) -> str:
    """Write a location as in a case file: ``supports[1].at``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{_bare(part)}" for part in location)
    return text.removeprefix(".") or "case"


def _bare(key: str) -> str:
    """A key as a file may write it: in quotes unless it has letters, digits, dashes and underscores only."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,100}", key) else show(key)


def _models(model: type[BaseModel], location: Location) -> list[type[BaseModel]]:
    """Models that may stand at a location."""
    models, named = [model], False
    for part in location:
        if named:  # a name that the case gives, as in [gauges.NAME]
            named = False
        elif isinstance(part, str):
            fields = [item.model_fields[part] for item in models if part in item.model_fields]
            named = any(get_origin(field.annotation) is dict for field in fields)
            models = [found for item in models for found in _tables(item, part)]
    return models


def _tables(model: type[BaseModel], key: str) -> list[type[BaseModel]]:
    """Models that may stand at a key."""
    if key in model.model_fields:
        return _inside(model.model_fields[key].annotation)
    found = model.table(key) if hasattr(model, "table") else None
    return [] if found is None else [found]


def _inside(annotation: Any) -> list[type[BaseModel]]:
    """Models named in a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for part in get_args(annotation) for found in _inside(part)]


def _known_keys(model: type[BaseModel], location: Location, data: Mapping[str, Any]) -> list[str]:
    """Keys that may stand in the table at a location."""
    table: Any = data
    for part in location:
        table = table[part]
    models = _models(model, location)
    chosen = [
        item
        for item in models
        if len(models) == 1 or table.get("type") in get_args(item.model_fields["type"].annotation)
    ]
    return [name for item in chosen or models for name in (*item.model_fields, *getattr(item, "tables", list)())]


def _description(model: type[BaseModel], location: Location) -> str:
    """What the field at a location asks for, in words."""
    *outer, name = location
    for item in _models(model, tuple(outer)):
        if isinstance(name, str) and name in item.model_fields:
            field = item.model_fields[name]
            names = next((mark.names for mark in field.metadata if hasattr(mark, "names")), ())
            return ", ".join(names) or field.description or ""
    return ""
