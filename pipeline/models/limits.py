# SPDX-License-Identifier: GPL-3.0-or-later
"""How long an exchange may take, and the way it goes: time limits, proxy, certificates. Light: no requests, no bpy."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from ..errors import ModelError


@dataclass(frozen=True)
class Limits:
    """Seconds for connecting, between two pieces of a reply, and for everything; bytes of a reply."""

    connect: float = 10.0
    read: float = 120.0
    total: float = 900.0
    size: int = 20_000_000


@dataclass(frozen=True)
class Route:
    """The way to a service.

    Attributes:
        proxy: address of an HTTP proxy, "" for what the environment says. May hold a password, so never shown.
        ca_bundle: file with the certificates to trust, "" for the usual ones. Certificates are always verified.
    """

    proxy: str = field(default="", repr=False)
    ca_bundle: str = ""


def checked_route(proxy: str, ca_bundle: str) -> Route:
    """A route whose settings can be right; the addresses themselves are tried when something is sent.

    Raises:
        ModelError: the proxy is no HTTP address, or the file cannot be read.
    """
    proxy, ca_bundle = proxy.strip(), ca_bundle.strip()
    if proxy:
        if "://" not in proxy:
            proxy = f"http://{proxy}"
        try:
            parts = urlsplit(proxy)
            valid = parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port or 80) > 0
        except ValueError:
            valid = False
        if not valid or any(char.isspace() for char in proxy):
            raise ModelError("The proxy is not the address of an HTTP proxy.", "Give it like http://proxy:8080.")
    if ca_bundle:
        name = os.path.basename(ca_bundle) or ca_bundle
        try:
            with open(ca_bundle, "rb") as file:
                head = file.read(1_000_000)
        except OSError as error:
            reason = error.strerror or "unknown reason"
            raise ModelError(
                f"The certificate file {name!r} cannot be read: {reason}.", "Choose it again in the preferences."
            ) from None
        if b"-----BEGIN" not in head:
            raise ModelError(
                f"The file {name!r} holds no certificates.", "Choose a PEM file, which begins with BEGIN CERTIFICATE."
            )
    return Route(proxy, ca_bundle)
