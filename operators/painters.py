# SPDX-License-Identifier: GPL-3.0-or-later
"""From the add-on's preferences to the image model that paints, or to none; and where its images are kept.

Keys stay here, as in `clients`: they reach no scene, memory, log or report.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import bpy

from .. import __package__ as base_package
from ..pipeline.errors import ModelError, RoomError
from ..pipeline.models.image_registry import (
    ImageSettings,
    image_preset,
    image_settings_from_environment,
    kind_of,
    make_image_client,
)
from ..pipeline.models.presets import own_key_variable
from ..pipeline.textures.kept import KeptImages
from . import clients
from .guarded import GuardedPainter

if TYPE_CHECKING:
    from ..pipeline.models.image_base import ImageClient, ImageRequest, PaintedImage

_made: tuple[ImageSettings, ImageClient | None] | None = None
_pruned = False


def image_settings() -> ImageSettings:
    """The settings of the image model that would paint now.

    Raises:
        ModelError: the key's environment variable is named but not set, or the environment's settings cannot be.
    """
    preferences = clients.add_on_preferences()
    if preferences is None or not hasattr(preferences, "image_provider"):
        return image_settings_from_environment()
    chosen = image_preset(preferences.image_provider)
    if chosen.kind == "builtin":
        return ImageSettings()
    ca_bundle = str(preferences.ca_bundle).strip()
    return ImageSettings(
        kind=kind_of(chosen),
        base_url=preferences.image_base_url,
        model=preferences.image_model.strip(),
        api_key=_key(preferences),
        proxy=str(preferences.proxy).strip(),
        ca_bundle=bpy.path.abspath(ca_bundle) if ca_bundle else "",
        price=float(preferences.image_price),
    )


def image_key_source(preferences: Any) -> str:
    """Name of the environment variable that the key comes from; "" when the typed one is used."""
    usual = own_key_variable(image_preset(preferences.image_provider), preferences.image_base_url)
    return clients.variable_of(preferences.image_key_variable, preferences.image_api_key, usual)


def _key(preferences: Any) -> str:
    return clients.key_of(image_key_source(preferences), preferences.image_api_key, "the image model's key")


def room_painter(picture_hash: str, spent: float) -> ImageClient | None:
    """The image model for one room, None where none is chosen: every image is held against the room's spending cap.

    Settings that are not complete keep no stage from running: what is wrong is told where images would be painted.

    Args:
        picture_hash, spent: as `clients.room_client`.
    """
    global _made
    try:
        settings = image_settings()
        if _made is None or _made[0] != settings:
            _made = (settings, make_image_client(settings))
    except RoomError as error:
        return NoPainter(error)
    client = _made[1]
    if client is None:
        return None
    from ..pipeline.spending_images import metered_painter

    if settings.is_remote:
        client = GuardedPainter(client)
        client.watch()
    return metered_painter(client, settings, clients.room_meter(picture_hash, spent))


def painter_words() -> str:
    """Which image model paints, in one sentence; "" for none, or one whose settings are not complete."""
    try:
        client = make_image_client(image_settings())
    except RoomError:
        return ""
    return client.describes if client is not None else ""


def image_problem() -> str:
    """What keeps the image model from painting, in one sentence; "" when nothing does or none is chosen."""
    try:
        settings = image_settings()
        make_image_client(settings)
    except RoomError as error:
        return f"{error.message} {error.fix}".strip()
    if settings.is_remote and not bpy.app.online_access:
        return "Blender's online access is off, so no images are painted. Allow it in Preferences, System, Network."
    return ""


def image_price() -> float | None:
    """US dollars for one image, None where it is not known."""
    try:
        settings = image_settings()
    except RoomError:
        return None
    return (settings.price or None) if settings.is_remote else 0.0


def image_host() -> str:
    """The host that words for images would be sent to; "" where nothing leaves this computer."""
    try:
        settings = image_settings()
    except RoomError:
        return ""
    return (urlsplit(settings.base_url.strip()).hostname or "") if settings.is_remote else ""


def painted_images() -> KeptImages | None:
    """Where painted images are kept in the add-on's own folder; None where there is none. Main thread only."""
    global _pruned
    try:
        path = Path(bpy.utils.extension_path_user(base_package or "", path="images", create=True))
        path.chmod(0o700)
    except (ValueError, OSError):
        return None
    kept = KeptImages(path)
    if not _pruned:
        _pruned = True
        kept.prune()
    return kept


class NoPainter:
    """An image model whose settings are not complete: it says so."""

    name, describes = "", "An image model whose settings are not complete"

    def __init__(self, error: RoomError) -> None:
        self._error = error

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        """Always ModelError."""
        raise ModelError(f"No image was painted. {self._error.message}", self._error.fix)
