# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a JSON value fits a type of a vendor's library: typed dictionaries, unions, literals and lists, key by key.

Pydantic would do for most of it, but leaves out unknown keys and looks into no iterable.
"""

from __future__ import annotations

import collections.abc
import types
import typing
from typing import Any

import typing_extensions as ext

_REQUIRED = (typing.Required, ext.Required)
_WRAPPERS = (typing.Annotated, typing.Required, typing.NotRequired, ext.Required, ext.NotRequired, ext.ReadOnly)
_LISTS = (list, tuple, collections.abc.Iterable, collections.abc.Sequence)
_MAPPINGS = (dict, collections.abc.Mapping)


def misfits(value: Any, kind: Any, path: str = "body") -> list[str]:
    """What does not fit, empty where everything does."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if kind in (Any, object) or isinstance(kind, typing.TypeVar):
        return []
    if hasattr(kind, "__value__"):
        return misfits(value, kind.__value__, path)
    if origin in _WRAPPERS:
        return misfits(value, inner[0], path)
    if origin in (typing.Union, types.UnionType):
        found = [misfits(value, option, path) for option in inner]
        # What came farthest is the most telling.
        return [] if [] in found else max(found, key=lambda lines: max(line.count(".") for line in lines))
    if origin in (typing.Literal, ext.Literal):
        return [] if value in inner else [f"{path}: {value!r} is none of {inner}"]
    if ext.is_typeddict(kind):
        return _dictionary(value, kind, path)
    if origin in _LISTS:
        if not isinstance(value, list):
            return [f"{path}: no list"]
        return [line for n, item in enumerate(value) for line in misfits(item, inner[0], f"{path}.{n}")]
    if origin in _MAPPINGS or kind in _MAPPINGS:
        if not isinstance(value, dict):
            return [f"{path}: no object"]
        return [line for k, item in value.items() for line in misfits(item, inner[1] if inner else Any, f"{path}.{k}")]
    if kind in (None, type(None)):
        return [] if value is None else [f"{path}: not null"]
    if not isinstance(kind, type):
        return [f"{path}: unknown type {kind}"]
    allowed: Any = (int, float) if kind is float else kind
    right = isinstance(value, allowed) and (kind is bool or not isinstance(value, bool))
    return [] if right else [f"{path}: {type(value).__name__} instead of {kind.__name__}"]


def _dictionary(value: Any, kind: Any, path: str) -> list[str]:
    if not isinstance(value, dict):
        return [f"{path}: no object"]
    hints = ext.get_type_hints(kind, include_extras=True)
    lines = [f"{path}.{key}: unknown" for key in value if key not in hints]
    # Written as texts, annotations do not tell the class itself which of them are required.
    needed = kind.__required_keys__ | {k for k, hint in hints.items() if typing.get_origin(hint) in _REQUIRED}
    lines += [f"{path}.{key}: missing" for key in needed if key not in value]
    return lines + [line for k in value if k in hints for line in misfits(value[k], hints[k], f"{path}.{k}")]
