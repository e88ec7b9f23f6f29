# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON schemas that every vendor's structured output accepts, made from pydantic models.

The common ground of OpenAI's strict mode, Anthropic's output format, Gemini's response schema and llama.cpp's
grammars: the root is an object, every property is required (nullable instead of optional), nothing additional is
allowed, and there are no bounds, lengths, defaults, titles, formats or tuples. What is lost that way (bounds, the
length of a tuple) is said in words in the description, and checked again by pydantic when the reply is read.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

_SCALARS = ("string", "number", "integer", "boolean", "null")


def strict_schema(model: type[BaseModel]) -> dict[str, Any]:
    """The model's JSON schema in the form that every vendor accepts.

    Returns:
        A new dictionary: root of type "object", local definitions under "$defs".

    Raises:
        TypeError: the model holds what no strict mode can express (free-form dictionaries, `Any`, recursion).
    """
    raw = model.model_json_schema(mode="validation")
    definitions: dict[str, Any] = raw.get("$defs", {})
    root = raw
    if "$ref" in raw:
        root = definitions[_target(raw["$ref"])]
    if root.get("type") != "object":
        raise TypeError(f"{model.__name__} is not an object and cannot be asked for as a reply.")
    _refuse_recursion(model.__name__, definitions)
    strict = _convert(root, model.__name__)
    used = _reachable(root, definitions)
    if used:
        strict["$defs"] = {name: _convert(definitions[name], name) for name in sorted(used)}
    return strict


def shape_text(schema: Mapping[str, Any]) -> str:
    """A strict schema as one compact line of JSON, for prompts to services that have plain JSON mode only."""
    return json.dumps(schema, ensure_ascii=False, separators=(",", ":"))


def older_schema(schema: Mapping[str, Any]) -> dict[str, Any]:
    """A strict schema in the older form that Gemini's `responseSchema` takes: no references, `nullable`, no closing."""
    return _older(schema, schema.get("$defs", {}))


def _older(node: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any]:
    if "$ref" in node:
        return _older(definitions[_target(node["$ref"])], definitions)
    result: dict[str, Any] = {name: node[name] for name in ("type", "description", "required") if name in node}
    choices = [choice for choice in node.get("anyOf", []) if choice.get("type") != "null"]
    if choices:
        described = dict(result)
        result = _older(choices[0], definitions) if len(choices) == 1 else {}
        if len(choices) > 1:
            result["anyOf"] = [_older(choice, definitions) for choice in choices]
        result |= described
        if len(choices) < len(node["anyOf"]):
            result["nullable"] = True
    if "enum" in node:
        texts = [value for value in node["enum"] if isinstance(value, str)]
        # Only texts may be listed there.
        if len(texts) == len(node["enum"]):
            result["enum"] = texts
    if "properties" in node:
        result["properties"] = {name: _older(value, definitions) for name, value in node["properties"].items()}
    if "items" in node:
        result["items"] = _older(node["items"], definitions)
    return result


def _target(reference: str) -> str:
    return reference.rsplit("/", 1)[-1]


def _convert(node: Mapping[str, Any], where: str) -> dict[str, Any]:
    """One schema node in strict form; `where` names it in errors."""
    if "$ref" in node:
        # Several services refuse a reference with neighbours such as a description.
        return {"$ref": node["$ref"]}
    if len(node.get("allOf", [])) == 1:
        return _convert(node["allOf"][0], where)
    result: dict[str, Any] = {}
    choices = node.get("anyOf") or node.get("oneOf")
    if choices:
        result["anyOf"] = [_convert(choice, where) for choice in choices]
    elif "const" in node:
        result = _enum([node["const"]])
    elif "enum" in node:
        result = _enum(node["enum"])
    elif node.get("type") == "object":
        result = _object(node, where)
    elif node.get("type") == "array":
        result = _array(node, where)
    elif node.get("type") in _SCALARS:
        result["type"] = node["type"]
    else:
        raise TypeError(f"{where} has no type that a structured reply can carry.")
    described = _description(node)
    if described:
        result["description"] = described
    return result


def _object(node: Mapping[str, Any], where: str) -> dict[str, Any]:
    if isinstance(node.get("additionalProperties"), dict) or node.get("additionalProperties") is True:
        raise TypeError(f"{where} is a dictionary with free keys; use a list of objects instead.")
    properties = node.get("properties", {})
    return {
        "type": "object",
        "properties": {name: _convert(value, f"{where}.{name}") for name, value in properties.items()},
        "required": list(properties),
        "additionalProperties": False,
    }


def _array(node: Mapping[str, Any], where: str) -> dict[str, Any]:
    if "prefixItems" in node:
        kinds: list[dict[str, Any]] = []
        for item in node["prefixItems"]:
            kind = _convert(item, where)
            if kind not in kinds:
                kinds.append(kind)
        if not kinds:
            raise TypeError(f"{where} is an empty tuple.")
        return {"type": "array", "items": kinds[0] if len(kinds) == 1 else {"anyOf": kinds}}
    if not isinstance(node.get("items"), dict) or not node["items"]:
        raise TypeError(f"{where} is a list of unknown items.")
    return {"type": "array", "items": _convert(node["items"], where)}


def _enum(values: list[Any]) -> dict[str, Any]:
    kinds = {"boolean" if isinstance(v, bool) else "string" if isinstance(v, str) else "number" for v in values}
    if len(kinds) == 1:
        return {"type": kinds.pop(), "enum": list(values)}
    return {"enum": list(values)}


def _description(node: Mapping[str, Any]) -> str:
    """The node's own description and, in words, the bounds that strict mode cannot carry."""
    low = node.get("minimum", node.get("exclusiveMinimum"))
    high = node.get("maximum", node.get("exclusiveMaximum"))
    words = [" ".join(str(node.get("description", "")).split())] if node.get("description") else []
    if low is not None and high is not None:
        words.append(f"{low:g} to {high:g}")
    elif low is not None:
        words.append(f"{'over' if 'exclusiveMinimum' in node else 'at least'} {low:g}")
    elif high is not None:
        words.append(f"{'under' if 'exclusiveMaximum' in node else 'at most'} {high:g}")
    if "prefixItems" in node:
        words.append(f"exactly {len(node['prefixItems'])} values")
    elif node.get("maxItems") is not None:
        words.append(f"at most {node['maxItems']}")
    return "; ".join(words)


def _references(node: Any) -> set[str]:
    """Names of the definitions that a raw node refers to directly."""
    found: set[str] = set()
    if isinstance(node, dict):
        for key, value in node.items():
            if key == "$ref" and isinstance(value, str):
                found.add(_target(value))
            elif key not in ("$defs", "discriminator"):
                found |= _references(value)
    elif isinstance(node, list):
        for value in node:
            found |= _references(value)
    return found


def _reachable(root: Mapping[str, Any], definitions: Mapping[str, Any]) -> set[str]:
    found: set[str] = set()
    waiting = _references(dict(root))
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting |= _references(definitions[name])
    return found


def _refuse_recursion(model: str, definitions: Mapping[str, Any]) -> None:
    for name in definitions:
        if name in _reachable(definitions[name], definitions):
            raise TypeError(f"{model}: {name} contains itself, which no strict schema allows.")
