# SPDX-License-Identifier: GPL-3.0-or-later
"""Recorded replies, ways to damage them, and the reading of what came of that.

They are damaged as text (cut, doubled, spliced, sprinkled) and as values (other types, infinite and huge numbers, odd texts).
"""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from code_as_room.pipeline.artifacts import light, materials, objects, replies
from code_as_room.pipeline.errors import ReplyError
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.models.coordinates import as_asked
from code_as_room.pipeline.models.recorded import load_replies
from code_as_room.pipeline.models.schema import strict_schema
from code_as_room.pipeline.models.validate import validate_reply
from pydantic import BaseModel

HERE = Path(__file__).resolve().parent
SAMPLE = HERE.parent / "samples" / "bedroom"
KINDS: dict[str, type[BaseModel]] = {
    "01_analysis": replies.AnalysisReply,
    "01_second_look": replies.SecondLookReply,
    "02_graph": replies.GraphReply,
    "03_critique": replies.CritiqueReply,
    "04_auxiliary": replies.AuxiliaryReply,
    "05_descriptions": objects.DescriptionsReply,
    "06_pieces": objects.PiecesReply,
    "06_programs": objects.ProgramsReply,
    "06_correct": objects.ProgramsReply,
    "08_materials": materials.MaterialsReply,
    "10_light": light.LightReply,
}
MODELS = ("gpt-5", "gemini-2.5-pro", "claude-opus-4-1", "qwen2.5-vl-7b")
SEEN = [(1000, 867), (1200, 1040)]
"""Sizes of pictures that a model may speak of in pixels."""
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 7, 1e-300, 1e308, -1e308, 10**30, -(10**400), math.inf, -math.inf, math.nan, 0.1),
    *(
        "",
        " ",
        "x",
        "bed",
        "1e999",
        "NaN",
        "12 m",
        "null",
        "\u0000",
        "\ud800",
        "😀" * 40,
        "a" * 5000,
        "../../etc",
        "{{x}}",
    ),
    *([], {}, [[]], [None], [1, 2, 3], {"id": "x"}, {"x": 1}, {"error": "no"}, ["a"] * 200),
)
SPRINKLES = (
    *(
        "{",
        "}",
        "[",
        "]",
        '"',
        "'",
        ",",
        ":",
        "\\",
        "\\u",
        "\\ud800",
        "\n",
        "\x00",
        "//",
        "/*",
        "*/",
        "```",
        "```json\n",
    ),
    *(
        "NaN",
        "-Infinity",
        "1e999",
        "undefined",
        "None",
        "True",
        "</think>",
        "<think>",
        "\ufeff",
        "\u201c",
        "-",
        "+",
        ".",
        "e9",
    ),
    *("data: ", "[DONE]", "Sure! Here it is:\n", "9" * 500, "[" * 80, '{"a":' * 80),
)


@dataclass(frozen=True)
class Seed:
    """A good reply of one kind, as data."""

    name: str
    kind: type[BaseModel]
    data: Any


def seeds() -> list[Seed]:
    """All recorded replies, and for kinds that were never recorded one that says nothing."""
    found: list[Seed] = []
    folders = [SAMPLE / "replies", *(path.parent for path in sorted((HERE / "recordings").rglob("replies.json")))]
    for folder in folders:
        for key, entry in sorted(load_replies(folder).items()):
            name = key.split("/")[1]
            if name in KINDS and isinstance(entry.get("reply"), dict):
                found.append(Seed(name, KINDS[name], entry["reply"]))
    missing = set(KINDS) - {seed.name for seed in found}
    return found + [Seed(name, KINDS[name], empty_value(strict_schema(KINDS[name]))) for name in sorted(missing)]


def mutated(data: Any, draw: random.Random) -> str:
    """A damaged reply's text. `draw` may be hypothesis' own, which then shrinks what it finds."""
    tree = json.loads(json.dumps(data))
    if draw.random() < 0.7:
        for _ in range(draw.choice((1, 1, 2, 5))):
            tree = _other_value(tree, draw)
    text = json.dumps(tree, ensure_ascii=draw.random() < 0.5)
    if draw.random() < 0.5:
        for _ in range(draw.choice((1, 1, 3))):
            text = _damaged(text, draw)
    return text


def _other_value(tree: Any, draw: random.Random) -> Any:
    """The tree with one value at a random place replaced, left out, or put elsewhere. Changed in place."""
    holder, key = {"root": tree}, "root"
    root: Any = holder
    inner: Any = tree
    while isinstance(inner, (dict, list)) and inner and (holder is root or draw.random() < 0.85):
        keys: Sequence[Any] = list(inner) if isinstance(inner, dict) else range(len(inner))
        holder, key = inner, draw.choice(keys)
        inner = holder[key]
    way = draw.random()
    if way < 0.1 and holder is not root:
        del holder[key]
    elif way < 0.2 and isinstance(inner, (int, float)) and abs(inner) < 1e300:
        holder[key] = inner * draw.choice((-1, 0, 1e3, 1e-6, 1e30))
    elif way < 0.3 and isinstance(holder, dict) and holder is not root:
        holder[draw.choice(("ID", "x y", key.upper(), key + "_", "\ud800"))] = holder.pop(key)
    elif way < 0.4 and isinstance(holder, list):
        holder.extend(holder[:] if len(holder) < 200 else [])
    else:
        holder[key] = copy.deepcopy(draw.choice(VALUES))
    return root["root"]


def _damaged(text: str, draw: random.Random) -> str:
    """The text with one piece cut, doubled, moved or sprinkled in."""
    at, end = sorted((draw.randrange(len(text) + 1), draw.randrange(len(text) + 1)))
    near = min(end, at + draw.choice((1, 2, 10, 300)))
    ways: tuple[Callable[[], str], ...] = (
        lambda: text[:at],
        lambda: text[at:],
        lambda: text[:at] + text[near:],
        lambda: text[:near] + text[at:],
        lambda: text[:at] + draw.choice(SPRINKLES) + text[at:],
        lambda: text[:at] + draw.choice(SPRINKLES) + text[near:],
        lambda: f"Sure!\n```json\n{text}\n```\nAnything else?",
        lambda: text.replace('"', draw.choice(("'", "\u201d", "")), draw.choice((1, 4, -1))),
        lambda: text.replace(",", draw.choice((",,", "", ";")), draw.choice((1, -1))),
        lambda: text + text,
    )
    return draw.choice(ways)()


def not_finite(value: Any, path: str = "") -> Iterator[str]:
    """Where numbers are not finite, in anything that pydantic or JSON can hold."""
    if isinstance(value, BaseModel):
        value = value.model_dump()
    if isinstance(value, dict):
        for key, item in value.items():
            yield from not_finite(item, f"{path}.{key}")
    elif isinstance(value, (list, tuple, set, frozenset)):
        for number, item in enumerate(value):
            yield from not_finite(item, f"{path}[{number}]")
    elif isinstance(value, float) and not math.isfinite(value):
        yield path


def read_as(text: str, kind: type[BaseModel], salvage: bool, model: str = "") -> BaseModel | None:
    """The reply as a stage is given it, None when it is refused in words.

    Args:
        model: who is said to have answered; vendors' habits of giving places are read by it.

    Raises:
        AssertionError: a number that is not finite was let through, or an error is no sentence; whatever else was raised.
    """
    try:
        reply, notes = validate_reply(text, kind, salvage, lambda data: as_asked(data, model, SEEN))
    except ReplyError as error:
        assert error.message and "\n".join((*error.problems, str(error))).encode(), "an error in words"
        return None
    places = list(not_finite(reply))
    assert not places, f"not finite: {places[:5]}"
    reply.model_dump_json().encode()
    assert all(note.encode() for note in notes)
    return reply


def read(text: str, kind: type[BaseModel], salvage: bool, model: str = "") -> str:
    """How reading a reply ends: "read" or "refused". Raises as `read_as`."""
    return "refused" if read_as(text, kind, salvage, model) is None else "read"
