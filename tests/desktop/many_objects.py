# SPDX-License-Identifier: GPL-3.0-or-later
"""A room with many objects that was never photographed: its picture, the answers about it, and a small model service
on this computer that gives them. For measuring only; everything is made from plain arithmetic."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw

WIDTH, DEPTH, HEIGHT = 8.0, 6.0, 2.6
EYE = 9.0
"""Metres above the floor that the picture was taken from, straight down."""
SPREAD = 0.99
PIXELS = (1200, 900)
MAJOR = (
    ("bed", 1.8, 2.1, 0.6), ("wardrobe", 1.6, 0.6, 2.1), ("desk", 1.4, 0.7, 0.75), ("sofa", 1.9, 0.9, 0.8),
    ("table", 1.2, 0.8, 0.74), ("chair", 0.5, 0.5, 0.9), ("armchair", 0.8, 0.8, 0.9), ("dresser", 1.0, 0.5, 0.9),
    ("bookshelf", 0.9, 0.35, 1.8), ("nightstand", 0.45, 0.4, 0.5),
)  # fmt: skip
MINOR = (("lamp", 0.25, 0.25, 0.4), ("book", 0.22, 0.16, 0.05), ("vase", 0.15, 0.15, 0.3), ("plant", 0.3, 0.3, 0.5))


def seen(x: float, y: float, z: float) -> tuple[float, float]:
    """Where the picture shows a point, 0-1000 of its width and height."""
    scale = SPREAD / (EYE - z)
    return 500 + 1000 * x * scale, 500 - 1000 * y * scale * PIXELS[0] / PIXELS[1]


def objects(count: int) -> list[dict[str, Any]]:
    """The objects as the first answer tells them: three in five stand on the floor, the others on one of those."""
    columns, found = 8, []
    majors = max(1, count * 3 // 5)
    rows = -(-majors // columns)
    for i in range(count):
        if i < majors:
            category, *size = MAJOR[i % len(MAJOR)]
            shrink = min(1.0, 0.9 * WIDTH / columns / size[0], 0.85 * DEPTH / rows / size[1])
            size = [round(size[0] * shrink, 3), round(size[1] * shrink, 3), size[2]]
            centre = [WIDTH * ((i % columns + 0.5) / columns - 0.5), DEPTH * ((i // columns + 0.5) / rows - 0.5)]
            found.append(told(f"{category}_{i + 1}", category, centre, 0.0, size, None, i))
        else:
            category, *size = MINOR[i % len(MINOR)]
            parent = found[(i - majors) % majors]
            centre = [parent["centre_m"]["x_m"], parent["centre_m"]["y_m"]]
            found.append(
                told(f"{category}_{i + 1}", category, centre, parent["size_m"]["height"], size, parent["id"], i)
            )
    return found


def told(
    name: str, category: str, centre: list[float], base: float, size: list[float], parent: str | None, i: int
) -> dict[str, Any]:
    """One object of the first answer; the boxes of some are a little off, so that the critic has something to say."""
    return {
        "id": name, "category": category, "placement": "surface" if parent else "floor", "parent": parent,
        "salience": "minor" if parent else "major", "box": box(centre, base, size, 9.0 if i % 3 == 0 else 0.0),
        "centre_m": {"x_m": centre[0], "y_m": centre[1]}, "base_m": base, "yaw_deg": 0.0, "facing": "down",
        "size_m": dict(zip(("width", "depth", "height"), size, strict=True)), "confidence": 0.9,
    }  # fmt: skip


def box(centre: list[float], base: float, size: list[float], off: float = 0.0) -> dict[str, float]:
    """What the picture shows of a box."""
    corners = [
        seen(centre[0] + dx * size[0] / 2, centre[1] + dy * size[1] / 2, z)
        for dx in (-1, 1)
        for dy in (-1, 1)
        for z in (base, base + size[2])
    ]
    xs, ys = zip(*corners, strict=True)
    return {"x_min": min(xs) + off, "y_min": min(ys) + off, "x_max": max(xs) + off, "y_max": max(ys) + off}


def floor(z: float = 0.0) -> list[dict[str, float]]:
    """The room's corners in the picture."""
    ends = [(-WIDTH / 2, DEPTH / 2), (WIDTH / 2, DEPTH / 2), (WIDTH / 2, -DEPTH / 2), (-WIDTH / 2, -DEPTH / 2)]
    return [dict(zip(("x", "y"), seen(x, y, z), strict=True)) for x, y in ends]


def replies(count: int) -> dict[str, list[dict[str, Any]]]:
    """Answers by the name of the schema that they fit, in the order in which they are given; the last one again."""
    items = objects(count)
    ends = {"start": {"x_m": 1.0, "y_m": -DEPTH / 2}, "end": {"x_m": 1.9, "y_m": -DEPTH / 2}}
    door = {"id": "door_1", "kind": "door", **ends, "height_m": 2.05, "wall": "bottom"}
    first = {
        "view": "perspective", "room_type": "hall", "room_width_m": WIDTH, "room_depth_m": DEPTH,
        "wall_height_m": HEIGHT, "floor_polygon": floor(), "architecture": [door], "objects": items,
    }  # fmt: skip
    relations = [{"source": o["id"], "relation": "on", "target": o["parent"]} for o in items if o["parent"]]
    off = [o for n, o in enumerate(items) if n % 3 == 0 and not o["parent"]]
    edits = [{"op": "move", "id": o["id"], "reason": "its box was off", "box": _true_box(o)} for o in off]
    half = len(edits) // 2
    return {
        "AnalysisReply": [first],
        "SecondLookReply": [{"missed": [], "corrections": []}],
        "GraphReply": [{"attributes": [], "relations": relations}],
        "CritiqueReply": [
            {"score": 60, "edits": edits[:half]}, {"score": 75, "edits": edits[half:]}, {"score": 90, "edits": []},
        ],
        "AuxiliaryReply": [{"placements": []}],
    }  # fmt: skip


def _true_box(item: dict[str, Any]) -> dict[str, float]:
    centre = [item["centre_m"]["x_m"], item["centre_m"]["y_m"]]
    return box(centre, item["base_m"], list(item["size_m"].values()))


def draw(path: Path, count: int) -> None:
    """A plain picture of the room."""
    image = Image.new("RGB", PIXELS, "white")
    pen = ImageDraw.Draw(image)

    def pixels(x: float, y: float) -> tuple[float, float]:
        return x * PIXELS[0] / 1000, y * PIXELS[1] / 1000

    pen.polygon([pixels(p["x"], p["y"]) for p in floor()], fill="#d8c9ae", outline="black")
    for n, item in enumerate(objects(count)):
        b = item["box"]
        shade = f"#{90 + 3 * n % 120:02x}{70 + 5 * n % 120:02x}{60 + 7 * n % 120:02x}"
        ends = [*pixels(b["x_min"], b["y_min"]), *pixels(b["x_max"], b["y_max"])]
        pen.rectangle(ends, fill=shade, outline="black")
    image.save(path)


class Service(ThreadingHTTPServer):
    """A model service on this computer that streams the prepared answers.

    Attributes:
        delay: seconds between a question and the first word of its answer.
        silent: while it is set, nothing is sent at all.
        asked: what was asked so far, by schema name.
    """

    daemon_threads = True

    def __init__(self, answers: dict[str, list[dict[str, Any]]], delay: float) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.answers, self.delay = answers, delay
        self.silent = threading.Event()
        self.asked: list[str] = []
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def handle_error(self, *_: Any) -> None:
        """A client that was stopped hangs up: nothing to tell."""

    @property
    def url(self) -> str:
        """The base URL for a client."""
        return f"http://127.0.0.1:{self.server_address[1]}/v1"

    def words(self, schema: str) -> Iterator[str]:
        """The next answer of this kind, in pieces as a model would write it."""
        known = self.answers.get(schema, [{}])
        text = json.dumps(known[min(self.asked.count(schema), len(known) - 1)])
        self.asked.append(schema)
        yield from (text[i : i + 60] for i in range(0, len(text), 60))


class _Handler(BaseHTTPRequestHandler):
    server: Service

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers.get("Content-Length", "0"))))
        if "silent" in body.get("model", ""):
            time.sleep(90)
            return
        time.sleep(self.server.delay)
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        for word in self.server.words(body["response_format"]["json_schema"]["name"]):
            self._send({"model": "prepared", "choices": [{"index": 0, "delta": {"content": word}}]})
            time.sleep(0.004)
        usage = {"prompt_tokens": 1000, "completion_tokens": 500}
        self._send({"choices": [{"index": 0, "delta": {}, "finish_reason": "stop"}], "usage": usage})
        self.wfile.write(b"data: [DONE]\n\n")

    def _send(self, event: dict[str, Any]) -> None:
        self.wfile.write(f"data: {json.dumps(event)}\n\n".encode())
        self.wfile.flush()

    def log_message(self, *_: Any) -> None:
        """Nothing is printed."""
