# SPDX-License-Identifier: GPL-3.0-or-later
"""Which image model the settings mean, that its key stays secret and with its own service, and what it may cost."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from code_as_room.pipeline.ask_images import paint
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.image_base import ImageRequest, PaintedImage
from code_as_room.pipeline.models.image_registry import (
    ImageSettings,
    image_settings_from_environment,
    make_image_client,
)
from code_as_room.pipeline.spending import Meter
from code_as_room.pipeline.spending_images import metered_painter
from code_as_room.pipeline.stages.texture_wishes import Paint, PaintRequest

KEY = "sk-secret-0123456789abcdef"
VALUES = {"what": "oak", "width": "2", "depth": "2", "colours": "#AA8866", "pattern": "", "style": "calm"}


class Painter:
    """Paints, or fails."""

    name, describes = "test", "A test's image model"

    def __init__(self, error: ModelError | None = None) -> None:
        self.error, self.painted = error, 0

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        if self.error is not None:
            raise self.error
        self.painted += 1
        return PaintedImage(b"image", "test")


def wish(*names: str) -> Paint:
    return Paint(
        tuple(PaintRequest(f"09_surface/{n}", "09_surface", "09_simple", {**VALUES, "what": n}) for n in names)
    )


def environment(**values: str) -> dict[str, str]:
    return {f"CODE_AS_ROOM_IMAGE_{name}": value for name, value in values.items()}


def test_without_settings_nobody_paints() -> None:
    assert make_image_client(image_settings_from_environment({})) is None
    assert make_image_client(image_settings_from_environment(environment(PROVIDER="none", MODEL="x"))) is None


@pytest.mark.parametrize(
    ("values", "name"),
    (
        (environment(PROVIDER="openai", MODEL="painter", API_KEY=KEY), "openai-images:painter"),
        (environment(PROVIDER="gemini", MODEL="painter", API_KEY=KEY), "gemini-images:painter"),
        (environment(BASE_URL="http://localhost:8080/v1", MODEL="painter"), "openai-images:painter"),
    ),
)
def test_the_provider_decides_how_is_asked(values: dict[str, str], name: str) -> None:
    settings = image_settings_from_environment(values)
    client = make_image_client(settings)
    assert client is not None and client.name == name
    assert KEY not in repr(settings) and KEY not in repr(client) and KEY not in client.describes


def test_a_key_of_one_service_does_not_go_to_another() -> None:
    own = {"OPENAI_API_KEY": KEY, **environment(PROVIDER="openai", MODEL="x")}
    assert image_settings_from_environment(own).api_key == KEY
    elsewhere = {**own, **environment(BASE_URL="https://other.example.com/v1")}
    assert image_settings_from_environment(elsewhere).api_key == ""
    assert image_settings_from_environment({**own, **environment(PROVIDER="gemini", MODEL="x")}).api_key == ""


@pytest.mark.parametrize(
    "values", (environment(PROVIDER="nobody"), environment(PROVIDER="openai", PRICE="a lot"), environment(BASE_URL="x"))
)
def test_settings_that_cannot_be_say_so(values: dict[str, str]) -> None:
    with pytest.raises(ModelError) as caught:
        make_image_client(image_settings_from_environment(values))
    assert caught.value.message and caught.value.fix


REMOTE = ImageSettings("openai", "https://images.example.com/v1", "x")


def test_images_count_towards_the_rooms_cap_and_stop_before_it() -> None:
    meter, painter = Meter(cap=0.10), Painter()
    priced = ImageSettings("openai", REMOTE.base_url, "x", price=0.04)
    found = paint(wish("oak", "stone", "wool"), metered_painter(painter, priced, meter), None, threading.Event())
    assert found is not None and painter.painted == 2 and meter.spent == pytest.approx(0.08)
    assert sorted(p.cost or 0.0 for p in found) == [0.0, 0.04, 0.04]
    assert "spending cap" in next(p.problem for p in found if not p.data)


def test_a_cap_that_cannot_be_kept_lets_nothing_be_sent() -> None:
    painter = Painter()
    found = paint(wish("oak"), metered_painter(painter, REMOTE, Meter(cap=1.0)), None, threading.Event())
    assert found is not None and painter.painted == 0 and "price" in found[0].problem
    local = ImageSettings("openai", "http://localhost:8080/v1", "x")
    paint(wish("oak"), metered_painter(painter, local, Meter(cap=1.0)), None, threading.Event())
    assert painter.painted == 1, "what runs on this computer is free"


def test_what_failed_is_not_counted() -> None:
    meter = Meter(cap=1.0)
    priced = ImageSettings("openai", REMOTE.base_url, "x", price=0.04)
    painter = Painter(ServiceError("The account has no credit.", "Add some.", "money"))
    found = paint(wish("oak", "stone"), metered_painter(painter, priced, meter), None, threading.Event())
    assert found is not None and {p.problem for p in found} == {"The account has no credit."} and meter.spent == 0.0


def test_what_happens_to_each_image_is_told() -> None:
    told = []
    paint(wish("oak"), Painter(), None, threading.Event(), told.append)
    assert [(event.key, event.kind) for event in told] == [("09_surface/oak", "asked"), ("09_surface/oak", "answered")]
