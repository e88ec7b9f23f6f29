# SPDX-License-Identifier: GPL-3.0-or-later
"""The command with an image model on loopback: what is painted lies beside room.py, is paid for once, and comes back."""

from __future__ import annotations

import base64
import io
import json
import shutil
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest
from code_as_room.operators import command
from code_as_room.pipeline.artifacts.textures import Textures
from PIL import Image

KEY = "sk-CANARY-image-4f8a1c77e2"


class Service(BaseHTTPRequestHandler):
    """Paints a grain for everything."""

    asked: list[dict[str, str]] = []

    def log_message(self, *args: Any) -> None:
        """Quiet."""

    def do_POST(self) -> None:
        """One image."""
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.asked.append({"prompt": body["prompt"], "key": self.headers.get("Authorization", "")})
        buffer = io.BytesIO()
        Image.effect_noise((256, 256), 40).convert("RGB").save(buffer, "PNG")
        data = json.dumps({"data": [{"b64_json": base64.b64encode(buffer.getvalue()).decode()}]}).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)


@pytest.fixture
def service() -> Iterator[str]:
    Service.asked = []
    server = ThreadingHTTPServer(("127.0.0.1", 0), Service)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/v1"
    server.shutdown()
    server.server_close()


def test_painted_images_lie_beside_the_program_and_are_painted_once(
    room: Any, service: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PAINTERS_KEY", KEY)
    options = ("--image-base-url", service, "--image-model", "painter", "--image-key-env", "PAINTERS_KEY")
    result = room.make(*options).finished()
    textures = result.memory.latest(Textures)
    assert textures is not None
    painted = [t for t in textures.surfaces if t.source == "model"]
    assert painted and len(Service.asked) == len(painted) and "painter" in result.out
    assert {asked["key"] for asked in Service.asked} == {f"Bearer {KEY}"}
    for texture in painted:
        with Image.open(room.out / "textures" / f"{texture.name}.png") as image:
            assert image.size == texture.pixels
        assert f'picture("{texture.name}"' in (room.out / "room.py").read_text(encoding="utf-8")
        assert f"textures/{texture.name}.png" in result.out
    assert not (room.out / command.PAINTED).exists()
    for path in room.out.rglob("*"):
        assert path.is_dir() or KEY.encode() not in path.read_bytes(), path.name

    again = room.make(*options, "--resume").finished()
    assert len(Service.asked) == len(painted), "nothing is painted again while its image is there"
    shutil.rmtree(room.out / "textures")
    again = room.make(*options, "--resume").finished()
    found = again.memory.latest(Textures)
    assert found is not None and len(Service.asked) == 2 * len(painted)
    assert {p.stem for p in (room.out / "textures").iterdir()} == {t.name for t in found.images}
