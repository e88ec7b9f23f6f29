# SPDX-License-Identifier: GPL-3.0-or-later
"""Light, safe corrections of a parsed answer before pydantic judges it, each of them reported.

Only what has one reading is corrected: a number written as text, an enumeration's case and spacing, one object where a
list of objects is wanted, a key's spelling, null for a missing optional field. Anything that would need a guess is
left as it is, so that validation names it and the model is asked again.
"""

from __future__ import annotations

import functools
import math
import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

_NUMBER_TEXT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*(?:m|°|deg|degrees)?\s*")
_EMPTY_WORDS = ("", "null", "none", "n/a", "nil")
_BOOLEANS = {"true": True, "yes": True, "false": False, "no": False}
_MOST_NOTES = 20
_MISSING = object()


def repair_reply(data: Any, model: type[BaseModel]) -> tuple[Any, tuple[str, ...]]:
    """Correct what is safe to correct in `data`, so that it fits `model` where it can.

    Returns:
        The corrected data (the input is not changed) and one sentence a kind of correction, with counts.
    """
    schema = _schema_of(model)
    mender = _Mender(schema.get("$defs", {}))
    root = mender.unwrap(data, mender.resolve(schema))
    mended = mender.mend(root, schema, "")
    return mended, mender.notes()


@functools.lru_cache(maxsize=64)
def _schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """The schema by which answers are read; only looked at, never changed."""
    return model.model_json_schema(mode="validation")


class _Mender:
    """Walks data and JSON schema side by side; `_said` counts the corrections by sentence."""

    def __init__(self, definitions: Mapping[str, Any]) -> None:
        self._definitions = definitions
        self._said: Counter[str] = Counter()

    def notes(self) -> tuple[str, ...]:
        """The corrections in words, the most frequent first."""
        common = self._said.most_common()
        lines = [f"{text} ({count} times)" if count > 1 else text for text, count in common[:_MOST_NOTES]]
        if len(common) > _MOST_NOTES:
            lines.append(f"and {len(common) - _MOST_NOTES} more kinds of corrections")
        return tuple(lines)

    def resolve(self, schema: Mapping[str, Any]) -> Mapping[str, Any]:
        """The schema with references followed."""
        while "$ref" in schema:
            schema = self._definitions[schema["$ref"].rsplit("/", 1)[-1]]
        if len(schema.get("allOf", [])) == 1:
            return self.resolve(schema["allOf"][0])
        return schema

    def unwrap(self, data: Any, schema: Mapping[str, Any]) -> Any:
        """Take the answer out of a one-key wrapper, or put a bare list into the root's only list field."""
        properties = schema.get("properties", {})
        if isinstance(data, list):
            if len(data) == 1 and isinstance(data[0], dict) and set(data[0]) & set(properties):
                self._say("the answer was taken out of a list", "")
                return data[0]
            lists = [name for name, value in properties.items() if self.resolve(value).get("type") == "array"]
            required = set(schema.get("required", []))
            lists = [name for name in lists if name in required] or lists
            if len(lists) == 1 and required <= set(lists):
                self._say(f"a bare list was read as {lists[0]}", "")
                return {lists[0]: data}
        if isinstance(data, dict) and len(data) == 1:
            (key, inner), *_ = data.items()
            if key not in properties and isinstance(inner, dict) and set(inner) & set(properties):
                self._say(f"the answer was taken out of {key[:40]!r}", "")
                return inner
        return data

    def mend(self, data: Any, schema: Mapping[str, Any], path: str) -> Any:
        """`data` with safe corrections towards `schema`."""
        schema = self.resolve(schema)
        if "anyOf" in schema or "oneOf" in schema:
            return self._mend_choice(data, schema.get("anyOf") or schema["oneOf"], path)
        if "enum" in schema or "const" in schema:
            return self._mend_enum(data, schema.get("enum", [schema.get("const")]), path)
        kind = schema.get("type")
        if kind == "object" and "properties" in schema:
            return self._mend_object(data, schema, path)
        if kind == "array":
            return self._mend_array(data, schema, path)
        if kind in ("number", "integer", "boolean", "string"):
            return self._mend_scalar(data, kind, path)
        return data

    def _say(self, what: str, path: str) -> None:
        self._said[f"{path}: {what}" if path else what] += 1

    def _mend_choice(self, data: Any, choices: list[Mapping[str, Any]], path: str) -> Any:
        options = [self.resolve(choice) for choice in choices]
        nullable = any(option.get("type") == "null" for option in options)
        if data is None and nullable:
            return None
        if nullable and isinstance(data, str) and data.strip().lower() in _EMPTY_WORDS:
            self._say("an empty word was read as null", path)
            return None
        rest = [option for option in options if option.get("type") != "null"]
        if len(rest) == 1:
            return self.mend(data, rest[0], path)
        if isinstance(data, dict):
            rest = [option for option in rest if _could_be(data, option, self)]
            if len(rest) == 1:
                return self.mend(data, rest[0], path)
        return data

    def _mend_enum(self, data: Any, allowed: list[Any], path: str) -> Any:
        if not isinstance(data, str) or data in allowed:
            return data
        same = [value for value in allowed if isinstance(value, str) and _bare(value) == _bare(data)]
        if len(same) == 1:
            self._say(f"{data[:40]!r} was read as {same[0]!r}", path)
            return same[0]
        return data

    def _mend_scalar(self, data: Any, kind: str, path: str) -> Any:
        if kind in ("number", "integer") and isinstance(data, str) and _is_endless(data.rstrip(" °mdegrs")):
            # Pydantic would read these words as numbers.
            self._say("a number that is not finite was read as missing", path)
            return None
        if kind in ("number", "integer") and isinstance(data, str):
            match = _NUMBER_TEXT.fullmatch(data)
            if match and len(data) < 60:
                self._say("text was read as a number", path)
                number = float(match.group(1))
                return int(number) if kind == "integer" and number.is_integer() else number
        if kind == "boolean" and isinstance(data, str) and data.strip().lower() in _BOOLEANS:
            self._say("text was read as true or false", path)
            return _BOOLEANS[data.strip().lower()]
        if kind == "string" and isinstance(data, (int, float)) and not isinstance(data, bool):
            self._say("a number was read as text", path)
            return f"{data:g}" if isinstance(data, float) else str(data)
        return data

    def _mend_array(self, data: Any, schema: Mapping[str, Any], path: str) -> Any:
        fixed = schema.get("prefixItems")
        if fixed and isinstance(data, dict) and list(data) == ["x", "y", "z"][: len(fixed)]:
            self._say("x, y, z were read as a list", path)
            data = list(data.values())
        if fixed:
            if not isinstance(data, list):
                return data
            return [self.mend(v, fixed[min(i, len(fixed) - 1)], f"{path}[]") for i, v in enumerate(data)]
        item = self.resolve(schema.get("items", {}))
        if isinstance(data, dict) and item.get("type") == "object":
            data = self._listed(data, item, path)
        if not isinstance(data, list):
            return data
        if item.get("type") == "object" and None in data:
            self._say("an empty entry was left out", path)
            data = [value for value in data if value is not None]
        return [self.mend(value, item, f"{path}[]") for value in data]

    def _listed(self, data: dict[str, Any], item: Mapping[str, Any], path: str) -> Any:
        """A single object, or objects keyed by their ids, as a list."""
        properties = item.get("properties", {})
        if set(data) & set(properties):
            self._say("one object was read as a list of one", path)
            return [data]
        if data and "id" in properties and all(isinstance(value, dict) for value in data.values()):
            self._say("objects under their ids were read as a list", path)
            return [{"id": key, **value} for key, value in data.items()]
        return data

    def _mend_object(self, data: Any, schema: Mapping[str, Any], path: str) -> Any:
        properties = schema["properties"]
        if isinstance(data, list) and list(properties) == ["x", "y", "z"][: len(data)] and data:
            self._say("a list was read as x, y", path)
            data = dict(zip(properties, data, strict=True))
        if not isinstance(data, dict):
            return data
        result: dict[str, Any] = {}
        for key, value in self._respelled(data, schema, path).items():
            if key not in properties:
                result[key] = value
                continue
            place = f"{path}.{key}" if path else key
            mended = self._mend_member(value, properties[key], place)
            if mended is not _MISSING:
                result[key] = mended
        for name in schema.get("required", []):
            if name not in result and self._takes_null(properties[name]):
                self._say("a missing field was read as null", f"{path}.{name}" if path else name)
                result[name] = None
        return result

    def _mend_member(self, value: Any, schema: Mapping[str, Any], place: str) -> Any:
        """A field's value; `_MISSING` when null stands for the field's own default."""
        if value is None and not self._takes_null(schema):
            if "default" in schema:
                self._say("null was read as the default", place)
                return _MISSING
            return None
        mended = self.mend(value, schema, place)
        lost = mended is None and value is not None and not self._takes_null(schema) and "default" in schema
        return _MISSING if lost else mended

    def _takes_null(self, schema: Mapping[str, Any]) -> bool:
        schema = self.resolve(schema)
        options = schema.get("anyOf") or schema.get("oneOf") or [schema]
        return any(self.resolve(option).get("type") == "null" for option in options)

    def _respelled(self, data: dict[str, Any], schema: Mapping[str, Any], path: str) -> dict[str, Any]:
        """The same members with keys as the schema spells them; unknown keys left out where they are refused."""
        properties = schema["properties"]
        spelling = {_bare(name): name for name in properties}
        result = {key: value for key, value in data.items() if key in properties}
        for key, value in data.items():
            if key in properties:
                continue
            known = spelling.get(_bare(key))
            if known is not None and known not in result:
                self._say(f"{key[:40]!r} was read as {known!r}", path)
                result[known] = value
            elif schema.get("additionalProperties") is False:
                self._say(f"the unknown field {key[:40]!r} was left out", path)
            else:
                result[key] = value
        return result


def _is_endless(text: str) -> bool:
    """Whether a text is a number that is not finite: nan, infinity, 1e999."""
    try:
        return len(text) < 500 and not math.isfinite(float(text))
    except ValueError:
        return False


def _bare(word: str) -> str:
    """A word without case, spaces, hyphens and underscores."""
    return re.sub(r"[\s_\-]+", "", word).lower()


def _could_be(data: Mapping[str, Any], option: Mapping[str, Any], mender: _Mender) -> bool:
    """Whether a union's option can be meant: its constant fields agree and it knows all of the data's keys."""
    properties = option.get("properties", {})
    for name, value in properties.items():
        constant = mender.resolve(value).get("const", _MISSING)
        if constant is not _MISSING and data.get(name, _MISSING) not in (constant, _MISSING):
            return False
        if constant is not _MISSING and name not in data and "default" not in value:
            return False
    constants = [n for n, v in properties.items() if "const" in mender.resolve(v)]
    return bool(constants) or set(data) <= set(properties)
