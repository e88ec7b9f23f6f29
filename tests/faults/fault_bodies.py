# SPDX-License-Identifier: GPL-3.0-or-later
"""Faulty replies: broken off at every place, not quite HTTP, coded, of other types, in odd letters, with other values."""

from __future__ import annotations

import copy
import gzip
import json
import random
import zlib
from collections.abc import Iterator
from functools import partial
from typing import Any

from fault_cases import BOMB, EITHER, ERROR, RESULT, TEXT, Case, chunked, good, http, sends, whole_body
from fault_envelopes import KEY, Gemini, Ollama, Vendor
from fault_server import Received

TEXTS = {
    "umlauts": '{"a": "größer als 1 m²"}',
    "emoji": '{"a": "😀👩‍👩‍👧"}',
    "lines": '{\r\n"a":\t1\n}',
    "separators": '{"a": "\u2028\u2029\u0085"}',
    "zero": '{"a": "\x00\x1b[31m"}',
    "right to left": '{"a": "\u202eabc\u2066"}',
    "combining": '{"a": "e\u0301' + "\u0300" * 50 + '"}',
    "escapes": '{"a": "\\u00e4\\n\\\\\\""}',
    "fence": '```json\n{"a": 1}\n```',
    "data": '{"a": "data: [DONE]\\n\\ndata: {}"}',
    "long": '{"a": "' + "y" * 60_000 + '"}',
    "mark": '\ufeff{"a": 1}',
}
VALUES: tuple[Any, ...] = (None, True, 7, -1, 1e308, "x", "", [], {}, [None], [[]], {"a": None}, "\ud800", 10**40)


def broken_off(vendor: type[Vendor]) -> Iterator[Case]:
    """Ended or reset at sampled bytes, the first and the last among them; the whole of it is a good reply."""
    body = whole_body(vendor)
    forms = {"length": http(body), "chunks": chunked(body), "close": http(body, length=False)}
    if vendor.chat:
        raw = vendor.stream([TEXT[:3], TEXT[3:]])
        forms |= {"stream": http(raw, vendor.kind, length=False), "stream chunks": chunked(raw, vendor.kind)}
    draw = random.Random(7)
    for name, whole in forms.items():
        head = whole.index(b"\r\n\r\n") + 4
        places = {0, 1, head - 1, head, head + 1, len(whole) - 1, len(whole)}
        places |= set(draw.sample(range(head, len(whole)), 16)) | set(draw.sample(range(head), 6))
        for end in sorted(places):
            reset = end % 2 == 1
            script = partial(_break_off, raw=whole[:end], reset=reset)
            may = RESULT if end == len(whole) and not reset else EITHER
            yield Case("broken off", f"{name} {end}{' reset' if reset else ''}", script, may=may)


def _break_off(received: Received, raw: bytes, reset: bool) -> None:
    received.send(raw)
    if reset:
        received.reset()


def not_quite_http(vendor: type[Vendor]) -> Iterator[Case]:
    """Heads, lengths and chunks as they should not be."""
    body = whole_body(vendor)
    size, head = len(body), b"HTTP/1.1 200 OK\r\n"
    coded = head + b"Transfer-Encoding: chunked\r\n\r\n"
    half = size // 2
    odd: dict[str, tuple[bytes, frozenset[str]]] = {
        "nothing": (b"", ERROR),
        "no http": (b"garbage\r\n\r\n" + body, ERROR),
        "only a line": (head, ERROR),
        "no body": (head + b"\r\n", ERROR),
        "status abc": (b"HTTP/1.1 abc OK\r\n\r\n" + body, ERROR),
        "status 99": (b"HTTP/1.1 99 OK\r\n\r\n" + body, ERROR),
        "http 9": (b"HTTP/9.9 200 OK\r\n\r\n" + body, EITHER),
        "http 1.0": (b"HTTP/1.0 200 OK\r\n\r\n" + body, RESULT),
        "no reason": (b"HTTP/1.1 200\r\n\r\n" + body, RESULT),
        "only feeds": (b"HTTP/1.1 200 OK\nContent-Length: %d\n\n" % size + body, RESULT),
        "continue": (b"HTTP/1.1 100 Continue\r\n\r\n" + http(body), RESULT),
        "hints": (b"HTTP/1.1 103 Early Hints\r\nLink: </x>\r\n\r\n" + http(body), EITHER),
        "length many": (head + b"Content-Length: many\r\n\r\n" + body, EITHER),
        "length less": (head + b"Content-Length: -5\r\n\r\n" + body, EITHER),
        "length short": (head + b"Content-Length: %d\r\n\r\n" % half + body, ERROR),
        "length long": (head + b"Content-Length: %d\r\n\r\n" % (size + 9) + body, ERROR),
        "lengths": (head + b"Content-Length: %d\r\nContent-Length: 3\r\n\r\n" % size + body, EITHER),
        "length huge": (head + b"Content-Length: 99999999999999999999\r\n\r\n" + body, ERROR),
        "length and chunks": (
            head + b"Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n%x\r\n%s\r\n0\r\n\r\n" % (size, body),
            EITHER,
        ),
        "chunk zz": (coded + b"zz\r\n" + body, ERROR),
        "chunk less": (coded + b"-5\r\n" + body, ERROR),
        "chunk huge": (coded + b"ffffffffffffffff\r\n" + body, ERROR),
        "chunk long": (coded + b"%x\r\n%s" % (size + 50, body), ERROR),
        "chunk short": (coded + b"%x\r\n%s\r\n0\r\n\r\n" % (half, body), ERROR),
        "chunk without size": (coded + b"\r\n" + body, ERROR),
        "chunk line": (coded + b"1" * 70_000, ERROR),
        "no last chunk": (coded + b"%x\r\n%s\r\n" % (size, body), EITHER),
        "extensions": (coded + b'%X;name=value;q="a"\r\n%s\r\n0;x\r\n\r\n' % (size, body), RESULT),
        "zeros": (coded + b"0000%x\r\n%s\r\n000\r\n\r\n" % (size, body), RESULT),
        "trailers": (coded + b"%x\r\n%s\r\n0\r\nX: y\r\nZ: z\r\n\r\n" % (size, body), RESULT),
        "chunks of one": (chunked(body, size=1), RESULT),
        "more behind": (http(body) + b"HTTP/1.1 500 X\r\n\r\n", RESULT),
        "other coding": (head + b"Transfer-Encoding: gzip, chunked\r\n\r\n" + body, EITHER),
        "many headers": (head + b"X: y\r\n" * 500 + b"\r\n" + body, ERROR),
        "folded": (head + b"X: y\r\n  z\r\nContent-Length: %d\r\n\r\n" % size + body, EITHER),
        "no colon": (head + b"rubbish\r\nContent-Length: %d\r\n\r\n" % size + body, EITHER),
        "zero in header": (head + b"X: \x00\r\nContent-Length: %d\r\n\r\n" % size + body, EITHER),
        "latin header": (head + b"X-\xe4: \xff\xfe\r\nContent-Length: %d\r\n\r\n" % size + body, EITHER),
        "cookies": (http(body, "application/json", f"Set-Cookie: key={KEY}", "Set-Cookie: b=c; Domain=.x"), RESULT),
    }
    for name, (raw, may) in odd.items():
        yield Case("not quite http", name, sends(raw), may=may)


def coded(vendor: type[Vendor]) -> Iterator[Case]:
    """Packed although nobody asked for it; right, damaged, unknown."""
    body = whole_body(vendor)
    packed = gzip.compress(body)
    bare = zlib.compressobj(wbits=-15)
    codings: dict[str, tuple[str, bytes, frozenset[str]]] = {
        "gzip": ("gzip", packed, RESULT),
        "x-gzip": ("x-gzip", packed, RESULT),
        "capital": ("GZIP", packed, RESULT),
        "deflate": ("deflate", zlib.compress(body), RESULT),
        "bare deflate": ("deflate", bare.compress(body) + bare.flush(), RESULT),
        "members": ("gzip", gzip.compress(body[:50]) + gzip.compress(body[50:]), RESULT),
        "twice": ("gzip, gzip", gzip.compress(packed), EITHER),
        "identity": ("identity", body, RESULT),
        "not packed": ("gzip", body, ERROR),
        "cut": ("gzip", packed[: len(packed) // 2], ERROR),
        "damaged": ("gzip", packed[:20] + bytes(20) + packed[40:], ERROR),
        "wrong sum": ("gzip", packed[:-8] + bytes(8), EITHER),
        "only a head": ("gzip", packed[:10], ERROR),
        "unknown": ("sdch", body, EITHER),
        "not told": ("", packed, ERROR),
        "many": (", ".join(["gzip"] * 50), packed, ERROR),
    }
    for name, (said, raw, may) in codings.items():
        more = [f"Content-Encoding: {said}"] if said else []
        yield Case("coded", name, sends(http(raw, "application/json", *more)), may=may)
        yield Case("coded", f"{name} in chunks", sends(chunked(raw, "application/json", *more)), may=may)
    if vendor.chat:
        raw = gzip.compress(vendor.stream([TEXT]))
        yield Case("coded", "stream", sends(http(raw, vendor.kind, "Content-Encoding: gzip", length=False)), may=RESULT)
        streamed = chunked(raw, vendor.kind, "Content-Encoding: gzip", size=7)
        yield Case("coded", "stream in chunks", sends(streamed), may=RESULT)
    yield Case("coded", "bomb in chunks", sends(chunked(BOMB, "text/plain", "Content-Encoding: gzip", size=50_000)))


def other_types(vendor: type[Vendor]) -> Iterator[Case]:
    """A good reply is taken whatever it is called; what is none is named."""
    body = whole_body(vendor)
    kinds = (
        *("text/html", "text/plain; charset=iso-8859-1", "application/octet-stream", "image/png", "x", "", ";;;"),
        *("application/json; charset=utf-16", "text/event-stream", "application/x-ndjson", "multipart/form-data"),
    )
    for kind in kinds:
        yield Case("other type", f"whole {kind}", sends(http(body, kind)), may=RESULT)
        if vendor.chat:
            raw = http(vendor.stream([TEXT]), kind, length=False)
            yield Case("other type", f"stream {kind}", sends(raw), may=RESULT)
    foreign = {
        "page": b"<!doctype html><html><title>Sign in</title></html>",
        "xml": b'<?xml version="1.0"?><Error><Code>Denied</Code></Error>',
        "words": b"It works!",
        "null": b"null",
        "number": b"7",
        "text": b'"text"',
        "list": b"[1, 2]",
        "spaces": b" \r\n\t " * 900,
        "picture": b"\x89PNG\r\n\x1a\n" + bytes(900),
        "other": b'{"hello": "world"}',
        "empty": b"{}",
        "two": b"{}{}",
        "deep": b'{"a":' * 20_000,
        "brackets": b"[" * 50_000 + b"]" * 50_000,
        "digits": b'{"choices": ' + b"9" * 5000 + b"}",
        "not a number": b'{"choices": [NaN, Infinity]}',
        "utf-16": "garbage".encode("utf-16"),
        "half a letter": b'{"a": "\xc3',
    }
    for name, raw in foreign.items():
        for kind in ("application/json", "text/event-stream"):
            yield Case("other type", f"foreign {name} {kind}", sends(http(raw, kind)), may=ERROR)


def letters(vendor: type[Vendor]) -> Iterator[Case]:
    """Texts in every script arrive as they were written, whole, streamed and byte by byte."""
    if not vendor.chat:
        return
    for name, text in TEXTS.items():
        for ascii_only in (True, False):
            body = json.dumps(vendor.whole(text), ensure_ascii=ascii_only).encode()
            yield Case("letters", f"{name} {ascii_only}", sends(http(body)), may=RESULT, expected=text)
        # Cut in the middle of letters, of escapes, of line ends.
        raw = http(_spelt(vendor.stream([text[:3], text[3:9], text[9:]])), vendor.kind, length=False)
        if len(raw) < 10_000:
            script = partial(Received.drip, data=raw)
            yield Case("letters", f"{name} dripping", script, may=RESULT, expected=text)
    half = '{"a": "\ud83d"}'
    yield Case("letters", "half", sends(http(json.dumps(vendor.whole(half)).encode())), may=RESULT, expected=None)
    pair = [half[:7] + "\ud83d", "\ude00" + half[8:]]
    yield Case(
        "letters", "pair", sends(http(vendor.stream(pair), vendor.kind, length=False)), may=RESULT, expected=None
    )
    bad = json.dumps(vendor.whole(TEXT)).encode().replace(b"served-model", b"served\xff\xfe\xc3model")
    yield Case("letters", "not utf-8", sends(http(bad)), may=EITHER)
    body = json.dumps(vendor.whole(TEXT))
    for name, code in (("mark", "utf-8-sig"), ("utf-16", "utf-16"), ("utf-32", "utf-32-le")):
        yield Case("letters", f"in {name}", sends(http(body.encode(code))), may=EITHER)
    yield from _lines(vendor)


def _spelt(raw: bytes) -> bytes:
    """The same stream with letters instead of escapes; line separators stay escaped, as in any real service."""
    text = raw.decode()
    for code in "\u00f6\u00df\u00b2\u0301\u0300\u202e\u2066\ufeff\u2028\u2029\u0085":
        text = text.replace(json.dumps(code)[1:-1], code)
    return text.encode()


def _lines(vendor: type[Vendor]) -> Iterator[Case]:
    """Line ends and fields of a stream, as far as the standard allows them."""
    raw = vendor.stream([TEXT[:3], TEXT[3:]])
    ways = {"crlf": raw.replace(b"\n", b"\r\n"), "no end": raw.rstrip(), "mark": b"\xef\xbb\xbf" + raw}
    if vendor is Ollama:
        ways |= {"empty lines": raw.replace(b"\n", b"\n\n\n"), "spaces": raw.replace(b"\n", b"  \n  ")}
    else:
        ways |= {
            "cr": raw.replace(b"\n", b"\r"),
            "no space": raw.replace(b"data: ", b"data:"),
            "comments": raw.replace(b"data: ", b": ping\ndata: "),
            "fields": raw.replace(b"data: ", b"id: 7\nretry: 10\nodd\ndata: "),
            "in two": raw.replace(b'data: {"', b'data: {\ndata: "'),
            "empty data": b"data:\n\ndata: \n\n" + raw,
        }
    if vendor is Gemini:
        parts = [json.loads(line[6:]) for line in raw.split(b"\n") if line.startswith(b"data: ")]
        ways["a list"] = json.dumps(parts).encode()
    for name, body in ways.items():
        may = EITHER if vendor is Ollama and name == "mark" else RESULT
        yield Case("letters", f"lines {name}", sends(http(body, vendor.kind, length=False)), may=may)


def other_values(vendor: type[Vendor], count: int = 70) -> Iterator[Case]:
    """A good reply with one value replaced, left out or said twice: an answer that is one, or an error."""
    tree = vendor.whole(good(vendor))
    places = list(_places(tree))
    draw = random.Random(11)
    for number in range(count):
        place = places[number % len(places)]
        value = draw.choice(VALUES)
        changed = _changed(tree, place, value, draw.random() < 0.2)
        body = json.dumps(changed).encode()
        yield Case("other value", f"whole {number} {place}={value!r}", sends(http(body)), may=EITHER, expected=None)
    body = whole_body(vendor)
    for key in tree:
        twice = b'{"%s": null, ' % key.encode() + body[1:]
        yield Case("other value", f"{key} twice", sends(http(twice)), may=RESULT)
    if not vendor.chat:
        return
    parts = vendor.stream([TEXT[:3], TEXT[3:]]).splitlines(keepends=True)
    told = [n for n, part in enumerate(parts) if b"{" in part]
    for number in range(count // 2):
        at = draw.choice(told)
        lead, _, text = parts[at].partition(b"{")
        part = json.loads(b"{" + text)
        place = draw.choice(list(_places(part)))
        value = draw.choice(VALUES)
        line = lead + json.dumps(_changed(part, place, value, draw.random() < 0.2)).encode() + b"\n"
        raw = b"".join([*parts[:at], line, *parts[at + 1 :]])
        name = f"stream {number} {at} {place}={value!r}"
        script = sends(http(raw, vendor.kind, length=False))
        yield Case("other value", name, script, may=EITHER, expected=None)


def _places(tree: Any, here: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The way to each value inside, whatever it is."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield (*here, key)
        yield from _places(value, (*here, key))


def _changed(tree: Any, place: tuple[Any, ...], value: Any, gone: bool) -> Any:
    tree = copy.deepcopy(tree)
    holder = tree
    for key in place[:-1]:
        holder = holder[key]
    if gone:
        del holder[place[-1]]
    else:
        holder[place[-1]] = value
    return tree


def echoes(vendor: type[Vendor]) -> Iterator[Case]:
    """A service that says the key back, in any form and at any place, gets it neither into an error nor into an answer."""
    if vendor.chat:
        said = json.dumps({"a": f"your key is {KEY}"})
        for form, raw in (("whole", http(json.dumps(vendor.whole(said)).encode())), ("stream", None)):
            raw = raw or http(vendor.stream([said[:20], said[20:]]), vendor.kind, length=False)
            yield Case("echo", f"answer {form}", sends(raw), may=RESULT, expected=None)
        named = json.loads(whole_body(vendor).decode().replace("served-model", KEY))
        yield Case("echo", "model", sends(http(json.dumps(named).encode())), may=RESULT)
    forms = (KEY, KEY.upper(), f"Bearer {KEY}", KEY[:12] + "..." + KEY[-4:], "".join(f"\\u{ord(c):04x}" for c in KEY))
    for number, form in enumerate(forms):
        for status in (400, 401, 403, 404, 500):
            body = '{"error": {"message": "no: KEY", "code": "KEY", "type": "KEY"}}'.replace("KEY", form).encode()
            raw = http(body).replace(b"200 OK", b"%d %s" % (status, form.encode()))
            yield Case("echo", f"{status} {number}", sends(raw))
