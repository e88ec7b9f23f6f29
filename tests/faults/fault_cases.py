# SPDX-License-Identifier: GPL-3.0-or-later
"""Faulty exchanges as data: what the peer does, and what may come of it. This file: statuses, errors, redirects, times, sizes.

`CASES` of `fault_bodies.py` has what is wrong with replies themselves.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from email.utils import formatdate
from functools import partial
from typing import Any

from code_as_room.pipeline.models.limits import Limits
from fault_envelopes import KEY, Ollama, Vendor, png
from fault_server import Received

TEXT = '{"a": 1}'
PICTURE = png()
RESULT, ERROR = frozenset({"result"}), frozenset({"error"})
EITHER = RESULT | ERROR
USUAL = Limits(connect=5.0, read=20.0, total=40.0, size=1_000_000)
IMPATIENT = Limits(connect=5.0, read=0.15, total=40.0, size=1_000_000)
HURRIED = Limits(connect=5.0, read=20.0, total=0.3, size=1_000_000)
RETRIED = (408, 429, 500, 502, 503, 504, 529)
KINDS = {400: "request", 401: "key", 402: "money", 403: "key", 404: "model", 413: "size", 429: "rate"}
MORE_STATUSES = (
    *(201, 202, 204, 205, 206, 226, 300, 304, 305, 306, 405, 406, 407, 409, 410, 411, 412, 414, 415, 416, 417, 418, 421, 422),
    *(423, 424, 425, 426, 428, 431, 451, 498, 499, 501, 505, 506, 507, 508, 510, 511, 520, 522, 524, 525, 530, 598, 599, 999),
)  # fmt: skip
Act = Callable[[Received], None]


@dataclass(frozen=True)
class Case:
    """One faulty exchange.

    Attributes:
        script: what the peer does; may: the outcomes that are right.
        kinds: of the error, empty for any; requests: how many the peer must have got, 0 for any.
        expected: the result; None for any of the right type (what was changed may be a part of the answer).
        says: words that the error must show.
    """

    family: str
    name: str
    script: Act
    may: frozenset[str] = ERROR
    kinds: frozenset[str] = frozenset()
    requests: int = 0
    expected: Any = field(default=())
    says: str = ""
    limits: Limits = USUAL


def good(vendor: type[Vendor]) -> Any:
    """What a client is to give for a good reply."""
    return TEXT if vendor.chat else PICTURE


def whole_body(vendor: type[Vendor]) -> bytes:
    """A good reply's body in one piece."""
    return json.dumps(vendor.whole(good(vendor))).encode()


def http(body: bytes, kind: str = "application/json", *more: str, length: bool = True) -> bytes:
    """A good status, headers and a body."""
    lines = ["HTTP/1.1 200 OK", f"Content-Type: {kind}", *more, "Connection: close"]
    lines += [f"Content-Length: {len(body)}"] if length else []
    return "\r\n".join([*lines, "", ""]).encode() + body


def chunked(body: bytes, kind: str = "application/json", *more: str, size: int = 40) -> bytes:
    """The same in chunks."""
    pieces = [body[at : at + size] for at in range(0, len(body), size)]
    coded = b"".join(b"%x\r\n%s\r\n" % (len(piece), piece) for piece in pieces)
    return http(b"", kind, "Transfer-Encoding: chunked", *more, length=False) + coded + b"0\r\n\r\n"


def sends(raw: bytes) -> Act:
    """The peer writes these bytes and closes."""
    return lambda received: received.send(raw)


def replies(status: int, payload: Any, headers: Mapping[str, str] | None = None) -> Act:
    """The peer answers with this status."""
    return lambda received: received.reply(status, payload, dict(headers or {}))


def statuses(vendor: type[Vendor]) -> Iterator[Case]:
    """Every status with several bodies; what may pass is tried again, money and refusals are not."""
    said = "The bench is being painted"
    bodies: dict[str, Any] = {
        "error": vendor.error("api_error" if vendor is not Ollama else "", said),
        "page": b"<html><head><title>The bench is being painted</title></head><body>nginx</body></html>",
        "nothing": b"",
        "reply": vendor.whole(good(vendor)),
        "rubbish": b"\x00\xff\xfe" * 300,
        "key": {"error": {"message": f"{said} {KEY} Bearer {KEY}", "request": {"headers": {"authorization": KEY}}}},
        "deep": b"[" * 30_000,
    }
    for status in sorted({*KINDS, *RETRIED, *MORE_STATUSES}):
        table = status not in MORE_STATUSES
        for name in bodies if table else ("error", "nothing"):
            shown = said if table and name in ("error", "page", "key") else ""
            kind = KINDS.get(status, "server") if table else ""
            yield Case(
                "status",
                f"{status} {name}",
                replies(status, bodies[name], {"Content-Type": "text/html"} if name == "page" else {}),
                kinds=frozenset({kind} - {""}),
                requests=2 if status in RETRIED else 1,
                says=shown,
            )


def waits(vendor: type[Vendor]) -> Iterator[Case]:
    """Retry-After in every form: respected where it is short, told where it is long, ignored where it is nonsense."""
    error = vendor.error("rate_limit_error" if vendor is not Ollama else "", "slow down")
    for value, sent in [
        *((v, 2) for v in ("0", "-5", "0.01", "nan", "soon", "", "1,2", "0x10", "\u0661".encode().decode("latin-1"))),
        *((formatdate(0, usegmt=True), 2), ("Wed, 99 Nov 2026", 2)),
        *((v, 1) for v in ("3600", "1e300", "inf", "99999999999999999999", formatdate(32_503_680_000, usegmt=True))),
    ]:
        for status in (429, 503):
            script = partial(_raw_header, status=status, name="Retry-After", value=value, payload=error)
            yield Case("wait", f"{status} {value!r}", script, requests=sent)


def _raw_header(received: Received, status: int, name: str, value: str, payload: Any) -> None:
    data = json.dumps(payload).encode()
    head = f"HTTP/1.1 {status} X\r\n{name}: {value}\r\nContent-Length: {len(data)}\r\nConnection: close\r\n\r\n"
    received.send(head.encode("latin-1") + data)


def money(vendor: type[Vendor]) -> Iterator[Case]:
    """What is about money is never sent again, whatever the status."""
    sentences = (
        "You exceeded your current quota, please check your plan and billing details.",
        "Your credit balance is too low",
        "Insufficient balance",
        "insufficient_quota",
        "Not enough credits",
        "You have reached your spend limit",
        "Billing hard limit has been reached",
    )
    for status in (400, 402, 403, 429):
        for said in sentences:
            yield Case(
                "money",
                f"{status} {said[:20]}",
                replies(status, vendor.error("", said)),
                kinds=frozenset({"money"}),
                requests=1,
            )


def errors_inside(vendor: type[Vendor]) -> Iterator[Case]:
    """A good status with an error in the body: whole, as a stream's first part, and in its middle."""
    errors: list[tuple[Any, frozenset[str]]] = [
        ({"message": f"it fell over {KEY}", "code": "server_error"}, frozenset({"server"})),
        ({"message": "no credit", "code": 402}, frozenset({"money"})),
        ({"message": "slow down", "code": 429}, frozenset({"rate"})),
        ({"message": "wrong key", "code": 401, "type": "authentication_error"}, frozenset({"key"})),
        ({"message": None}, frozenset()),
        ({"type": "overloaded_error"}, frozenset({"server"})),
        ("it fell over", frozenset()),
        (["it fell over"], frozenset()),
        (7, frozenset()),
        ({"message": {"a": ["b"]}, "code": {"x": 1}}, frozenset()),
        ({"message": "x" * 100_000}, frozenset()),
    ]
    for number, (error, kinds) in enumerate(errors):
        body = {"error": error, **({"type": "error"} if vendor.name == "anthropic" else {})}
        yield Case("error inside", f"whole {number}", replies(200, body), kinds=kinds)
        if not vendor.chat:
            continue
        line = json.dumps(body).encode()
        part = line + b"\n" if vendor is Ollama else b"event: error\ndata: " + line + b"\n\n"
        begun = vendor.stream([TEXT])
        middle = begun[: begun.index(b"\n" if vendor is Ollama else b"\n\n") + 2]
        middle = middle[:-1] if vendor is Ollama else middle
        for name, raw in (("first", part), ("middle", middle + part), ("unfinished", middle + part.rstrip())):
            yield Case("error inside", f"{name} {number}", sends(http(raw, vendor.kind, length=False)), kinds=kinds)


def redirects(vendor: type[Vendor], stranger: str) -> Iterator[Case]:
    """Followed on the same host only, and not for ever. `stranger` is another server's address."""
    body = vendor.whole(good(vendor))
    elsewhere = {
        "other port": stranger,
        "other name": stranger.replace("127.0.0.1", "localhost"),
        "https": "https://example.invalid/v1",
        "ftp": "ftp://127.0.0.1/x",
        "file": "file:///etc/passwd",
        "double slash": "//example.invalid/v1",
        "user": f"http://user:pw@{stranger.removeprefix('http://')}",
        "brackets": "http://[::1",
        "port": "http://127.0.0.1:99999/",
        "script": "javascript:alert(1)",
        "control": "http://127.0.0.1\x01.example.invalid/",
    }
    for status in (301, 302, 303, 307, 308):
        for name, target in elsewhere.items():
            script = partial(_raw_header, status=status, name="Location", value=target, payload={})
            yield Case("redirect", f"{status} {name}", script, kinds=frozenset({"redirect"}), requests=1)
        yield Case("redirect", f"{status} nowhere", replies(status, {}), kinds=frozenset({"redirect"}))
        yield Case("redirect", f"{status} loop", _round, kinds=frozenset({"redirect"}))
        for hops, may in ((1, RESULT), (3, RESULT), (4, ERROR)):
            script = partial(_hops, status=status, hops=hops, body=body)
            yield Case("redirect", f"{status} {hops} hops", script, may=may)


def _round(received: Received) -> None:
    received.reply(302, {}, {"Location": received.line.split()[1]})


def _hops(received: Received, status: int, hops: int, body: Any) -> None:
    if received.number < hops:
        received.reply(status, {}, {"Location": received.line.split()[1]})
    else:
        received.reply(200, body)


def times(vendor: type[Vendor]) -> Iterator[Case]:
    """Silence ends at its limit, dripping at the total one; nothing of it is sent again. A slow good reply is taken."""
    raw = http(whole_body(vendor))
    head = raw.index(b"\r\n\r\n") + 4
    silent = frozenset({"timeout"})
    moved = b"HTTP/1.1 302 X\r\nLocation: /x\r\nContent-Length: 9\r\n\r\n"
    yield Case("time", "silent redirect", partial(_then_silent, raw=moved), kinds=silent, limits=IMPATIENT)
    for name, end in (
        ("before the head", 0),
        ("in the head", head // 2),
        ("after the head", head),
        ("in the body", head + 30),
    ):
        script = partial(_then_silent, raw=raw[:end])
        yield Case("time", f"silent {name}", script, kinds=silent, requests=1, limits=IMPATIENT)
    for name, begin in (("head", b"HTTP/1.1 200 OK\r\nX: "), ("body", http(b"", length=False) + b" ")):
        yield Case(
            "time",
            f"dripping {name}",
            partial(_for_ever, begin=begin, piece=b" "),
            kinds=silent,
            requests=1,
            limits=HURRIED,
        )
    yield Case("time", "byte by byte", lambda received: received.drip(raw), may=RESULT)
    yield Case("time", "late", partial(_late, raw=raw), may=RESULT)
    if not vendor.chat:
        return
    streamed = http(vendor.stream([TEXT[:3], TEXT[3:]]), vendor.kind, length=False)
    middle = streamed.index(b"\r\n\r\n") + 60
    yield Case("time", "stream byte by byte", lambda received: received.drip(streamed), may=RESULT)
    yield Case(
        "time",
        "stream silent",
        partial(_then_silent, raw=streamed[:middle]),
        kinds=silent,
        requests=1,
        limits=IMPATIENT,
    )
    ping = b"\n" if vendor is Ollama else b": ping\n\n"
    yield Case(
        "time",
        "stream of pings",
        partial(_for_ever, begin=http(b"", vendor.kind, length=False), piece=ping),
        kinds=silent,
        requests=1,
        limits=HURRIED,
    )


def _then_silent(received: Received, raw: bytes) -> None:
    received.send(raw)
    received.gone()


def _for_ever(received: Received, begin: bytes, piece: bytes) -> None:
    received.send(begin)
    while not received.gone(0.02):
        received.send(piece)


def _late(received: Received, raw: bytes) -> None:
    received.gone(0.1)
    received.send(raw)


def sizes(vendor: type[Vendor]) -> Iterator[Case]:
    """100 MB, of which the client takes no more than its limit."""
    piece = b"x" * 500_000
    begins = {
        "announced": b"HTTP/1.1 200 OK\r\nContent-Length: 100000000\r\n\r\n{" + b" " * 9,
        "until the end": http(b'{"a": "', length=False),
        "of spaces": http(b"", length=False),
        "of a stream": http(b'data: {"a": "', "text/event-stream", length=False),
        "of a redirect": b"HTTP/1.1 302 X\r\nLocation: /x\r\nContent-Length: 100000000\r\n\r\n{",
        "of an error": b"HTTP/1.1 500 X\r\nContent-Length: 100000000\r\n\r\n{",
    }
    for name, begin in begins.items():
        # Two of them meet the limit that is usual.
        limits = Limits(connect=5.0, read=20.0, total=40.0) if name.startswith("of a ") else USUAL
        script = partial(_huge, begin=begin, piece=bytes(500_000).replace(b"\x00", b" ") if "spaces" in name else piece)
        yield Case("size", name, script, kinds=frozenset({"size"}), requests=1, limits=limits)
    coded = b"%x\r\n%s\r\n" % (len(piece), piece)
    begin = http(b"", "application/json", "Transfer-Encoding: chunked", length=False)
    yield Case("size", "in chunks", partial(_huge, begin=begin, piece=coded), kinds=frozenset({"size"}), requests=1)
    lines = b'{"message": {"content": ""}}\n' if vendor is Ollama else b": nothing\n\n"
    begin = http(b"", vendor.kind, length=False)
    yield Case(
        "size", "in lines", partial(_huge, begin=begin, piece=lines * 9000), kinds=frozenset({"size"}), requests=1
    )
    yield Case("size", "header", partial(_huge, begin=b"HTTP/1.1 200 OK\r\nX: ", piece=piece))
    yield Case("size", "headers", partial(_huge, begin=b"HTTP/1.1 200 OK\r\n", piece=b"X: y\r\n" * 9000))
    yield Case("size", "status line", partial(_huge, begin=b"HTTP/1.1 200 ", piece=piece))
    yield Case(
        "size", "packed", sends(http(BOMB, "application/json", "Content-Encoding: gzip")), kinds=frozenset({"size"})
    )


def _huge(received: Received, begin: bytes, piece: bytes) -> None:
    received.send(begin)
    sent = 0
    while sent < 100_000_000:
        received.send(piece)
        sent += len(piece)
    raise AssertionError("the client took it all")


BOMB = gzip.compress(b" " * 100_000_000, 1)
"""100 MB in 400 kB."""
