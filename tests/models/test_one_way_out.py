# SPDX-License-Identifier: GPL-3.0-or-later
"""There is one way from the add-on to the network, and only what asks a model or for a list of models takes it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NETWORK = {
    "requests",
    "urllib3",
    "socket",
    "ssl",
    "http",
    "ftplib",
    "smtplib",
    "asyncio",
    "aiohttp",
    "httpx",
    "webbrowser",
}
EXCHANGE = {"exchange.py", "leash.py", "network_faults.py"}
ASKS = {"http_client.py", "image_base.py", "listing.py"}


def modules() -> Iterator[tuple[Path, ast.Module]]:
    for folder in ("pipeline", "operators", "panels"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            yield path, ast.parse(path.read_text(encoding="utf-8"))


def imported(tree: ast.Module) -> set[str]:
    """First parts of the names of foreign modules that are imported anywhere in a file, urllib.parse left aside."""
    names = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return {"network" if name.startswith("urllib.request") else name.split(".")[0] for name in names}


def test_only_the_exchange_knows_the_network() -> None:
    found = {path.name for path, tree in modules() if imported(tree) & (NETWORK | {"network"})}
    assert found == EXCHANGE


def test_only_questions_and_lists_of_models_are_exchanged() -> None:
    found = set()
    for path, tree in modules():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "exchange":
                found.add(path.name)
    assert found == ASKS


def test_certificates_are_verified_wherever_something_is_sent() -> None:
    given = [
        ast.unparse(keyword.value)
        for path, tree in modules()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        for keyword in node.keywords
        if keyword.arg in ("verify", "cert_reqs", "check_hostname")
    ]
    assert given == ["call.route.ca_bundle or True"]
