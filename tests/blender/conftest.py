"""The command, called in this process on a small picture with prepared answers, and what it leaves behind."""

from __future__ import annotations

import copy
import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from code_as_room.operators import command, outputs
from code_as_room.pipeline.artifacts.analysis import Finding, SceneAnalysis
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.report import all_findings
from PIL import Image

sys.path.append(str(Path(__file__).parent))  # for what tests share: they are imported by their paths

RESULTS = {"room.py", "room.blend", "scene.json", "memory.json", "top.png", "view.png", "report.html"}
KEYS = {
    "analysis": "s01_analysis/01_analysis",
    "second_look": "s01_analysis/01_second_look",
    "graph": "s02_graph/02_graph",
    "critique": "s03_layout/03_critique/0",
    "auxiliary": "s04_auxiliary/04_auxiliary",
}


@dataclass
class Outcome:
    """How one call of the command ended."""

    code: int
    out: str
    err: str
    folder: Path

    @property
    def files(self) -> set[str]:
        return {p.name for p in self.folder.iterdir()} if self.folder.is_dir() else set()

    @property
    def memory(self) -> Memory:
        return load_memory((self.folder / "memory.json").read_text(encoding="utf-8"))

    @property
    def findings(self) -> list[Finding]:
        return all_findings(self.memory)

    @property
    def scene(self) -> dict[str, Any]:
        result: dict[str, Any] = json.loads((self.folder / "scene.json").read_text(encoding="utf-8"))
        return result

    def finished(self) -> Outcome:
        """Check that there is a whole room, and nothing else."""
        assert self.code == 0, self.err
        assert self.files - {"textures"} == RESULTS and all((self.folder / name).stat().st_size for name in RESULTS)
        return self

    def failed(self, *, files: frozenset[str] | set[str] = frozenset()) -> str:
        """Check that it ended in one plain sentence and left only these files; returns what it said."""
        assert self.code == 1 and self.files == files
        lines = self.err.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("code-as-room: ") and lines[0].endswith(".")
        assert not any(word in lines[0] for word in ("Traceback", "unexpected problem", "Error:", "site-packages"))
        return lines[0]

    def told(self, about: str) -> str:
        """What the findings say about one thing."""
        return " ".join(f.message for f in self.findings if f.about == about)


@dataclass
class Room:
    """A picture, the answers to every question about it, and the folder for results."""

    home: Path
    answers: dict[str, Any]
    capture: pytest.CaptureFixture[str]
    picture: Path = field(init=False)

    def __post_init__(self) -> None:
        self.picture, self.out = self.home / "room.png", self.home / "out"
        Image.new("RGB", (240, 204), "white").save(self.picture)

    @property
    def analysis(self) -> dict[str, Any]:
        """The first answer, to be changed by a test."""
        result: dict[str, Any] = self.answers["analysis"]
        return result

    def object(self, identifier: str) -> dict[str, Any]:
        """One object of the first answer."""
        return next(o for o in self.analysis["objects"] if o["id"] == identifier)

    def record(self) -> Path:
        """Write the answers as a folder of recordings; a text stands for itself, None for no answer."""
        folder = self.home / "replies"
        folder.mkdir(exist_ok=True)
        replies = {
            KEYS[name]: {"text" if isinstance(value, str) else "reply": value, "model": "test"}
            for name, value in self.answers.items()
            if value is not None
        }
        (folder / "replies.json").write_text(
            json.dumps({"format": "code-as-room/replies/1", "replies": replies}), encoding="utf-8"
        )
        return folder

    def arguments(self, *more: str) -> list[str]:
        return [str(self.picture), "--out", str(self.out), "--replies", str(self.record()), *more]

    def make(self, *more: str) -> Outcome:
        """Call the command with the recordings and without rounds of critique, unless told otherwise."""
        given = more if "--iterations" in more else ("--iterations", "0", *more)
        return self.call(self.arguments(*given))

    def call(self, arguments: list[str]) -> Outcome:
        self.capture.readouterr()
        code = command.cli_main(arguments, "code-as-room")
        said = self.capture.readouterr()
        return Outcome(code, said.out, said.err, self.out)


def first_answer(analysis: SceneAnalysis) -> dict[str, Any]:
    """What a model that sees perfectly answers to the first request."""
    names = ("width", "depth", "height")
    return {
        "view": analysis.view,
        "room_type": "bedroom",
        "room_width_m": analysis.room_size[0],
        "room_depth_m": analysis.room_size[1],
        "wall_height_m": analysis.room_size[2],
        "floor_polygon": [p.model_dump() for p in analysis.floor_polygon],
        "wall_top_polygon": [p.model_dump() for p in analysis.wall_top_polygon or []],
        "architecture": [
            {"id": "door_1", "kind": "door", "start": {"x_m": 1.0, "y_m": -1.95}, "end": {"x_m": 1.85, "y_m": -1.95},
             "height_m": 2.05, "wall": "bottom"}
        ],
        "objects": [
            {
                "id": o.id, "category": o.category, "placement": o.placement, "parent": o.parent,
                "salience": o.salience, "box": o.box.model_dump() if o.box else None, "yaw_deg": o.yaw,
                "centre_m": {"x_m": o.centre[0], "y_m": o.centre[1]}, "base_m": o.centre[2] - o.size[2] / 2,
                "size_m": dict(zip(names, o.size, strict=True)), "confidence": 0.9,
            }
            for o in analysis.objects
        ],
    }  # fmt: skip


@pytest.fixture
def room(
    tmp_path: Path,
    analysis: SceneAnalysis,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> Room:
    """A room whose answers are right; results are drawn small."""
    monkeypatch.setattr(outputs, "LONG_SIDE", 96)
    for name in ("CODE_AS_ROOM_DEBUG", "CODE_AS_ROOM_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    answers = {
        "analysis": first_answer(analysis),
        "second_look": {"missed": [], "corrections": []},
        "graph": {"attributes": [], "relations": []},
        "critique": {"score": 90, "edits": []},
        "auxiliary": {"placements": []},
    }
    return Room(tmp_path, copy.deepcopy(answers), capsys)
