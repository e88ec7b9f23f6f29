# SPDX-License-Identifier: GPL-3.0-or-later
"""Base URLs of model services: brought into one form, and told apart by where they lead."""

from __future__ import annotations

import ipaddress
from urllib.parse import urlsplit, urlunsplit

from ..errors import ModelError

_FIX = "Give it like http://localhost:1234/v1 or https://api.example.com/v1."


def normal_base_url(text: str, bare: str = "/v1", endpoints: tuple[str, ...] = ("/chat/completions",)) -> str:
    """A base URL without trailing slash and without the endpoint's own path.

    Args:
        bare: path that is added to a bare host; endpoints: ends that are taken off, the first that fits.

    Raises:
        ModelError: it is not an http or https address, or it holds a user name or password.
    """
    text = text.strip()
    try:
        parts = urlsplit(text)
        valid = parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port is None or parts.port > 0)
    except ValueError:
        valid = False
    if not valid or any(char.isspace() or not char.isprintable() for char in text):
        raise ModelError("The base URL of the model service is not a web address.", _FIX)
    if "@" in parts.netloc:
        raise ModelError("The base URL holds a user name or password.", "Put the key into the API key setting.")
    path = parts.path.rstrip("/")
    for end in endpoints:
        if path.endswith(end):
            path = path.removesuffix(end).rstrip("/")
            break
    path = path or bare
    return urlunsplit((parts.scheme, parts.netloc, path, "", ""))


def is_loopback(host: str) -> bool:
    """Whether a host name or address is this computer itself."""
    if host.lower() == "localhost" or host.lower().endswith(".localhost"):
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def is_own_network(url: str) -> bool:
    """Whether a URL leads to this computer or into its own network, where no one asks for money."""
    try:
        host = (urlsplit(url).hostname or "").lower()
    except ValueError:
        return False
    if not host:
        return False
    if is_loopback(host) or host.endswith((".local", ".lan", ".home.arpa", ".internal")):
        return True
    try:
        return ipaddress.ip_address(host).is_private
    except ValueError:
        return "." not in host


def is_local_url(url: str) -> bool:
    """Whether a URL leads to this computer, so that no internet permission is needed."""
    try:
        return is_loopback(urlsplit(url).hostname or "")
    except ValueError:
        return False
