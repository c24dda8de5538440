"""The JSON schema of case files, by which editors complete keys and mark what is wrong.

It is looser than the reader: what it refuses is refused there, but not the other way round.
"""

import math
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from fissura.case.accepted import Schema, change_of
from fissura.case.conditions import Gauge
from fissura.case.model import Case
from fissura.case.own_table import WithOwnTable
from fissura.case.shape import Specimen

_DRAFT = "http://json-schema.org/draft-07/schema#"  # the latest one that TOML editors know
_INSIDE, _DEFINITIONS = "#/$defs/", "#/definitions/"


class _Generator(GenerateJsonSchema):
    """Schemas of what validators take, and of what defaults follow from."""

    def function_before_schema(self, schema: core_schema.BeforeValidatorFunctionSchema) -> Schema:
        """Schema of what a validator takes."""
        inner = self.generate_inner(schema["schema"])
        change = change_of(schema["function"]["function"])
        return inner if change is None else change(inner)

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> Schema:
        """Schema of a field with a default, which may follow from other keys."""
        out = super().default_schema(schema)
        keys = getattr(schema.get("default_factory"), "follows", ())
        if not keys:
            return out
        told = f"{out['description']}; " if "description" in out else ""
        return {**out, "description": f"{told}by default it follows {' and '.join(keys)}"}


def case_schema() -> Schema:
    """JSON schema (draft 7) of a case file, as nested dictionaries.

    Returns
    -------
    dict
        Quantities are numbers or texts with a unit; keys have descriptions and defaults; keys that are not known are
        wrong.

    Examples
    --------
    >>> sorted(case_schema()["required"])
    ['discretization', 'material', 'specimen', 'supports']
    """
    found = Case.model_json_schema(schema_generator=_Generator)
    tables = found.pop("$defs")
    own = {"type": "object", "description": "constants of a contact law's own"}
    material, region = tables["Material"], tables["MaterialRegion"]
    material["additionalProperties"] = region["additionalProperties"] = own
    for key, value in material["properties"].items():
        if key not in ("law", "elastic"):
            region["properties"].setdefault(key, {k: v for k, v in value.items() if k != "default"})
    for part in (Specimen, Gauge):
        tables[part.__name__]["properties"] |= _own_tables(part, tables)
    definitions = {name: _tidied(table) for name, table in tables.items()}
    return {"$schema": _DRAFT, "title": "Fissura case", **_tidied(found), "definitions": definitions}


def _own_tables(part: type[WithOwnTable], tables: Schema) -> Schema:
    """Tables that packages and programs have added to a part, by name; definitions in them join the others."""
    found: Schema = {}
    for name in part.tables():
        model = part.table(name)
        assert model is not None
        found[name] = model.model_json_schema(schema_generator=_Generator)
        tables.update(found[name].pop("$defs", {}))
    return found


def _tidied(node: Any) -> Any:
    """A schema in the words of draft 7, without what says nothing: titles, and values that TOML does not have."""
    if isinstance(node, list):
        return [_tidied(item) for item in node]
    if not isinstance(node, dict):
        return node
    out: Schema = {}
    for key, value in node.items():
        if key == "properties":
            out[key] = {name: _tidied(_unit(name, inner)) for name, inner in value.items()}
        elif key == "default":
            if _is_plain(value):
                out[key] = value
        elif key == "$ref":
            out[key] = value.replace(_INSIDE, _DEFINITIONS)
        elif key not in ("title", "discriminator"):
            out[key] = _tidied(value)
    if "prefixItems" in out:
        items = out.pop("prefixItems")
        out["items"] = items[0] if all(item == items[0] for item in items) else items
    return _without_null(out)


def _without_null(schema: Schema) -> Schema:
    """Without the choice of null; what is left alone, or refers elsewhere, stands by itself."""
    if "anyOf" in schema:
        choices: list[Schema] = []
        for item in schema["anyOf"]:
            flat = item["anyOf"] if set(item) == {"anyOf"} else [item]
            choices += [choice for choice in flat if choice != {"type": "null"} and choice not in choices]
        rest = {key: value for key, value in schema.items() if key != "anyOf"}
        schema = {**choices[0], **rest} if len(choices) == 1 else {**rest, "anyOf": choices}
    if "$ref" in schema and len(schema) > 1:  # whatever stands beside a reference is ignored
        rest = {key: value for key, value in schema.items() if key != "$ref"}
        return {**rest, "allOf": [{"$ref": schema["$ref"]}]}
    return schema


def _unit(name: str, schema: Schema) -> Schema:
    """The key ``unit``, which is taken out before a table is validated, is a text."""
    return {**schema, "type": "string"} if name == "unit" else schema


def _is_plain(value: Any) -> bool:
    return isinstance(value, (bool, str, int)) or (isinstance(value, float) and math.isfinite(value))
