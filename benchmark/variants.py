# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs stages 1 to 4 over a recording, changed by settings and by noise, without Blender: seconds a run.

The stages, prompts, validation and memory are the real ones. What is left out is Blender: `benchmark/plain_backend.py` holds
the program and draws its boxes with Pillow, so the pictures that a critique would be sent are plainer than Blender's. Since
every answer comes from a recording or from the stand-in, nobody looks at them; only their outlines count.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.artifacts.scene import SceneDocument
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory, dump_memory
from code_as_room.pipeline.picture import ReferencePicture, load_picture
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run, StageReport
from code_as_room.pipeline.stages import all_stages

from .noisy_client import NoisyClient
from .plain_backend import PlainBackend
from .seen import Seen, seen_in
from .strengths import NONE, Strength

LAST = "s04_auxiliary"


@dataclass(frozen=True)
class Recording:
    """A picture, the folder of the answers recorded for it, and what their model saw."""

    picture: ReferencePicture
    folder: Path
    seen: Seen


@dataclass(frozen=True)
class Outcome:
    """What one run gave.

    Attributes:
        document: the room as `scene.json`; shapes: by id, which it does not hold; memory: everything that was answered and decided.
        reports: what each stage took; simulated: keys of the requests that no recording answered.
        seconds: the whole run, on this machine.
    """

    document: SceneDocument
    shapes: Mapping[str, str]
    memory: Memory
    reports: tuple[StageReport, ...]
    simulated: tuple[str, ...]
    seconds: float

    @property
    def calls(self) -> int:
        """Requests that were sent."""
        return sum(report.calls for report in self.reports)

    @property
    def prompt_bytes(self) -> int:
        """Bytes of prompt text that were sent."""
        return sum(report.prompt_bytes for report in self.reports)


def load_recording(picture: Path, folder: Path) -> Recording:
    """A picture with its recording.

    Raises:
        RoomError: the picture or the recording cannot be read, or the recording has no first answer.
    """
    loaded = load_picture(picture)
    return Recording(loaded, folder, seen_in(folder, loaded))


def run_variant(
    recording: Recording, settings: Mapping[str, str] | None = None, strength: Strength = NONE, seed: int = 0
) -> Outcome:
    """Stages 1 to 4 with these settings, answered by a stand-in of this strength.

    Args:
        settings: as `View.settings` has them, such as `{"rounds": "3"}` or `{"evidence": "metres"}`.
        seed: chooses the errors; without meaning at strength "none".

    Raises:
        RoomError: a stage failed.
    """
    backend = PlainBackend()
    client = NoisyClient(recording.folder, recording.seen, strength, seed, lambda: backend.shown)
    run = Run(recording.picture, Memory(settings=dict(settings or {})), client, backend)
    began = time.perf_counter()
    reports = run.run_all([stage for stage in all_stages() if stage.id <= LAST])
    calibration = run.memory.latest(Calibration)
    if calibration is None:
        raise RoomError("The run has no calibration.", "Look at its memory.")
    document = backend.scene_document(recording.picture.name, calibration.camera)
    shapes = {p.id: p.shape for p in parse_layout(backend.program_text()).proxies}
    return Outcome(document, shapes, run.memory, tuple(reports), tuple(client.simulated), time.perf_counter() - began)


def write_run(outcome: Outcome, folder: Path) -> None:
    """`scene.json` and `memory.json`, as a run of the command would have left them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.json").write_text(outcome.document.model_dump_json(indent=1) + "\n", encoding="utf-8")
    (folder / "memory.json").write_text(dump_memory(outcome.memory), encoding="utf-8")
