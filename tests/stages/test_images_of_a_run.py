# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted and kept images as a run performs them, in a scene without Blender."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.textures import Texture, Textures
from code_as_room.pipeline.errors import Cancelled, RoomError
from code_as_room.pipeline.models.image_base import ImageRequest, PaintedImage
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages.base import Stage, View
from code_as_room.pipeline.stages.texture_wishes import KeepImages, Paint, PaintRequest
from code_as_room.pipeline.stages.wishes import StageRun
from code_as_room.pipeline.textures.kept import KeptImages

VALUES = {"what": "oak", "width": "2", "depth": "2", "colours": "#AA8866", "pattern": "", "style": "calm"}


class Painter:
    """Paints a new image each time; may stop the run meanwhile."""

    name, describes = "test-images", "A test's image model"

    def __init__(self, stops: threading.Event | None = None) -> None:
        self.painted, self.stops = 0, stops

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        if self.stops is not None:
            self.stops.set()
            raise Cancelled
        self.painted += 1
        return PaintedImage(f"image {self.painted}".encode(), "painter-1", cost=0.04, seconds=2.0)


def paints(view: View) -> StageRun:
    painted = yield Paint((PaintRequest("09_surface/floor", "09_surface", "09_simple", VALUES),))
    if painted is None:
        return [Textures(surfaces=[Texture(surface="floor", kind="floor")])]
    yield KeepImages({"floor_1": painted[0].data})
    return [Textures(surfaces=[Texture(surface="floor", kind="floor", source="model", name="floor_1")])]


STAGE = Stage("s09_textures", "Textures", (), (Textures,), paints)


def test_what_an_image_costs_is_in_memory_and_the_image_is_not(run: Run, scene: Any) -> None:
    run.painter = Painter()
    report = run.run_stage(STAGE)
    assert scene.images == {"floor_1": b"image 1"} and report.calls == 1
    (answer,) = [entry for entry in run.memory.entries if entry.type == "Answer"]
    assert (answer.meta.cost, answer.meta.model, answer.meta.client) == (0.04, "painter-1", "test-images")
    assert run.memory.cost()[2] == pytest.approx(0.04) and "image 1" not in scene.memory
    assert run.status(STAGE) == "done"


def test_an_image_that_the_scene_has_lost_makes_its_stage_out_of_date(run: Run, scene: Any) -> None:
    run.painter = Painter()
    run.run_stage(STAGE)
    scene.images.clear()
    assert run.status(STAGE) == "stale"


def test_without_an_image_model_the_stage_is_told_so(run: Run, scene: Any) -> None:
    run.run_stage(STAGE)
    textures = run.memory.latest(Textures)
    assert textures is not None and not textures.images and run.status(STAGE) == "done" and not scene.images


def test_what_was_painted_is_not_paid_for_again_unless_the_artist_asks_for_another(
    run: Run, scene: Any, tmp_path: Path
) -> None:
    run.painter = painter = Painter()
    run.painted = KeptImages(tmp_path)
    run.run_stage(STAGE)
    run.run_stage(STAGE)
    assert painter.painted == 1 and run.memory.cost()[2] == pytest.approx(0.04)
    session = run.begin(STAGE, fresh=True)
    while not session.finished:
        session.step()
    assert painter.painted == 2 and scene.images["floor_1"] == b"image 2"
    run.run_stage(STAGE)
    assert painter.painted == 2 and scene.images["floor_1"] == b"image 2", "the newest one stays"


def test_a_run_that_is_stopped_while_it_paints_keeps_what_stood(run: Run, scene: Any) -> None:
    run.painter = Painter(run.cancel)
    with pytest.raises(Cancelled):
        run.run_stage(STAGE)
    assert not scene.images and run.memory.latest(Textures) is None and run.status(STAGE) == "not run"


def test_a_scene_that_keeps_no_images_does_not_fail(run: Run) -> None:
    class Plain:
        """Only what every scene has."""

        def __init__(self, inner: Any) -> None:
            self._inner = inner

        def __getattr__(self, name: str) -> Any:
            if name in ("keep_images", "kept_images", "has_images"):
                raise AttributeError(name)
            return getattr(self._inner, name)

    run.backend, run.painter = Plain(run.backend), Painter()
    try:
        run.run_stage(STAGE)
    except RoomError as error:
        pytest.fail(str(error))
    assert run.status(STAGE) == "done"
