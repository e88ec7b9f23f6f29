# SPDX-License-Identifier: GPL-3.0-or-later
"""One server for hundreds of faulty exchanges, and a count of what they leave behind."""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.models.exchange import THREAD_NAME

sys.path.append(str(Path(__file__).resolve().parent))  # tests are imported by their paths

from fault_server import Peer, start_peer, stop

DESCRIPTORS = Path("/proc/self/fd")


def _held() -> dict[str, int]:
    """Threads of exchanges and sockets of this process."""
    sockets = 0
    if DESCRIPTORS.is_dir():
        for name in os.listdir(DESCRIPTORS):
            try:
                sockets += os.readlink(DESCRIPTORS / name).startswith("socket:")
            except OSError:
                continue
    return {"threads": sum(t.name == THREAD_NAME for t in threading.enumerate()), "sockets": sockets}


@pytest.fixture(autouse=True)
def nothing_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every test leaves as many threads and sockets as there were, and no temporary file."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    before = _held()
    yield
    end = time.monotonic() + 5.0
    while (after := _held()) != before and time.monotonic() < end:
        time.sleep(0.02)
    assert all(after[name] <= before[name] for name in before), f"before {before}, after {after}"
    assert list(folder.iterdir()) == []


@pytest.fixture(autouse=True)
def plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """No proxy and no certificates from outside."""
    for name in ("http_proxy", "https_proxy", "all_proxy", "no_proxy", "requests_ca_bundle", "curl_ca_bundle"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


@pytest.fixture(scope="module")
def peer() -> Iterator[Peer]:
    """One server for all cases of a file."""
    peer, server = start_peer()
    yield peer
    stop(server)


@pytest.fixture
def keep() -> Iterator[Callable[[Any], Any]]:
    """Takes what `start_...` functions give; their servers are stopped at the end."""
    servers = []

    def take(started: tuple[Any, ...]) -> tuple[Any, ...]:
        servers.append(started[0])
        return started[1:]

    yield take
    for server in servers:
        stop(server)
