# SPDX-License-Identifier: GPL-3.0-or-later
"""A model service on this computer for `kill.py`: slow, with recorded answers, and with a log of what it answered when."""

from __future__ import annotations

import base64
import json
import random
import re
import threading
import time
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from code_as_room.pipeline.prompting import prompt_hash

KEYS = {
    "AnalysisReply": "s01_analysis/01_analysis",
    "SecondLookReply": "s01_analysis/01_second_look",
    "GraphReply": "s02_graph/02_graph",
}
UNUSABLE = ("SecondLookReply", "GraphReply")
"""Questions whose first answer cannot be used, so that they are asked a second time with what was wrong quoted."""
CHAIRS = ("lounge chair", "easy chair", "reading chair", "club chair", "wing chair")
PIECES = 12


@dataclass
class Asked:
    """One request: when it came, and when its answer's last byte was sent (0: never)."""

    hash: str
    kind: str
    came: float
    sent: float = 0.0


@dataclass
class Log:
    """All requests since the service was started or cleared."""

    asked: list[Asked] = field(default_factory=list)
    changed: threading.Condition = field(default_factory=threading.Condition)

    def note(self, asked: Asked) -> None:
        """A request has come."""
        with self.changed:
            self.asked.append(asked)
            self.changed.notify_all()


class Service(ThreadingHTTPServer):
    """Streams the recorded answers of a folder.

    Args:
        replies: the folder. delay: longest time in seconds that an answer takes, from the first byte on.
    """

    daemon_threads = True

    def __init__(self, replies: Path, delay: float, seed: int) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        entries = json.loads((replies / "replies.json").read_text(encoding="utf-8"))["replies"]
        self._replies = {key: entry["reply"] for key, entry in entries.items()}
        self._random, self._lock = random.Random(seed), threading.Lock()
        self.delay, self.log = delay, Log()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def url(self) -> str:
        """The base URL for a client."""
        return f"http://127.0.0.1:{self.server_address[1]}/v1"

    def seconds(self) -> float:
        """How long the next answer takes."""
        with self._lock:
            return self._random.uniform(0.2, 1.0) * self.delay

    def reply(self, kind: str, text: str) -> Any:
        """The answer to a question; the same question gets the same answer."""
        if kind in UNUSABLE and "could not be used" not in text:
            return "I cannot say."
        if kind in KEYS:
            return self._replies[KEYS[kind]]
        if kind != "CritiqueReply":
            return {"placements": []}
        # Each round calls the armchair something else, so that the loop goes on to its last round.
        chair = re.search(r"^armchair_1, ([^,]*),", text, re.MULTILINE)
        now = chair.group(1) if chair else ""
        wanted = CHAIRS[(CHAIRS.index(now) + 1) % len(CHAIRS)] if now in CHAIRS else CHAIRS[0]
        edit = {"op": "recategorise", "id": "armchair_1", "reason": "its wings", "category": wanted}
        return {"score": 50, "remarks": "", "edits": [edit]}


class _Handler(BaseHTTPRequestHandler):
    server: Service

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers.get("Content-Length", "0"))))
        kind = body["response_format"]["json_schema"]["name"]
        parts = body["messages"][0]["content"]
        text = next(part["text"] for part in parts if part["type"] == "text")
        images = [base64.b64decode(p["image_url"]["url"].partition(",")[2]) for p in parts if p["type"] == "image_url"]
        asked = Asked(prompt_hash(text, images, kind), kind, time.time())
        self.server.log.note(asked)
        try:
            self._answer(self.server.reply(kind, text))
        except OSError:
            return  # the client is gone
        with self.server.log.changed:
            asked.sent = time.time()
            self.server.log.changed.notify_all()

    def _answer(self, reply: Any) -> None:
        seconds, said = self.server.seconds(), json.dumps(reply)
        time.sleep(seconds / 2)
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        size = len(said) // PIECES + 1
        for start in range(0, len(said), size):
            self._send(
                {"model": "recorded", "choices": [{"index": 0, "delta": {"content": said[start : start + size]}}]}
            )
            time.sleep(seconds / 2 / PIECES)
        usage = {"prompt_tokens": 1000, "completion_tokens": 500}
        self._send({"choices": [{"index": 0, "delta": {}, "finish_reason": "stop"}], "usage": usage})
        self.wfile.write(b"data: [DONE]\n\n")
        self.wfile.flush()

    def _send(self, event: dict[str, Any]) -> None:
        self.wfile.write(f"data: {json.dumps(event)}\n\n".encode())
        self.wfile.flush()

    def log_message(self, *_: Any) -> None:
        """Nothing is printed."""
