# SPDX-License-Identifier: GPL-3.0-or-later
"""The schemas that are really sent are ones that every vendor takes, by the strictest limits that are known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts import light, materials, objects, replies
from code_as_room.pipeline.models.schema import older_schema, strict_schema
from pydantic import BaseModel

MOST_UNIONS, MOST_DEPTH = 16, 10
REFUSED = {
    "minimum",
    "maximum",
    "minLength",
    "maxLength",
    "minItems",
    "maxItems",
    "pattern",
    "format",
    "default",
    "title",
}


def asked_for() -> list[type[BaseModel]]:
    """Every type that a prompt asks for."""
    kinds = {
        kind
        for module in (light, materials, objects, replies)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, BaseModel) and "Answer to prompt" in (kind.__doc__ or "")
    }
    return sorted(kinds, key=lambda kind: kind.__name__)


def nodes(node: Any, depth: int = 0) -> Iterator[tuple[dict[str, Any], int]]:
    """Every schema node with its depth; names of fields are no nodes."""
    if isinstance(node, dict):
        yield node, depth
        for name, value in node.items():
            if name in ("properties", "$defs"):
                for inner in value.values():
                    yield from nodes(inner, depth + 1)
            elif name in ("items", "anyOf"):
                for inner in value if isinstance(value, list) else [value]:
                    yield from nodes(inner, depth + 1)


def test_all_kinds_of_answers_are_looked_at() -> None:
    assert len(asked_for()) >= 10


@pytest.mark.parametrize("kind", asked_for(), ids=lambda kind: kind.__name__)
def test_a_schema_is_what_every_vendor_takes(kind: type[BaseModel]) -> None:
    schema = strict_schema(kind)
    found = list(nodes(schema))
    assert schema["type"] == "object"
    # Claude takes at most 16 parameters with a choice of types, and 24 that may be left out.
    assert sum("anyOf" in node for node, _ in found) <= MOST_UNIONS
    for node, depth in found:
        assert depth <= MOST_DEPTH and not REFUSED & set(node)
        if node.get("type") == "object":
            assert node["required"] == list(node["properties"]) and node["additionalProperties"] is False
    old = list(nodes(older_schema(schema)))
    assert not any({"$ref", "$defs", "additionalProperties"} & set(node) for node, _ in old)
