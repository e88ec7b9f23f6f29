"""Results written from a memory alone hold what the artist changed by hand after the last stage."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bpy
from code_as_room.operators.outputs import write_outputs
from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.artifacts.hand import HandEdits
from code_as_room.pipeline.artifacts.layout import Layout, LayoutEdit, LayoutProgram, ProxyLine, RoomLine, Score
from code_as_room.pipeline.layout.walls import outer_walls
from code_as_room.pipeline.memory import EntryMeta, Memory, now
from code_as_room.pipeline.models.registry import ClientSettings, make_client
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.scene.backend import BlenderScene
from PIL import Image


def test_hand_edits_after_the_last_stage_are_in_the_results(calibration: Calibration, tmp_path: Path) -> None:
    Image.new("RGB", (300, 255), "grey").save(tmp_path / "room.png")
    picture = read_picture((tmp_path / "room.png").read_bytes(), "room.png")
    floor = calibration.floor
    proxies = [
        ProxyLine(id="bed", category="bed", centre=(0.0, 0.0, 0.3), size=(1.6, 2.0, 0.6)),
        ProxyLine(id="stool", category="stool", centre=(1.5, 1.0, 0.2), size=(0.4, 0.4, 0.4)),
    ]
    layout = Layout(room=RoomLine(size=(4.6, 3.9, 2.6), floor=floor), walls=outer_walls(floor, 2.6), proxies=proxies)
    parts: dict[str, Any] = dict.fromkeys(
        ("total", "measured", "coverage", "overlap", "bounds", "relations", "boxes"), 1.0
    )
    program = LayoutProgram(text=print_layout(layout), stage="s04_auxiliary", score=Score(**parts))
    edits = [
        LayoutEdit(op="rename", id="stool", new_id="pouf", origin="artist"),
        LayoutEdit(op="move", id="bed", centre=(-0.5, 0.2, 0.3), origin="artist"),
    ]
    memory, meta = Memory(), EntryMeta(time=now())
    for artifact in (calibration, program, HandEdits(edits=edits)):
        memory.append("test", artifact, meta)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    client = make_client(ClientSettings(kind="builtin"))
    write_outputs(Run(picture, memory, client, BlenderScene(bpy.context.scene)), tmp_path)
    found = {o["id"]: o for o in json.loads((tmp_path / "scene.json").read_text())["objects"]}
    assert set(found) == {"bed", "pouf"}
    assert [round(v, 3) for v in found["bed"]["centre"]] == [-0.5, 0.2, 0.3]
