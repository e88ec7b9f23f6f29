# SPDX-License-Identifier: GPL-3.0-or-later
"""Schemas that every vendor accepts."""

from typing import Annotated, Any, Literal

import pytest
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.layout import Layout, LayoutEdit
from code_as_room.pipeline.models.schema import shape_text, strict_schema
from pydantic import BaseModel, Field

ALLOWED = {
    "type",
    "properties",
    "required",
    "additionalProperties",
    "items",
    "enum",
    "anyOf",
    "$ref",
    "$defs",
    "description",
}


class Move(BaseModel):
    op: Literal["move"]
    to: tuple[float, float]


class Drop(BaseModel):
    op: Literal["drop"] = "drop"
    title: str = Field("x", max_length=3, pattern="x+")


class Answer(BaseModel):
    """What is asked for."""

    edits: list[Annotated[Move | Drop, Field(discriminator="op")]] = Field(default_factory=list, max_length=9)
    score: float = Field(ge=0, le=1, description="how well it fits")
    default: int | None = None
    mixed: tuple[str, float]


def _schema_nodes(node: Any):
    """Every schema in a schema (not the maps of properties and definitions)."""
    yield node
    for key, value in node.items():
        if key in ("properties", "$defs"):
            for inner in value.values():
                yield from _schema_nodes(inner)
        elif key == "items":
            yield from _schema_nodes(value)
        elif key == "anyOf":
            for inner in value:
                yield from _schema_nodes(inner)


@pytest.mark.parametrize("model", [Answer, SceneAnalysis, Layout, LayoutEdit])
def test_only_what_every_vendor_accepts_is_used(model):
    schema = strict_schema(model)
    assert schema["type"] == "object"
    for node in _schema_nodes(schema):
        assert set(node) <= ALLOWED
        if "$ref" in node:
            assert set(node) == {"$ref"} and node["$ref"].removeprefix("#/$defs/") in schema["$defs"]
        if node.get("type") == "object":
            assert node["additionalProperties"] is False
            assert node["required"] == list(node["properties"])


def test_bounds_and_tuple_lengths_are_said_in_words():
    schema = strict_schema(Answer)
    assert schema["properties"]["score"]["description"] == "how well it fits; 0 to 1"
    assert schema["$defs"]["Move"]["properties"]["to"]["description"] == "exactly 2 values"


def test_fields_named_like_schema_words_stay():
    schema = strict_schema(Answer)
    assert {"type": "null"} in schema["properties"]["default"]["anyOf"]
    assert "title" in schema["$defs"]["Drop"]["properties"]


def test_unused_definitions_are_left_out_and_the_compact_text_is_one_line():
    schema = strict_schema(Answer)
    assert set(schema["$defs"]) == {"Move", "Drop"}
    assert "\n" not in shape_text(schema)


class Free(BaseModel):
    values: dict[str, float]


class Unknown(BaseModel):
    value: Any


class Tree(BaseModel):
    children: list["Tree"]


@pytest.mark.parametrize("model", [Free, Unknown, Tree])
def test_what_no_strict_mode_can_express_is_refused(model):
    with pytest.raises(TypeError):
        strict_schema(model)
