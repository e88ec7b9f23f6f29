# SPDX-License-Identifier: GPL-3.0-or-later
"""The empty but valid answer to a JSON schema, for requests on which a picture analysis has nothing to say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_SCALARS: dict[str, Any] = {"string": "", "number": 0, "integer": 0, "boolean": False, "null": None}


def empty_value(schema: Mapping[str, Any], definitions: Mapping[str, Any] | None = None) -> Any:
    """A value that fits the schema and says nothing: nulls where allowed, else empty, zero, or the first choice.

    Args:
        schema: a node of a JSON schema as `models.schema.strict_schema` makes it (no recursion).
        definitions: its "$defs"; taken from the node itself when not given.
    """
    known = definitions if definitions is not None else schema.get("$defs", {})
    if "$ref" in schema:
        return empty_value(known[str(schema["$ref"]).rsplit("/", 1)[-1]], known)
    if "const" in schema:
        return schema["const"]
    if "enum" in schema:
        return None if None in schema["enum"] else schema["enum"][0]
    choices = schema.get("anyOf") or schema.get("oneOf") or schema.get("allOf")
    if choices:
        values = [empty_value(choice, known) for choice in choices]
        return None if None in values else values[0]
    kind = schema.get("type")
    if isinstance(kind, list):
        kind = "null" if "null" in kind else kind[0]
    if kind == "array":
        return [empty_value(schema.get("items", {}), known) for _ in range(int(schema.get("minItems", 0)))]
    if kind == "object" or "properties" in schema:
        properties = schema.get("properties", {})
        return {
            name: empty_value(properties[name], known)
            for name in schema.get("required", properties)
            if name in properties
        }
    return _SCALARS.get(str(kind))
