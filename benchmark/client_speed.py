# SPDX-License-Identifier: GPL-3.0-or-later
"""What the model clients cost: `python -m benchmark.client_speed [--calls 200] [--cancels 200] [--client openai]`.

Three numbers, from a service of our own on loopback in a process of its own: how much longer a call takes than a bare
`requests.post` of the same body; how long eight side by side take beside one; how long stopping takes at random moments,
while connecting, waiting, reading and between two tries. The exit code is 1 where an aim is missed.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import random
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import requests
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.limits import Limits
from code_as_room.pipeline.models.pace import Pace
from code_as_room.pipeline.models.retry import RetryPolicy

sys.path.append(str(Path(__file__).resolve().parent.parent / "tests" / "faults"))

from fault_envelopes import CHATS, KEY, Vendor, a_prompt
from fault_server import Received, deaf_port, start_peer

MOST_OVERHEAD = 0.005
MOST_RATIO = 1.3
USUAL_STOP, LONGEST_STOP = 0.2, 1.0
THINKING = 1.0
"""Seconds that the service takes for an answer where the clock is to count its work and not ours."""
TOGETHER = 8
TEXT = '{"a": 1}'


def serve() -> None:
    """The service, until its input is closed: says its port, then answers by the first part of the path."""
    peer, _ = start_peer()
    vendors = {vendor.name: vendor for vendor in CHATS}

    def at_once(received: Received, vendor: type[Vendor]) -> None:
        received.reply(200, vendor.whole(TEXT))

    def later(received: Received, vendor: type[Vendor]) -> None:
        time.sleep(THINKING)
        received.reply(200, vendor.whole(TEXT))

    def slowly(received: Received, vendor: type[Vendor]) -> None:
        """A third of a second of silence, then a word every 20 ms for ever."""
        raw = vendor.stream(["x"] * 400)
        received.gone(0.3)
        received.start_stream(kind=vendor.kind)
        for at in range(0, len(raw), 40):
            received.send(raw[at : at + 40])
            if received.gone(0.02):
                return

    def busy(received: Received, vendor: type[Vendor]) -> None:
        received.reply(503, {}, {"Retry-After": "30"})

    for act in (at_once, later, slowly, busy):
        for name, vendor in vendors.items():
            peer.place(f"{act.__name__}-{name}", lambda r, act=act, vendor=vendor: act(r, vendor))
    print(peer.port, flush=True)
    sys.stdin.read()


@contextlib.contextmanager
def service() -> Iterator[str]:
    """The service in a process of its own; its origin."""
    with subprocess.Popen(
        [sys.executable, "-m", "benchmark.client_speed", "--serve"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None and process.stdin is not None
        yield f"http://127.0.0.1:{int(process.stdout.readline())}"
        process.stdin.close()


def seconds(act: Callable[[], Any]) -> float:
    began = time.perf_counter()
    act()
    return time.perf_counter() - began


def overhead(vendor: type[Vendor], origin: str, calls: int) -> tuple[float, float]:
    """Median seconds of a bare post, and of a call of the client; they take turns, so that both meet the same machine."""
    client = vendor.make(f"{origin}/at_once-{vendor.name}")
    prompt = a_prompt()
    body = json.dumps(client.body(prompt, client.first_habits)).encode()
    url = client.url(client.first_habits)
    header = {client.key_header: KEY, "Content-Type": "application/json"}

    def bare() -> None:
        requests.post(url, data=body, headers=header, timeout=30).json()

    times: tuple[list[float], list[float]] = ([], [])
    for number in range(calls + 5):
        pair = seconds(bare), seconds(lambda: client.answer(prompt, threading.Event()))
        if number >= 5:
            times[0].append(pair[0])
            times[1].append(pair[1])
    return statistics.median(times[0]), statistics.median(times[1])


def side_by_side(vendor: type[Vendor], origin: str) -> tuple[float, float]:
    """Seconds of one call, and of eight at the same time through one client that lets eight through."""
    client = vendor.make(f"{origin}/later-{vendor.name}", pace=Pace(TOGETHER))
    prompt = a_prompt()

    def one(_: int = 0) -> None:
        client.answer(prompt, threading.Event())

    alone = min(seconds(one) for _ in range(3))
    with ThreadPoolExecutor(TOGETHER) as pool:
        together = min(seconds(lambda: list(pool.map(one, range(TOGETHER)))) for _ in range(3))
    return alone, together


def stops(vendor: type[Vendor], origin: str, count: int, seed: int = 5) -> list[float]:
    """Seconds from the stop to the client's return, at random moments of every state."""
    draw = random.Random(seed)
    taken: list[float] = []
    with deaf_port() as deaf:
        places = [f"{origin}/slowly-{vendor.name}"] * 6 + [f"{origin}/busy-{vendor.name}"]
        places += [f"http://127.0.0.1:{deaf}"] if deaf is not None else []
        jobs = [(draw.choice(places), draw.uniform(0.0, 0.8)) for _ in range(count)]
        with ThreadPoolExecutor(4) as pool:
            taken = list(pool.map(lambda job: _stop(vendor, *job), jobs))
    return taken


def _stop(vendor: type[Vendor], place: str, moment: float) -> float:
    cancel, pressed = threading.Event(), [0.0]

    def press() -> None:
        pressed[0] = time.perf_counter()
        cancel.set()

    client = vendor.make(place, limits=Limits(connect=30.0), retries=RetryPolicy(3, 60.0))
    timer = threading.Timer(moment, press)
    timer.start()
    try:
        client.answer(a_prompt(), cancel)
    except Cancelled:
        return time.perf_counter() - pressed[0]
    except ModelError as error:
        raise SystemExit(f"A call ended by itself: {error}") from None
    finally:
        timer.cancel()
    raise SystemExit("A call ended by itself.")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where an aim is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--calls", type=int, default=200)
    parser.add_argument("--cancels", type=int, default=200)
    parser.add_argument("--client", choices=[vendor.name for vendor in CHATS], help="only this one")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.serve:
        serve()
        return 0
    good = True
    with service() as origin:
        print(f"{'':<12}{'post':>9}{'client':>9}{'more':>9}{'one':>9}{'eight':>9}{'ratio':>8}{'stop':>9}{'longest':>9}")
        for vendor in CHATS:
            if options.client in (None, vendor.name):
                bare, ours = overhead(vendor, origin, options.calls)
                one, eight = side_by_side(vendor, origin)
                taken = stops(vendor, origin, options.cancels)
                usual, longest = statistics.median(taken), max(taken)
                good &= ours - bare < MOST_OVERHEAD and eight / one < MOST_RATIO
                good &= usual < USUAL_STOP and longest <= LONGEST_STOP
                milliseconds = "".join(f"{1000 * value:6.2f} ms" for value in (bare, ours, ours - bare))
                print(
                    f"{vendor.name:<12}{milliseconds}{one:7.3f} s{eight:7.3f} s{eight / one:8.3f}{usual:7.3f} s{longest:7.3f} s"
                )
    print(
        f"Aims: less than {1000 * MOST_OVERHEAD:g} ms more, ratio below {MOST_RATIO:g}, stops of {USUAL_STOP:g} s, "
        f"none over {LONGEST_STOP:g} s: {'reached' if good else 'NOT REACHED'}"
    )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
