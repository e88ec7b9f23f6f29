# SPDX-License-Identifier: GPL-3.0-or-later
"""Clients of image services against a scripted peer: what is sent, what is taken, what is refused, and what is never repeated."""

from __future__ import annotations

import base64
import io
import struct
import threading
import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.ask_images import filled, paint
from code_as_room.pipeline.errors import Cancelled
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.image_base import ImageRequest, PaintedImage
from code_as_room.pipeline.models.image_gemini import GeminiImageClient
from code_as_room.pipeline.models.image_openai import OpenAIImageClient
from code_as_room.pipeline.models.limits import Limits
from code_as_room.pipeline.models.retry import RetryPolicy
from code_as_room.pipeline.stages.texture_wishes import Paint, PaintRequest
from code_as_room.pipeline.textures.kept import KeptImages
from PIL import Image

KEY = "sk-secret-0123456789abcdef"
QUICK = RetryPolicy(tries=2, first_pause=0.01)
VALUES = {"what": "oak", "width": "2", "depth": "2", "colours": "#AA8866", "pattern": "", "style": "calm"}
Client = Callable[..., Any]


def png(size: tuple[int, int] = (256, 256), kind: str = "PNG") -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", size, "#AA8866").save(buffer, kind)
    return buffer.getvalue()


def coded(data: bytes) -> str:
    return base64.b64encode(data).decode()


def openai(peer: Any, **more: Any) -> OpenAIImageClient:
    return OpenAIImageClient(peer.url, "gpt-image-x", KEY, retries=QUICK, **more)


def gemini(peer: Any, **more: Any) -> GeminiImageClient:
    return GeminiImageClient(peer.url.replace("/v1", "/v1beta"), "gemini-image-x", KEY, retries=QUICK, **more)


def openai_reply(data: bytes) -> dict[str, Any]:
    return {"created": 1, "data": [{"b64_json": coded(data)}], "usage": {"output_tokens": 1056}}


def gemini_reply(data: bytes) -> dict[str, Any]:
    parts = [{"text": "Here it is."}, {"inlineData": {"mimeType": "image/png", "data": coded(data)}}]
    return {"candidates": [{"content": {"parts": parts}, "finishReason": "STOP"}], "modelVersion": "served"}


def asked(client: Any, text: str = "oak planks", **more: Any) -> PaintedImage:
    found = client.paint(ImageRequest(text, **more), threading.Event())
    assert isinstance(found, PaintedImage)
    return found


@pytest.mark.parametrize("kind", ("PNG", "JPEG", "WEBP"))
def test_an_image_arrives_as_it_was_made(make_peer: Any, kind: str) -> None:
    for client_of, reply in ((openai, openai_reply), (gemini, gemini_reply)):
        peer = make_peer()
        peer.script = lambda r, reply=reply: r.reply(200, reply(png(kind=kind)))
        assert asked(client_of(peer)).data == png(kind=kind)


def test_what_is_sent(make_peer: Any) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(200, openai_reply(png()))
    asked(openai(peer), proportions="wide")
    peer.script = lambda r: r.reply(200, gemini_reply(png()))
    asked(gemini(peer), proportions="tall")
    first, second = peer.received
    assert first.line.startswith("POST /v1/images/generations ")
    assert first.headers["authorization"] == f"Bearer {KEY}"
    assert first.body == {"model": "gpt-image-x", "prompt": "oak planks", "n": 1, "size": "1536x1024"}
    assert second.line.startswith("POST /v1beta/models/gemini-image-x:generateContent ")
    assert second.headers["x-goog-api-key"] == KEY and "authorization" not in second.headers
    assert second.body["generationConfig"]["responseModalities"] == ["IMAGE"]
    assert second.body["contents"][0]["parts"] == [{"text": "oak planks"}]


def test_a_link_of_the_own_server_is_followed_without_the_key(make_peer: Any) -> None:
    peer = make_peer()
    link = f"http://127.0.0.1:{peer.port}/files/1.png"

    def script(received: Any) -> None:
        if received.line.startswith("GET"):
            received.reply(200, png(), {"Content-Type": "image/png"})
        else:
            received.reply(200, {"data": [{"url": link}]})

    peer.script = script
    assert asked(openai(peer)).data == png()
    assert "authorization" not in peer.received[1].headers


@pytest.mark.parametrize("link", ("file:///etc/passwd", "http://169.254.169.254/latest", "ftp://x/y", "//", "https://"))
def test_other_links_are_not_followed(make_peer: Any, link: str) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(200, {"data": [{"url": link}]})
    with pytest.raises(ServiceError) as caught:
        asked(openai(peer))
    assert caught.value.kind == "shape" and len(peer.received) == 1


def bomb() -> bytes:
    """A PNG of a few kilobytes that says it is 30000 x 30000."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", 30_000, 30_000, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(b"\0" * 10_000))
        + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize(
    "data",
    (b"no image at all", png()[:200], bomb(), png((8, 8)), b"<svg xmlns='http://www.w3.org/2000/svg'/>", b"%PDF-1.7"),
)
def test_bytes_that_are_no_image_are_refused(make_peer: Any, data: bytes) -> None:
    for client_of, reply in ((openai, openai_reply), (gemini, gemini_reply)):
        peer = make_peer()
        peer.script = lambda r, reply=reply: r.reply(200, reply(data))
        with pytest.raises(ServiceError) as caught:
            asked(client_of(peer))
        assert caught.value.kind == "shape" and len(peer.received) == 1


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (b"<html><title>Welcome</title></html>", "text/html"),
        (b"", "application/json"),
        (b"[1, 2]", "application/json"),
        (b'{"data": []}', "application/json"),
        (b'{"data": [{"b64_json": 5}]}', "application/json"),
        (
            b'{"candidates": [{"content": {"parts": [{"text": "I cannot draw."}]}, "finishReason": "STOP"}]}',
            "application/json",
        ),
        (b'{"candidates": 7}', "application/json"),
        (b"\x89PNG\r\n\x1a\n raw bytes", "image/png"),
        (b"[" * 20_000, "application/json"),
    ],
)
def test_replies_without_an_image(make_peer: Any, body: bytes, kind: str) -> None:
    for client_of in (openai, gemini):
        peer = make_peer()
        peer.script = lambda r: r.reply(200, body, {"Content-Type": kind})
        with pytest.raises(ServiceError) as caught:
            asked(client_of(peer))
        assert caught.value.kind == "shape" and "image" in caught.value.message


def test_a_huge_reply_is_cut_off(make_peer: Any) -> None:
    peer = make_peer()
    sent = []

    def script(received: Any) -> None:
        received.send(b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nConnection: close\r\n\r\n")
        for _ in range(400):
            received.send(b"x" * 100_000)
            sent.append(1)

    peer.script = script
    with pytest.raises(ServiceError) as caught:
        asked(openai(peer, limits=Limits(total=20, size=1_000_000)))
    assert caught.value.kind == "size" and len(sent) < 300


@pytest.mark.parametrize(
    ("status", "body", "kind", "calls"),
    [
        (402, {"error": {"message": "Payment required"}}, "money", 1),
        (429, {"error": {"message": "You exceeded your current quota", "code": "insufficient_quota"}}, "money", 1),
        (
            400,
            {"error": {"message": "Billing hard limit has been reached", "code": "billing_hard_limit_reached"}},
            "money",
            1,
        ),
        (401, {"error": {"message": f"Incorrect API key provided: {KEY}"}}, "key", 1),
        (400, {"error": {"message": "Blocked by our moderation system", "code": "moderation_blocked"}}, "refusal", 1),
        (400, {"error": {"message": "no", "code": "content_policy_violation"}}, "refusal", 1),
        (404, {"error": {"message": "no such model"}}, "model", 1),
        (503, {"error": {"message": "overloaded"}}, "server", 2),
        # Some services answer 200, and tell the error in the body.
        (200, {"error": {"message": "Insufficient credits", "code": 402}}, "money", 1),
        (200, {"error": {"message": "You exceeded your current quota", "type": "insufficient_quota"}}, "money", 1),
        (200, {"error": {"message": f"Incorrect API key {KEY}", "code": "invalid_api_key"}}, "key", 1),
        (200, {"error": {"message": "Blocked by our moderation system"}}, "refusal", 1),
        (200, {"error": {"message": "slow down", "code": 429}}, "rate", 2),
        (200, {"error": "Insufficient credits, says the account"}, "money", 1),
    ],
)
def test_statuses(make_peer: Any, status: int, body: dict[str, Any], kind: str, calls: int) -> None:
    for client_of in (openai, gemini):
        peer = make_peer()
        peer.script = lambda r: r.reply(status, body)
        with pytest.raises(ServiceError) as caught:
            asked(client_of(peer))
        assert caught.value.kind == kind and len(peer.received) == calls
        assert "secret" not in f"{caught.value.message} {caught.value.fix}"
        said = body["error"] if isinstance(body["error"], str) else body["error"]["message"]
        assert said.replace(KEY, "[key]") in caught.value.message, "the service's own sentence is told"


@pytest.mark.parametrize(
    "reply",
    (
        {"promptFeedback": {"blockReason": "SAFETY"}},
        {"candidates": [{"finishReason": "IMAGE_SAFETY"}]},
        {"candidates": [{"content": {"parts": [{"text": "I must not."}]}, "finishReason": "PROHIBITED_CONTENT"}]},
    ),
)
def test_geminis_refusals(make_peer: Any, reply: dict[str, Any]) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(200, reply)
    with pytest.raises(ServiceError) as caught:
        asked(gemini(peer))
    assert caught.value.kind == "refusal"


def test_stopping_ends_the_wait(make_peer: Any) -> None:
    peer = make_peer()
    stop = threading.Event()
    done = threading.Event()

    def script(received: Any) -> None:
        stop.set()
        done.wait(30)

    peer.script = script
    started = time.monotonic()
    with pytest.raises(Cancelled):
        openai(peer).paint(ImageRequest("oak"), stop)
    done.set()
    assert time.monotonic() - started < 20


def wish(*names: str) -> Paint:
    return Paint(
        tuple(PaintRequest(f"09_surface/{n}", "09_surface", "09_simple", {**VALUES, "what": n}) for n in names)
    )


def test_after_a_refusal_simpler_words_are_tried(make_peer: Any) -> None:
    peer = make_peer()

    def script(received: Any) -> None:
        if received.number == 0:
            received.reply(400, {"error": {"message": "safety system", "code": "moderation_blocked"}})
        else:
            received.reply(200, openai_reply(png()))

    peer.script = script
    found = paint(wish("oak"), openai(peer), None, threading.Event())
    assert found is not None and found[0].data == png() and not found[0].problem
    first, second = (r.body["prompt"] for r in peer.received)
    assert len(second) < len(first) and "oak" in second and "#AA8866" in second


def test_refused_twice_gives_a_sentence_and_no_image(make_peer: Any) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(400, {"error": {"message": "unsafe", "code": "content_policy_violation"}})
    found = paint(wish("oak"), openai(peer), None, threading.Event())
    assert found is not None and not found[0].data and "refused" in found[0].problem and len(peer.received) == 2


def test_without_money_nothing_more_is_asked(make_peer: Any) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(402, {"error": {"message": "no credit"}})
    names = [f"surface {n}" for n in range(9)]
    found = paint(wish(*names), openai(peer), None, threading.Event())
    assert found is not None and all("credit" in p.problem for p in found)
    # Only those that were under way side by side when the first answer came.
    assert len(peer.received) <= 3


def test_what_was_paid_for_is_not_asked_for_again(make_peer: Any, tmp_path: Path) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(200, openai_reply(png()))
    kept = KeptImages(tmp_path / "images")
    for _ in range(2):
        found = paint(wish("oak"), openai(peer), kept, threading.Event())
        assert found is not None and found[0].data == png()
    assert len(peer.received) == 1
    paint(wish("stone"), openai(peer), kept, threading.Event())
    assert len(peer.received) == 2


def test_a_disk_that_cannot_be_written_costs_nothing(make_peer: Any, tmp_path: Path) -> None:
    peer = make_peer()
    peer.script = lambda r: r.reply(200, openai_reply(png()))
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    found = paint(wish("oak"), openai(peer), KeptImages(blocked), threading.Event())
    assert found is not None and found[0].data == png()


def test_stopping_all_painting(make_peer: Any) -> None:
    peer = make_peer()
    stop, done = threading.Event(), threading.Event()

    def script(received: Any) -> None:
        stop.set()
        done.wait(30)

    peer.script = script
    with pytest.raises(Cancelled):
        paint(wish("a", "b", "c", "d", "e"), openai(peer), None, stop)
    done.set()


def test_no_client_no_painting() -> None:
    assert paint(wish("oak"), None, None, threading.Event()) is None


@pytest.mark.parametrize("template", ("09_surface", "09_decor", "09_simple"))
def test_templates_take_the_values_of_the_stage(template: str) -> None:
    text = filled(template, VALUES)
    assert "{{" not in text and "oak" in text and len(text) < 1500
