# SPDX-License-Identifier: GPL-3.0-or-later
"""Our clients beside others' code: the vendors' own libraries and a real llama.cpp server. `make test-peers` runs these.

They need packages that nothing else here needs, so they are a group of their own: without `make test-peers` none of them
is collected, with it a missing package is a failure.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parent))  # tests are imported by their paths
sys.path.append(str(Path(__file__).resolve().parent.parent / "faults"))

from fault_server import Peer, start_peer, stop

if os.environ.get("CODE_AS_ROOM_PEERS") != "1":
    collect_ignore_glob = ["test_*.py"]


@pytest.fixture(autouse=True)
def plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """No proxy, no key and no address from outside."""
    for name in os.environ:
        if name.upper().endswith(("_PROXY", "_API_KEY", "_BASE_URL")) or name.upper().startswith(("OPENAI", "OLLAMA")):
            monkeypatch.delenv(name)


@pytest.fixture(scope="module")
def peer() -> Iterator[Peer]:
    """One server for all tests of a file."""
    peer, server = start_peer()
    yield peer
    stop(server)
