# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures are sent as large as the vendor's model sees them, and never larger than a request may be."""

from __future__ import annotations

import io
import threading

import numpy as np
import pytest
from code_as_room.pipeline.models.anthropic import AnthropicClient
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.sight import Sight, fitted, sight_of_claude, sight_of_openai, sizes_seen
from PIL import Image


def picture(width, height, form="PNG", noisy=False):
    pixels = np.random.default_rng(1).integers(0, 255, (height, width, 3), dtype=np.uint8)
    image = Image.fromarray(pixels) if noisy else Image.new("RGB", (width, height), "red")
    data = io.BytesIO()
    image.save(data, form)
    return data.getvalue()


def opened(data):
    return Image.open(io.BytesIO(data))


@pytest.mark.parametrize(
    ("model", "fits"),
    [
        ("claude-3-5-sonnet-20241022", False),
        ("claude-opus-4-20250514", False),
        ("claude-sonnet-4-5", False),
        ("claude-haiku-4-5-20251001", False),
        ("claude-opus-4-7", True),
        ("claude-opus-5", True),
        ("claude-fable-5-1", True),
        ("my-own-proxy", True),
    ],
)
def test_what_claude_sees(model, fits):
    scale = sight_of_claude(model).scale(1568, 1176)
    assert (scale == 1.0) is fits
    if not fits:
        assert 1568 * 1176 * scale**2 == pytest.approx(1_150_000)


@pytest.mark.parametrize(
    ("model", "short"),
    [("gpt-4o", 768), ("gpt-4o-2024-11-20", 768), ("gpt-5", 768), ("gpt-5-mini", 1176), ("gpt-5.4", 1176), ("x", 1176)],
)
def test_what_openais_models_see(model, short):
    assert round(1176 * sight_of_openai(model).scale(1568, 1176)) == short


def test_pictures_keep_their_format_and_proportions_and_what_fits_stays_the_same_bytes():
    jpeg, small = picture(1568, 1176, "JPEG"), picture(600, 400)
    one, two, three = fitted((jpeg, small, b"\x89PNG fake"), Sight(pixels=1_150_000))
    assert opened(one).format == "JPEG" and opened(one).size == (1238, 929)
    assert two == small and three == b"\x89PNG fake"
    assert opened(fitted((picture(3000, 200),), Sight())[0]).size == (1568, 105)


def test_a_request_never_gets_larger_than_it_may_be():
    noisy = picture(900, 900, noisy=True)
    assert len(noisy) > 2_000_000
    (alone,) = fitted((noisy,), Sight(picture_bytes=1_500_000))
    assert opened(alone).format == "JPEG" and len(alone) <= 1_500_000
    many = fitted((noisy,) * 6, Sight(request_bytes=3_000_000))
    assert sum(map(len, many)) <= 3_000_000 and min(opened(p).width for p in many) > 300


def test_the_service_is_sent_the_picture_as_its_model_sees_it(peer):
    content = [{"type": "text", "text": "{}"}]
    peer.script = lambda received: received.reply(
        200, {"type": "message", "model": "c", "content": content, "stop_reason": "end_turn", "usage": {}}
    )
    prompt = Prompt("s01", "k", "Look.", (picture(1568, 1176),), "A", {"type": "object", "properties": {}}, "h")
    AnthropicClient(peer.url, "claude-sonnet-4-5").answer(prompt, threading.Event())
    import base64

    block = peer.received[0].body["messages"][0]["content"][0]
    assert opened(base64.b64decode(block["source"]["data"])).size == (1238, 929)
    assert sizes_seen(prompt.images, "anthropic/claude-sonnet-4-5") == [(1238, 929), (1568, 1176)]
    assert sizes_seen(prompt.images, "qwen3-vl") == [(1568, 1176)]
