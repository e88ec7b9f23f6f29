# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms of a few objects, for reading damaged answers in a fraction of a second, and a good answer to each of their questions.

A recording is cut down to a few objects and a small picture.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from code_as_room.pipeline.models.recorded import load_replies
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from PIL import Image

from .fuzz_replies import HERE, KINDS, SAMPLE, Seed

LONG_SIDE = 256
"""Pixels of the small pictures."""
_BEDROOM = ("nightstand_upper", "table_lamp_upper", "bench_1", "laptop_1", "picture_1")
_OTHERS = 6
_WHOLE = ("02_graph", "05_descriptions")
"""Kinds whose questions are also asked of the whole bedroom, since reading them takes little time."""
AGAIN = "01_again"
_UNASKED = ("03_critique/1",)
"""One round of critique is enough: the answer to a second one would be read by the same code."""
_PLACED = {
    "id": "laptop_1",
    "placement": "surface",
    "parent": "bench_1",
    "base_m": 0.45,
    "height_m": 0.04,
    "drop": False,
    "reason": "it lies on the bench",
}
_PIECES: tuple[tuple[str, str, dict[str, str]], ...] = (
    ("nightstand_upper", "nightstand", {"drawers": "2"}),
    ("table_lamp_upper", "table_lamp", {}),
    ("laptop_1", "laptop", {}),
    ("bench_1", "bench", {}),
    ("picture_1", "picture_frame", {}),
)


@dataclass(frozen=True)
class Room:
    """A recording: its picture, and its answers by stage and key. `kinds` are those whose questions are waited at."""

    name: str
    picture: ReferencePicture
    replies: Mapping[str, Any]
    kinds: tuple[str, ...]


@cache
def rooms() -> dict[str, Room]:
    """All rooms by name."""
    found: dict[str, Room] = {}
    sample = _recorded(SAMPLE / "replies")
    small = _few(sample, _BEDROOM)
    small["s04_auxiliary/04_auxiliary"] = {"placements": [_PLACED]}
    small["s06_geometry/06_pieces"] = {"objects": [_piece(*piece) for piece in _PIECES]}
    picture = _small_picture(SAMPLE / "picture.png")
    found["bedroom"] = Room("bedroom", picture, small, (*KINDS, AGAIN))
    found["whole"] = Room("whole", picture, sample, _WHOLE)
    for path in sorted((HERE / "recordings").rglob("replies.json")):
        name = path.parent.parent.name
        replies = _recorded(path.parent)
        ids = [o["id"] for o in replies["s01_analysis/01_analysis"]["objects"]]
        kinds = ("01_analysis", "01_second_look", "02_graph", "03_critique")
        picture = _small_picture(_picture_of(HERE / "pictures" / name))
        found[name] = Room(name, picture, _few(replies, ids[:_OTHERS]), kinds)
    return found


def waiting_seeds() -> dict[tuple[str, str], Seed]:
    """A good answer for each question that a stage waits at, by the room's name and the request's key."""
    found = {}
    for room in rooms().values():
        for place, data in room.replies.items():
            key = place.partition("/")[2]
            kind = key.partition("/")[0]
            if kind in room.kinds and key not in _UNASKED:
                found[room.name, key] = Seed(kind, KINDS[kind], data)
        if AGAIN in room.kinds:
            found[room.name, AGAIN] = Seed(AGAIN, KINDS["01_second_look"], room.replies["s01_analysis/01_second_look"])
    return found


def _recorded(folder: Path) -> dict[str, Any]:
    return {place: entry["reply"] for place, entry in load_replies(folder).items() if "reply" in entry}


def _few(replies: Mapping[str, Any], ids: Sequence[str]) -> dict[str, Any]:
    """The answers as they would be of a room of these objects only."""
    gone = {o["id"] for o in replies["s01_analysis/01_analysis"]["objects"]} - set(ids)
    few = {place: _without(data, gone) for place, data in replies.items()}
    for kind in ("05_descriptions", "06_programs", "06_correct"):
        places = [place for place in few if place.partition("/")[2].startswith(f"{kind}/")]
        objects = [o for place in places for o in few[place]["objects"]]
        for place in places[1:]:
            del few[place]
        if places:
            few[places[0]] = {**few[places[0]], "objects": objects}
    return few


def _without(data: Any, gone: set[str]) -> Any:
    """The data without list entries that are, or speak of, something that is gone; what stands on it says so still."""
    if isinstance(data, dict):
        return {key: _without(value, gone) for key, value in data.items()}
    if not isinstance(data, list):
        return data
    return [_without(item, gone) for item in data if not _speaks_of(item, gone)]


def _speaks_of(item: Any, gone: set[str]) -> bool:
    named = [item.get(k) for k in ("id", "source", "target")] if isinstance(item, dict) else [item]
    return any(isinstance(name, str) and name in gone for name in named)


def _piece(identifier: str, piece: str, parameters: Mapping[str, str]) -> dict[str, Any]:
    listed = [{"name": name, "value": value} for name, value in parameters.items()]
    colours = [{"role": "wood", "colour": "#C6A882"}, {"role": "fabric", "colour": "#C8BFB3"}]
    return {"id": identifier, "piece": piece, "parameters": listed, "colours": colours}


def _picture_of(folder: Path) -> Path:
    return next(path for path in sorted(folder.iterdir()) if path.suffix in (".png", ".jpg"))


def _small_picture(path: Path) -> ReferencePicture:
    with Image.open(path) as image:
        small = image.convert("RGB")
    small.thumbnail((LONG_SIDE, LONG_SIDE))
    data = io.BytesIO()
    small.save(data, "PNG")
    return read_picture(data.getvalue(), path.name)
