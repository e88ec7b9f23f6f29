"""A model that sees perfectly (and can be told to misbehave), and a scene that only remembers."""

from __future__ import annotations

import copy
import io
import json
import threading
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import LayoutEdit
from code_as_room.pipeline.artifacts.scene import SceneDocument
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import s01_analysis
from PIL import Image

EMPTY = {
    "01_second_look": {"missed": [], "corrections": []},
    "02_graph": {"attributes": [], "relations": []},
    "03_critique": {"score": 90, "remarks": "", "edits": []},
    "04_auxiliary": {"placements": []},
    "05_descriptions": {"room_style": "", "objects": []},
    "06_pieces": {"objects": []},
    "06_programs": {"objects": []},
    "06_correct": {"objects": []},
    "08_materials": {"palette": [], "objects": []},
    "10_light": {"style": "soft daylight"},
}


@dataclass
class Answers:
    """Answers by the beginning of the request's key; a value may be a dict, a text, or a function of the prompt."""

    by_key: dict[str, Any]
    name: str = "answers"
    describes: str = "Answers written by a test."
    asked: list[Prompt] = field(default_factory=list)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(prompt)
        value = next(v for k, v in {**EMPTY, **self.by_key}.items() if prompt.key.startswith(k))
        if callable(value):
            value = value(prompt)
        text = value if isinstance(value, str) else json.dumps(value)
        return Reply(text=text, model="test", prompt_tokens=10, completion_tokens=5, cost=0.01)


class PlainScene:
    """A scene without Blender: remembers the program, renders grey, and hands out prepared hand edits."""

    def __init__(self) -> None:
        self.text, self.memory, self.built = "", "", []
        self.edits: list[LayoutEdit] = []
        self.images: dict[str, bytes] = {}

    def keep_images(self, images: Mapping[str, bytes]) -> None:
        self.images.update(images)

    def kept_images(self, names: Collection[str]) -> dict[str, bytes]:
        return {name: self.images[name] for name in names if name in self.images}

    def has_images(self, names: Collection[str]) -> bool:
        return all(name in self.images for name in names)

    def build(self, text: str) -> None:
        self.text = text
        self.built.append(text)

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        buffer = io.BytesIO()
        Image.new("RGB", (long_side // 4, long_side // 4), "grey").save(buffer, "PNG")
        return buffer.getvalue()

    def read_back(self) -> list[LayoutEdit]:
        edits, self.edits = self.edits, []
        return edits

    def load_memory(self) -> str:
        return self.memory

    def save_memory(self, text: str) -> None:
        self.memory = text

    def program_text(self) -> str:
        return self.text

    def render_view(self, long_side: int) -> bytes:
        return b""

    def scene_document(self, image: str, camera: CameraModel) -> SceneDocument:
        raise NotImplementedError("a scene without Blender has no document")

    def save_copy(self, path: Path) -> None:
        path.write_bytes(b"")


def analysis_reply(analysis: SceneAnalysis) -> dict[str, Any]:
    """What a model that sees perfectly answers to the first request."""
    return {
        "view": analysis.view,
        "room_type": "bedroom",
        "room_width_m": analysis.room_size[0],
        "room_depth_m": analysis.room_size[1],
        "wall_height_m": analysis.room_size[2],
        "floor_polygon": [p.model_dump() for p in analysis.floor_polygon],
        "wall_top_polygon": [p.model_dump() for p in analysis.wall_top_polygon or []],
        "zones": [],
        "architecture": [
            {"id": "door_1", "kind": "door", "start": {"x_m": 1.0, "y_m": -1.95}, "end": {"x_m": 1.85, "y_m": -1.95},
             "height_m": 2.05, "sill_m": 0, "thickness_m": 0.1, "wall": "bottom", "box": None, "swing": "in"}
        ],
        "objects": [
            {
                "id": o.id, "category": o.category, "label": "", "placement": o.placement, "parent": o.parent,
                "salience": o.salience, "zone": None, "shape": "box", "box": o.box.model_dump() if o.box else None,
                "centre_m": {"x_m": o.centre[0], "y_m": o.centre[1]}, "base_m": o.centre[2] - o.size[2] / 2,
                "size_m": dict(zip(("width", "depth", "height"), o.size, strict=True)), "facing": "none",
                "yaw_deg": o.yaw, "confidence": 0.9,
            }
            for o in analysis.objects
        ],
    }  # fmt: skip


_fitted: dict[str, Any] = {}
_fit = s01_analysis.calibrate


def _calibrate(analysis: SceneAnalysis, *rest: Any, **more: Any) -> Any:
    """The camera of a picture, found once for each analysis; it depends on nothing else and takes half of a small run."""
    key = repr((analysis.model_dump_json(), rest, sorted(more.items(), key=str)))
    if key not in _fitted:
        _fitted[key] = _fit(analysis, *rest, **more)
    return copy.deepcopy(_fitted[key])


@pytest.fixture(autouse=True)
def _cameras_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(s01_analysis, "calibrate", _calibrate)


@pytest.fixture
def picture() -> ReferencePicture:
    buffer = io.BytesIO()
    Image.new("RGB", (1200, 1020), "white").save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


@pytest.fixture
def answers(analysis: SceneAnalysis) -> Answers:
    return Answers({"01_analysis": analysis_reply(analysis)})


@pytest.fixture
def scene() -> PlainScene:
    return PlainScene()


@pytest.fixture
def run(picture: ReferencePicture, answers: Answers, scene: PlainScene) -> Run:
    return Run(picture, Memory(), answers, scene)
