# SPDX-License-Identifier: GPL-3.0-or-later
"""Google's Gemini image models: `models/NAME:generateContent` with images among the modalities."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any
from urllib.parse import quote

from .image_base import ImageHttpClient, ImageRequest, PaintedImage, from_base64
from .reply_reader import count

_SHAPES = {"square": "1:1", "wide": "3:2", "tall": "2:3"}


class GeminiImageClient(ImageHttpClient):
    """`x-goog-api-key`, `responseModalities`, `inlineData` back."""

    vendor = "gemini-images"
    default_path = "/v1beta"
    endpoints = ("/models",)
    key_header = "x-goog-api-key"

    def url(self) -> str:
        """Where a request is sent."""
        return f"{self.base_url}/models/{quote(self.model.removeprefix('models/'), safe='-._/')}:generateContent"

    def body(self, request: ImageRequest) -> dict[str, Any]:
        """The request's body."""
        return {
            "contents": [{"role": "user", "parts": [{"text": request.text}]}],
            "generationConfig": {
                "responseModalities": ["IMAGE"],
                "imageConfig": {"aspectRatio": _SHAPES[request.proportions]},
            },
        }

    def read(self, data: Mapping[str, Any], get: Callable[[str], bytes]) -> PaintedImage:
        """The image in a reply."""
        feedback = data.get("promptFeedback")
        if isinstance(feedback, dict) and feedback.get("blockReason"):
            raise self.refused(str(feedback.get("blockReasonMessage") or feedback["blockReason"]))
        said: list[str] = []
        reason = ""
        candidates = data.get("candidates")
        for candidate in candidates if isinstance(candidates, list) else []:
            if not isinstance(candidate, dict):
                continue
            content = candidate.get("content")
            parts = content.get("parts") if isinstance(content, dict) else None
            for part in parts if isinstance(parts, list) else []:
                if not isinstance(part, dict) or part.get("thought"):
                    continue
                inline = part.get("inlineData") or part.get("inline_data")
                image = from_base64(inline.get("data")) if isinstance(inline, dict) else None
                if image is not None:
                    usage = data.get("usageMetadata")
                    tokens = count(usage.get("candidatesTokenCount")) if isinstance(usage, dict) else 0
                    model = data.get("modelVersion")
                    return PaintedImage(image, model if isinstance(model, str) else self.model, tokens=tokens)
                if isinstance(part.get("text"), str):
                    said.append(part["text"])
            reason = reason or str(candidate.get("finishReason") or "")
        if reason not in ("", "STOP", "FINISH_REASON_UNSPECIFIED", "MAX_TOKENS"):
            raise self.refused(" ".join(said) or reason)
        raise self.foreign("words") if said else self.foreign("an empty reply")
