# SPDX-License-Identifier: GPL-3.0-or-later
"""Draft or stages, as the artist meets it: what is offered, remembered, shown, run by whom, refined and gone on from."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, draft_ops, driver, late, room_memory, todo, view_state, ways
from code_as_room.operators.todo import Todo, refining
from code_as_room.pipeline.artifacts.draft import DraftProgram
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.refine import Step
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.builtin.client import BuiltinClient
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.models.recorded import FILE_NAME, FORMAT, RecordedClient
from code_as_room.pipeline.stages import all_stages
from PIL import Image


class Drafter:
    """Writes the example room in one answer, and has nothing to add to anything else."""

    describes = "A model for tests"

    def __init__(self, name: str = "openai:strong") -> None:
        self.name, self.asked = name, []  # type: ignore[var-annotated]

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(f"{prompt.stage}/{prompt.key}")
        if prompt.plain:
            return Reply(EXAMPLE, "strong-1", 1000, 2000, 0.05)
        return Reply(json.dumps(empty_value(prompt.schema)), "strong-1", 100, 20, 0.01)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """A file with a room in it that was drafted to the end, and what was asked for it."""
    drafter, folder = Drafter(), tmp_path_factory.mktemp("draft")
    with pytest.MonkeyPatch.context() as patch:
        answered_by(patch, drafter)
        begin(folder)
        bpy.ops.code_as_room.draft_room()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "room.blend"))
        end()
    return folder / "room.blend", drafter.asked


@pytest.fixture
def drafted(made: tuple[Path, list[str]], monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Any, Drafter]]:
    """The drafted room, opened anew, and who drafted it."""
    drafter = Drafter()
    answered_by(monkeypatch, drafter)
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=str(made[0]))
    yield bpy.context.scene, drafter
    end()


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Any], Any]]:
    """Gives a scene with a picture and nothing else, for a client that answers."""

    def make(client: Any) -> Any:
        answered_by(monkeypatch, client)
        return begin(tmp_path)

    yield make
    end()


def answered_by(patch: pytest.MonkeyPatch, client: Any) -> None:
    patch.setattr(clients, "room_client", lambda *a, **k: client)
    patch.setattr(clients, "current_client", lambda *a, **k: client)


def begin(folder: Path) -> Any:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    path = folder / "room.png"
    Image.new("RGB", (1000, 1000), "tan").save(path)
    bpy.ops.code_as_room.load_picture(filepath=str(path))
    return bpy.context.scene


def end() -> None:
    ways.forget()
    late.forget_all()
    code_as_room.unregister()


def rows(scene: Any) -> dict[str, str]:
    state = view_state.refresh(scene)
    return {row.id: row.status for row in state.stages}


def test_one_question_and_a_second_look_make_the_whole_room(drafted, made):
    scene, asked = drafted[0], made[1]
    assert asked[0] == "s00_draft/draft" and set(asked[1:]) <= {"s01_analysis/01_second_look"}
    assert rows(scene) == {"s00_draft": "done", **{stage.id: "drafted" for stage in all_stages()}}
    state = view_state.peek(scene)
    assert state.way == "draft" and not state.left and state.has_draft and state.verdict
    assert {"armchair_1", "mug_1", "pouf_2"} <= {row.name for row in state.objects}
    assert bpy.data.objects.get("armchair_1") is not None


def test_nothing_is_left_to_run_and_refining_is_offered(drafted):
    scene, _ = drafted
    rows(scene)
    assert not bpy.ops.code_as_room.run_all.poll() and bpy.ops.code_as_room.refine_all.poll()


def test_going_on_stage_by_stage_keeps_what_was_understood(drafted):
    scene, drafter = drafted
    objects = len(scene.objects)
    bpy.ops.code_as_room.go_staged()
    assert rows(scene) == {stage.id: "drafted" for stage in all_stages()}
    assert scene.code_as_room.way == "STAGES" and len(scene.objects) == objects
    assert [row.id for row in view_state.peek(scene).left] == [stage.id for stage in all_stages()]
    assert bpy.ops.code_as_room.run_all.poll() and ways.chosen(drafter) == "stages"
    scene.code_as_room.way = "DRAFT"
    assert rows(scene)["s00_draft"] == "done" and not view_state.peek(scene).left


def test_a_drafted_stage_that_is_run_is_asked_of_the_model(drafted):
    scene, drafter = drafted
    rows(scene)
    bpy.ops.code_as_room.run_stage(stage="s10_finish")
    assert drafter.asked and {key.partition("/")[0] for key in drafter.asked} == {"s10_finish"}
    assert rows(scene)["s10_finish"] == "done" and rows(scene)["s09_textures"] == "drafted"


@pytest.mark.parametrize("better", [True, False])
def test_a_step_of_refining_that_makes_the_room_no_better_is_taken_back(drafted, monkeypatch, better):
    """The room stands as before and the stage is as it was drafted; what the model answered stays in memory."""
    scene, drafter = drafted
    monkeypatch.setattr(todo, "is_better", lambda memory, before: better)
    rows(scene)
    before = bpy.data.objects["armchair_1"].location.copy()
    step = Step("s03_layout", None, "The layout fits badly.", (1, 3))
    monkeypatch.setattr(draft_ops, "plan", lambda memory: [step])
    wrong = {"op": "resize", "id": "armchair_1", "reason": "no", "size_m": {"width": 2.0, "depth": 2.0, "height": 2.0}}

    def misled(prompt, cancel, progress=None):
        drafter.asked.append(prompt.key)
        value = empty_value(prompt.schema)
        return Reply(json.dumps({**value, "score": 20, "edits": [wrong]} if "edits" in value else value), "strong-1")

    monkeypatch.setattr(drafter, "answer", misled)
    bpy.ops.code_as_room.refine_all()
    assert any("critique" in key for key in drafter.asked)
    assert rows(scene)["s03_layout"] == ("done" if better else "drafted") and not view_state.peek(scene).left
    assert any("taken back" in notice for notice in driver.outcome_of(scene).notices) is not better
    answers = [e for e in room_memory.memory_of(scene).entries if e.type == "Answer" and e.meta.model == "strong-1"]
    assert any("critique" in str(entry.output["key"]) for entry in answers)
    assert (bpy.data.objects["armchair_1"].location - before).length < 0.05
    assert bpy.data.objects["armchair_1"].dimensions.x < 1.5


def test_what_a_step_does_not_ask_for_is_answered_from_the_draft():
    real, drafter, stages = Drafter("real"), Drafter("draft:real"), all_stages()
    steps = [Step("s06_geometry", frozenset({"desk"}), "A stock piece.", (1, 2))]
    made = refining(steps, stages, real, drafter)
    assert [item.stage.id for item in made if item.client is real] == ["s06_geometry"]
    asked = next(item for item in made if item.client is real)
    assert asked.only == frozenset({"desk"}) and asked.again and asked.keeps_best
    assert made[-1] == Todo(stages[-1], drafter)


def test_the_built_in_analysis_offers_no_draft(empty):
    scene = empty(BuiltinClient())
    state = view_state.refresh(scene)
    assert not state.offers_draft and [row.id for row in state.stages] == [stage.id for stage in all_stages()]
    assert not bpy.ops.code_as_room.draft_room.poll()


@pytest.mark.parametrize(
    ("name", "way"), [("openai:strong", "draft"), ("openai:gpt-mini", "stages"), ("ollama:x", "stages")]
)
def test_strong_models_draft_by_default_and_weak_ones_go_stage_by_stage(empty, name, way):
    state = view_state.refresh(empty(Drafter(name)))
    assert state.way == way and state.offers_draft


def test_the_choice_is_remembered_for_its_provider_only(empty, monkeypatch, tmp_path):
    scene = empty(Drafter())
    monkeypatch.setattr(clients, "user_folder", lambda: tmp_path)
    scene.code_as_room.way = "STAGES"
    ways.forget()  # another session
    assert view_state.refresh(scene).way == "stages" and scene.code_as_room.way == "STAGES"
    monkeypatch.setattr(ways, "provider", lambda: "ANOTHER")
    assert view_state.refresh(scene).way == "draft"


@pytest.mark.parametrize("has_draft", [True, False])
def test_recorded_answers_offer_a_draft_where_they_hold_one(empty, tmp_path, has_draft):
    replies = {"s00_draft/draft" if has_draft else "s01_analysis/01_analysis": {"text": EXAMPLE}}
    (tmp_path / FILE_NAME).write_text(json.dumps({"format": FORMAT, "replies": replies}), encoding="utf-8")
    assert view_state.refresh(empty(RecordedClient(tmp_path))).offers_draft is has_draft


def test_a_draft_that_fails_is_told_at_its_row_and_nothing_else_runs(empty):
    class Refuses(Drafter):
        def answer(self, prompt, cancel, progress=None):
            self.asked.append(prompt.key)
            raise ModelError("The service is closed.", "Come back tomorrow.")

    client = Refuses()
    scene = empty(client)
    with pytest.raises(RuntimeError, match="closed"):
        bpy.ops.code_as_room.draft_room()
    assert client.asked == ["draft"] and rows(scene)["s00_draft"] == "failed"
    assert room_memory.memory_of(scene).latest(DraftProgram) is None and driver.outcome_of(scene) is not None
