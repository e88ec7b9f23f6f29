# SPDX-License-Identifier: GPL-3.0-or-later
"""Any chat, by hand, as the sidebar's buttons do it: a run waits, prompts are copied, answers pasted, Stop works."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import by_hand, clients, desk, driver, talk_ops, view_state
from code_as_room.panels import by_hand as panel
from code_as_room.pipeline.models.manual import ManualClient

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "samples" / "bedroom" / "picture.png"
REPLIES = json.loads((ROOT / "samples" / "bedroom" / "replies" / "replies.json").read_text(encoding="utf-8"))["replies"]
ours: Any = bpy.ops.code_as_room  # type: ignore[attr-defined]


class Layout:
    """Notes what is drawn, with the buttons' settings."""

    def __init__(self, drawn: list[Any] | None = None) -> None:
        self.drawn: list[Any] = [] if drawn is None else drawn

    def row(self, *args: Any, **options: Any) -> Layout:
        return Layout(self.drawn)

    column = row

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.drawn.append(text)

    def operator(self, name: str, **options: Any) -> Any:
        self.drawn.append(name)
        return SimpleNamespace()


@pytest.fixture(autouse=True)
def room(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Any]:
    """A scene with the sample's picture, and answers by hand."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    monkeypatch.setattr(clients, "current_client", lambda: desk.make_client(str(tmp_path / "pictures")))
    ours.load_picture(filepath=str(PICTURE))
    yield bpy.context.scene
    driver.stop()
    code_as_room.unregister()


def tick_until(holds: Callable[[], Any]) -> None:
    """What the window's timer does, until something holds."""
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end
        if driver.is_running():
            driver._tick()
        time.sleep(0.01)


def start(stage: str) -> None:
    from code_as_room.pipeline.stages import all_stages

    driver.start(bpy.context.scene, [s for s in all_stages() if s.id == stage])


def drawn() -> str:
    layout: Any = Layout()
    context = SimpleNamespace(region=SimpleNamespace(width=300), preferences=bpy.context.preferences)
    panel.draw_question(layout, context, by_hand.waiting()[0], len(by_hand.waiting()))
    return " ".join(str(part) for part in layout.drawn)


def paste(text: str) -> Any:
    """What the artist has in the clipboard is pasted; the bpy module has no clipboard of its own."""
    block = bpy.data.texts.new("answer")
    block.from_string(text)
    try:
        return ours.answer_from_text(text=block.name)
    except RuntimeError as error:
        return str(error)
    finally:
        bpy.data.texts.remove(block)


def test_a_stage_is_done_with_what_was_pasted_and_every_answer_goes_the_usual_way(tmp_path: Path) -> None:
    start("s01_analysis")
    tick_until(by_hand.waiting)
    assert "Analysis" in drawn() and "code_as_room.copy_prompt" in drawn() and "code_as_room.paste_answer" in drawn()
    assert "Paste the prompt into any chat" in drawn()
    assert len(list((tmp_path / "pictures").rglob("*.jpg"))) >= 2
    assert paste("Sorry, no.") == {"CANCELLED"} and "no readable JSON" in drawn()
    paste('{"view": "perspective"}')
    tick_until(lambda: by_hand.waiting() and by_hand.waiting()[0].prompt.repair)
    assert "could not be used" in drawn() and "room_width_m" in by_hand.waiting()[0].text
    while driver.is_running():
        tick_until(lambda: by_hand.waiting() or not driver.is_running())
        if by_hand.waiting():
            prompt = by_hand.waiting()[0].prompt
            answer = json.dumps(REPLIES[f"{prompt.stage}/{prompt.key}"]["reply"])
            assert paste(f"Here you are:\n```json\n{answer}\n```\nAnything else?") == {"FINISHED"}
            tick_until(lambda p=prompt: not by_hand.waiting() or by_hand.waiting()[0].prompt is not p)
    state = view_state.peek(bpy.context.scene)
    assert state is not None and state.stage("s01_analysis").status == "done"
    assert not list((tmp_path / "pictures").rglob("*.*")) and by_hand.waiting() == ()
    text = bpy.data.texts.get(talk_ops.NAME)
    assert text is None and ours.show_prompts() == {"FINISHED"}
    shown = bpy.data.texts[talk_ops.NAME].as_string()
    assert (
        "You see one picture of a room" in shown and '{"view": "perspective"}' in shown and "a chat, by hand" in shown
    )


def test_stop_ends_the_wait_and_what_was_answered_is_kept() -> None:
    start("s01_analysis")
    tick_until(by_hand.waiting)
    ours.stop()
    tick_until(lambda: not driver.is_running())
    assert by_hand.waiting() == ()
    outcome = driver.outcome_of(bpy.context.scene)
    assert outcome is not None and outcome.problem is None
    assert not ours.paste_answer.poll()


def test_stopped_in_the_middle_the_former_room_is_put_back_in_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    from code_as_room.pipeline.models.builtin.client import BuiltinClient
    from code_as_room.pipeline.stages import all_stages

    by_chat = clients.current_client
    monkeypatch.setattr(clients, "current_client", BuiltinClient)
    driver.start(bpy.context.scene, [s for s in all_stages() if s.id < "s07"])
    assert driver.run_blocking().problem is None
    before = bpy.data.texts["room.py"].as_string()
    monkeypatch.setattr(clients, "current_client", by_chat)
    driver.start(bpy.context.scene, [s for s in all_stages() if s.id == "s03_layout"], again=True, fresh=True)
    tick_until(by_hand.waiting)
    assert bpy.data.texts["room.py"].as_string() != before
    driver.stop()
    phases = []
    while driver.is_running():
        driver._tick()
        phases.append(driver._job.phase if driver._job is not None else "over")
        time.sleep(0.01)
    assert phases.count("putting the room back") > 1, "one mesh a slice, not all at once"
    assert bpy.data.texts["room.py"].as_string() == before
    assert not [mesh.name for mesh in bpy.data.meshes if mesh.users == 0]


def test_a_question_that_is_skipped_and_needed_ends_the_stage_with_a_sentence() -> None:
    start("s01_analysis")
    tick_until(by_hand.waiting)
    ours.skip_question(number=by_hand.waiting()[0].number)
    tick_until(lambda: not driver.is_running())
    outcome = driver.outcome_of(bpy.context.scene)
    assert outcome is not None and outcome.problem is not None and "skipped" in outcome.problem.message


def test_the_preferences_choice_makes_this_client_only_where_there_is_a_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    preferences = SimpleNamespace(provider="MANUAL", by_hand_folder="")
    monkeypatch.setattr(clients, "add_on_preferences", lambda: preferences)
    with pytest.raises(Exception, match="Blender's window"):
        clients.current_client()
    monkeypatch.setattr(clients, "has_window", lambda: True)
    assert isinstance(clients.current_client(), ManualClient) and clients.service_host() == ""
    estimate = clients.run_estimate(["s01_analysis", "s02_graph"], 5)
    assert estimate is not None and estimate.sentence().startswith("3 to 6 questions")
