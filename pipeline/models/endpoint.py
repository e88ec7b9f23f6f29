# SPDX-License-Identifier: GPL-3.0-or-later
"""What every client over HTTP knows of its service: address, model, key and route, checked before anything is sent."""

from __future__ import annotations

from urllib.parse import urlsplit

from ..errors import ModelError
from .addresses import is_local_url, normal_base_url
from .limits import Route


class Endpoint:
    """One service and one of its models.

    Args:
        base_url: such as "http://localhost:1234/v1"; api_key: "" for services that need none.
        route: proxy and certificates.

    Raises:
        ModelError: the address, the model's name or the key cannot be right.
    """

    vendor = ""
    endpoints: tuple[str, ...] = ()
    """Ends of addresses that people paste along with the base URL."""
    default_path = "/v1"
    key_header = "Authorization"
    what = "model"
    """What the model is called in sentences for the artist."""

    def __init__(self, base_url: str, model: str, api_key: str = "", route: Route | None = None) -> None:
        self.base_url = normal_base_url(base_url, self.default_path, self.endpoints)
        self.model = model.strip()
        if not self.model:
            raise ModelError(f"No {self.what} is named.", "Give the model's name as the service spells it.")
        self._key = checked_key(api_key)
        self._route = route or Route()
        self.host = urlsplit(self.base_url).hostname or ""
        self.name = f"{self.vendor}:{self.model}"
        where = "on this computer" if is_local_url(self.base_url) else f"at {self.host}"
        self.describes = f"The {self.what} {self.model} {where}"

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.base_url!r}, {self.model!r})"


def checked_key(key: str) -> str:
    """The key without surrounding space.

    Raises:
        ModelError: it holds what no key holds; HTTP libraries would quote it in their errors.
    """
    key = key.strip()
    if any(not 33 <= ord(char) <= 126 for char in key):
        raise ModelError("The API key holds spaces or characters that no key has.", "Copy the key again.")
    return key
