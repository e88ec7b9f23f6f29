# SPDX-License-Identifier: GPL-3.0-or-later
"""Any service with an OpenAI-style `/images/generations`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .image_base import ImageHttpClient, ImageRequest, PaintedImage, from_base64
from .reply_reader import count

_SIZES = {"square": "1024x1024", "wide": "1536x1024", "tall": "1024x1536"}


class OpenAIImageClient(ImageHttpClient):
    """Bearer key, `prompt` and `size`; base64 or a link back. Nothing else is sent, since services differ in the rest."""

    vendor = "openai-images"
    endpoints = ("/images/generations", "/images/edits", "/chat/completions")

    def url(self) -> str:
        """Where a request is sent."""
        return f"{self.base_url}/images/generations"

    def body(self, request: ImageRequest) -> dict[str, Any]:
        """The request's body."""
        return {"model": self.model, "prompt": request.text, "n": 1, "size": _SIZES[request.proportions]}

    def read(self, data: Mapping[str, Any], get: Callable[[str], bytes]) -> PaintedImage:
        """The image in a reply."""
        items = data.get("data")
        first = items[0] if isinstance(items, list) and items else None
        if not isinstance(first, dict):
            raise self.foreign("a reply without data")
        image = from_base64(first.get("b64_json"))
        link = first.get("url")
        if image is None and isinstance(link, str) and link:
            image = from_base64(link) if link.startswith("data:") else get(link)
        if image is None:
            raise self.foreign("an empty reply")
        usage = data.get("usage")
        tokens = count(usage.get("output_tokens")) if isinstance(usage, dict) else 0
        return PaintedImage(image, self.model, tokens=tokens)
