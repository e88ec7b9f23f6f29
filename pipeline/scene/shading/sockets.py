# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes and their sockets, found by name or identifier: their order differs between versions of Blender."""

from __future__ import annotations

from typing import Any


def new_node(tree: Any, kind: str, inputs: dict[str, Any] | None = None, **settings: Any) -> Any:
    """A shader node with settings, and with values of or links to its inputs."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in settings.items():
        setattr(node, name, value)
    for name, value in (inputs or {}).items():
        put(tree, node, name, value)
    return node


def socket(sockets: Any, name: str) -> Any:
    """An input or output that can be used, by its identifier, else by its name; None where this Blender has none."""
    named = [s for s in sockets if s.identifier == name] or [s for s in sockets if s.name == name and s.enabled]
    return named[0] if named else None


def put(tree: Any, node: Any, name: str, value: Any) -> None:
    """Give an input a number, a linear colour or a link; inputs that this Blender has not are passed over."""
    target = socket(node.inputs, name)
    if target is None:
        return
    if hasattr(value, "is_output"):
        tree.links.new(value, target)
    elif isinstance(value, tuple) and target.type == "RGBA":
        target.default_value = (*value[:3], 1.0)
    elif isinstance(value, tuple) and target.type == "VALUE":
        target.default_value = sum(value[:3]) / 3
    elif isinstance(value, (int, float)) and target.type == "RGBA":
        target.default_value = (value, value, value, 1.0)
    else:
        target.default_value = value


def out(node: Any, name: str) -> Any:
    """An output."""
    return socket(node.outputs, name)
