# SPDX-License-Identifier: GPL-3.0-or-later
"""From settings to a client that paints, or to none. Keys come from preferences or the environment, and are never printed.

Environment variables (for the command; the add-on's preferences come first in Blender):

- `CODE_AS_ROOM_IMAGE_PROVIDER`: none, openai, gemini or custom; custom where only the address is set, else none.
- `CODE_AS_ROOM_IMAGE_BASE_URL`: the service's address; the provider's own where it is not set.
- `CODE_AS_ROOM_IMAGE_MODEL`: the image model's name, as the service spells it.
- `CODE_AS_ROOM_IMAGE_API_KEY`: the key. Where it is not set, OPENAI_API_KEY or GEMINI_API_KEY, for the provider's own
  address only.
- `CODE_AS_ROOM_IMAGE_PRICE`: US dollars for one image, where the service does not say itself.

Proxy, certificates and the spending cap are those of the questions.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from ..errors import ModelError
from .addresses import is_local_url
from .limits import checked_route
from .presets import Preset, own_key_variable

if TYPE_CHECKING:
    from .image_base import ImageClient

ImageKind = Literal["none", "openai", "gemini"]

IMAGE_PRESETS = (
    Preset(
        "NONE",
        0,
        "None",
        "Images come from the picture itself; no image model is asked",
        "No image model is asked: floors, rugs and pictures come from the picture itself. Free.",
        "builtin",
    ),
    Preset(
        "OPENAI",
        1,
        "OpenAI images",
        "OpenAI's image models, on the internet",
        "Needs a key with credit. You pay OpenAI for every image; a room has about 2 to 16.",
        "openai",
        "https://api.openai.com/v1",
        "https://platform.openai.com/api-keys",
        "OPENAI_API_KEY",
        "needed",
    ),
    Preset(
        "GEMINI",
        2,
        "Google Gemini images",
        "Google's image models, on the internet",
        "Needs a key with credit. You pay Google for every image; a room has about 2 to 16.",
        "gemini",
        "https://generativelanguage.googleapis.com/v1beta",
        "https://aistudio.google.com/apikey",
        "GEMINI_API_KEY",
        "needed",
    ),
    Preset(
        "CUSTOM",
        3,
        "Other OpenAI-style images",
        "Any service with an OpenAI-style address for images, on this computer or on the internet",
        "Any service that paints like OpenAI's, such as one on this computer.",
        "openai",
        "http://localhost:8080/v1",
        key="optional",
    ),
)


@dataclass(frozen=True)
class ImageSettings:
    """Which image model paints, if any.

    Attributes:
        kind: "none" needs nothing else; the others need `base_url` and `model`.
        api_key, proxy: never shown in `repr`.
        price: US dollars for one image, 0 where it is not known.
    """

    kind: ImageKind = "none"
    base_url: str = ""
    model: str = ""
    api_key: str = field(default="", repr=False)
    proxy: str = field(default="", repr=False)
    ca_bundle: str = ""
    price: float = 0.0

    @property
    def is_remote(self) -> bool:
        """Whether words are sent to another computer."""
        return self.kind != "none" and not is_local_url(self.base_url)


def image_preset(identifier: str) -> Preset:
    """A preset by its id, in any case. Raises ModelError where there is none."""
    wanted = identifier.strip().upper()
    found = next((p for p in IMAGE_PRESETS if p.id == wanted), None)
    if found is None:
        names = ", ".join(p.id.lower() for p in IMAGE_PRESETS)
        raise ModelError(f"There is no image provider {identifier.strip()[:60]!r}.", f"Choose one of {names}.")
    return found


def kind_of(chosen: Preset) -> ImageKind:
    """The kind of client for a preset."""
    return "gemini" if chosen.kind == "gemini" else "openai" if chosen.kind == "openai" else "none"


def image_settings_from_environment(environment: Mapping[str, str] | None = None) -> ImageSettings:
    """The settings that the environment variables describe; no image model when there are none.

    Raises:
        ModelError: the provider is not known, or the price is no number.
    """
    given = os.environ if environment is None else environment

    def value(name: str) -> str:
        return given.get(f"CODE_AS_ROOM_{name}", "").strip()

    provider, base_url = value("IMAGE_PROVIDER"), value("IMAGE_BASE_URL")
    chosen = image_preset(provider) if provider else image_preset("CUSTOM" if base_url else "NONE")
    if chosen.kind == "builtin":
        return ImageSettings()
    base_url = base_url or chosen.base_url
    return ImageSettings(
        kind=kind_of(chosen),
        base_url=base_url,
        model=value("IMAGE_MODEL"),
        api_key=value("IMAGE_API_KEY") or given.get(own_key_variable(chosen, base_url), "").strip(),
        proxy=value("PROXY"),
        ca_bundle=value("CA_BUNDLE"),
        price=_dollars(value("IMAGE_PRICE")),
    )


def _dollars(text: str) -> float:
    try:
        number = float(text or "0")
    except ValueError:
        number = math.nan
    if not 0.0 <= number <= 1000.0:
        raise ModelError("CODE_AS_ROOM_IMAGE_PRICE is not a number of US dollars.", "Set it anew, such as 0.04.")
    return number


def make_image_client(settings: ImageSettings) -> ImageClient | None:
    """The client that the settings describe, None for no image model. Nothing is sent until it paints.

    Raises:
        ModelError: the settings are not complete or cannot be right.
    """
    if settings.kind == "none":
        return None
    route = checked_route(settings.proxy, settings.ca_bundle)
    if settings.kind == "gemini":
        from .image_gemini import GeminiImageClient

        return GeminiImageClient(settings.base_url, settings.model, settings.api_key, route=route)
    from .image_openai import OpenAIImageClient

    return OpenAIImageClient(settings.base_url, settings.model, settings.api_key, route=route)
