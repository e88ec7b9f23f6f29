"""The questions of the sample are, byte for byte, those that were recorded; only an artist's notes may change them."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.recorded import RecordedClient
from code_as_room.pipeline.picture import load_picture
from code_as_room.pipeline.run import Run

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"


@dataclass
class Listening:
    """The recorded answers, what was asked for them, and what the recordings say of the questions."""

    client: RecordedClient
    asked: list[str] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    name: str = "recorded"
    describes: str = ""

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        reply = self.client.answer(prompt, cancel, progress)
        self.asked.append(f"{prompt.stage}/{prompt.key}")
        self.told += reply.notes
        return reply


def test_the_samples_questions_are_those_that_were_recorded(scene: Any) -> None:
    recorded = json.loads((SAMPLE / "replies" / "replies.json").read_text(encoding="utf-8"))["replies"]
    client = Listening(RecordedClient(SAMPLE / "replies"))
    Run(load_picture(SAMPLE / "picture.png"), Memory(), client, scene).run_all()
    assert set(client.asked) == set(recorded)
    # Corrections of programs tell which renders they come with, and a scene without Blender has none.
    changed = [note for note in client.told if "words of the prompt" in note and "06_correct" not in note]
    assert changed == []
