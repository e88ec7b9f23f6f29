# SPDX-License-Identifier: GPL-3.0-or-later
"""From the add-on's preferences to the client that answers. Keys stay here: they reach no scene, memory, log or report.

Imports are light on purpose: what talks to services is imported when a client is made.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import bpy

from .. import __package__ as base_package
from ..pipeline.errors import ModelError
from ..pipeline.models.addresses import is_local_url
from ..pipeline.models.base import ModelClient
from ..pipeline.models.presets import own_key_variable, preset
from ..pipeline.models.registry import ClientSettings, make_client, settings_from_environment
from ..pipeline.models.routing import GROUPS, TEXT
from .guarded import NOBODY, OFFLINE, GuardedClient, watch_online_access

if TYPE_CHECKING:
    from ..pipeline.draft.refine import Step
    from ..pipeline.models.prices import Price, PriceList
    from ..pipeline.spending import Meter, RunEstimate

__all__ = ["NOBODY", "OFFLINE", "GuardedClient", "watch_online_access"]
_made: tuple[ClientSettings, ModelClient] | None = None
_meters: dict[str, Meter] = {}
_prices: PriceList | None = None


def add_on_preferences() -> Any:
    """The add-on's preferences; None where it is used as a Python package and not enabled as an add-on."""
    preferences: Any = bpy.context.preferences
    entry = preferences.addons.get(base_package or "")
    return entry.preferences if entry is not None else None


def user_folder() -> Path | None:
    """The add-on's own folder for the user's data; None where it is not enabled as an extension. Main thread only."""
    package = base_package or ""
    if not package.startswith("bl_ext."):
        return None
    utils: Any = bpy.utils
    return Path(utils.extension_path_user(package, create=False))


def client_settings() -> ClientSettings:
    """The settings of the client that would answer now.

    Raises:
        ModelError: the key's environment variable is named but not set.
    """
    preferences = add_on_preferences()
    if preferences is None:
        return settings_from_environment()
    chosen = preset(preferences.provider)
    if chosen.kind == "builtin":
        return ClientSettings()
    if chosen.kind == "recorded":
        return ClientSettings(kind="recorded", folder=bpy.path.abspath(preferences.replies_folder))
    if chosen.kind == "manual":
        folder = str(getattr(preferences, "by_hand_folder", "")).strip()
        return ClientSettings(kind="manual", folder=bpy.path.abspath(folder) if folder else "")
    models = {group: str(getattr(preferences, f"model_{group}", "")).strip() for group in (*GROUPS, TEXT)}
    ca_bundle = str(getattr(preferences, "ca_bundle", "")).strip()
    return ClientSettings(
        kind=chosen.kind,
        base_url=preferences.base_url,
        model=preferences.model.strip(),
        api_key=_key(preferences),
        read_timeout=float(preferences.timeout),
        models={group: model for group, model in models.items() if model},
        proxy=str(getattr(preferences, "proxy", "")).strip(),
        ca_bundle=bpy.path.abspath(ca_bundle) if ca_bundle else "",
        spending_cap=float(getattr(preferences, "spending_cap", 0.0)),
        at_once=int(getattr(preferences, "at_once", 0)) or chosen.at_once,
    )


def key_source(preferences: Any) -> str:
    """Name of the environment variable that the key comes from; "" when the typed one is used."""
    usual = own_key_variable(preset(preferences.provider), preferences.base_url)
    return variable_of(preferences.key_variable, preferences.api_key, usual)


def variable_of(named: str, typed: str, usual: str) -> str:
    """Name of the environment variable that a key comes from; "" when the typed one is used.

    Args:
        named: the one that the artist names; typed: the key that they typed; usual: the service's own, "" for none.
    """
    if named.strip() or typed.strip():
        return named.strip()
    return usual if usual and os.environ.get(usual, "").strip() else ""


def _key(preferences: Any) -> str:
    return key_of(key_source(preferences), preferences.api_key, "the API key")


def key_of(variable: str, typed: str, what: str) -> str:
    """A key from an environment variable, or as it was typed where there is none.

    Raises:
        ModelError: the variable is not set; it says what it should hold.
    """
    if not variable:
        return typed.strip()
    value = os.environ.get(variable, "").strip()
    if not value:
        raise ModelError(
            f"The environment variable {variable!r} that should hold {what} is not set.",
            "Set it before Blender starts, or type the key in the preferences.",
        )
    return value


def has_window() -> bool:
    """Whether there is somebody who can copy and paste."""
    return not bpy.app.background


def current_client() -> ModelClient:
    """The client that the preferences describe, fit to be asked from worker threads.

    Raises:
        ModelError: the preferences are not complete, or Blender's online access is off and the service is not local.
    """
    global _made
    settings = client_settings()
    if settings.kind == "manual" and has_window():
        from . import desk

        return desk.make_client(settings.folder)
    if _made is None or _made[0] != settings or not settings.is_service:
        # A service's client is kept: it has learnt what the service accepts.
        _made = (settings, make_client(settings))
    client = _made[1]
    if not settings.is_service or is_local_url(settings.base_url):
        return client
    guarded = GuardedClient(client)
    guarded.watch()
    if not guarded.online:
        raise OFFLINE
    return guarded


def service_host() -> str:
    """The host that questions would be sent to; "" where nothing leaves this computer.

    Raises:
        ModelError: as `client_settings`.
    """
    settings = client_settings()
    if not settings.is_service or is_local_url(settings.base_url):
        return ""
    return urlsplit(settings.base_url.strip()).hostname or ""


def room_client(picture_hash: str, spent: float) -> ModelClient:
    """`current_client` for one room: every question is priced and held against the room's spending cap, and where a weak
    model's answers cannot be used, the built-in analysis answers.

    Args:
        picture_hash: of the reference image, which the room's running total is kept under in this session.
        spent: US dollars that the room has cost so far, as memory knows it.

    Raises:
        RoomError: as `current_client`, or the artist's own list of prices is not readable.
    """
    client, settings = current_client(), client_settings()
    if not settings.is_service:
        return client
    from ..pipeline.ask_floor import with_floor
    from ..pipeline.spending import metered

    return with_floor(metered(client, settings, room_meter(picture_hash, spent), prices()), settings)


def room_meter(picture_hash: str, spent: float) -> Meter:
    """The running total of a room. What was lost to an undo or an unusable answer stays spent."""
    from ..pipeline.spending import Meter

    meter = _meters.setdefault(picture_hash, Meter())
    preferences = add_on_preferences()
    # The cap holds for painted images, too, whoever answers the questions.
    meter.cap = client_settings().spending_cap if preferences is None else float(preferences.spending_cap)
    meter.raise_to(spent)
    return meter


def take_over_cap() -> None:
    """The cap was changed in the preferences: it holds for a run on its way, too. Main thread only."""
    preferences = add_on_preferences()
    for meter in _meters.values():
        meter.cap = float(getattr(preferences, "spending_cap", 0.0))


def run_estimate(stages: Sequence[str], rounds: int) -> RunEstimate | None:
    """What a run of these stages may cost, for the artist before it begins; None where nothing is asked.

    Args:
        stages: ids of the stages; rounds: most rounds of the layout loop.

    Raises:
        RoomError: the settings or the artist's list of prices cannot be read.
    """
    settings = client_settings()
    from ..pipeline.models.prices import FREE
    from ..pipeline.spending import estimate_run, price_lookup

    if settings.kind == "manual":
        return estimate_run(stages, rounds, lambda stage: ("", FREE))
    if not settings.is_service:
        return None
    return estimate_run(stages, rounds, price_lookup(prices(), settings))


def refine_estimate(steps: Sequence[Step]) -> RunEstimate | None:
    """What refining a draft may cost; None where nothing is asked of a service.

    Raises:
        RoomError: as `run_estimate`.
    """
    settings = client_settings()
    from ..pipeline.draft.refine import estimate
    from ..pipeline.models.prices import FREE
    from ..pipeline.spending import price_lookup

    if settings.kind == "manual":
        return estimate(steps, lambda stage: ("", FREE))
    return estimate(steps, price_lookup(prices(), settings)) if settings.is_service else None


def prices() -> PriceList:
    """The list of prices, read once.

    Raises:
        RoomError: the artist's own list is not readable.
    """
    global _prices
    if _prices is None:
        from ..pipeline.models.prices import load_prices

        _prices = load_prices(user_folder())
    return _prices


def model_prices(settings: ClientSettings) -> list[tuple[str, Price | None]]:
    """Every model of the settings and its price, None where it is not known.

    Raises:
        RoomError: as `prices`.
    """
    names = dict.fromkeys([settings.model, *settings.models.values()])
    return [(name, prices().find(settings.base_url, name)) for name in names if name]


def keep_price(base_url: str, model: str, price: Price) -> None:
    """Take over a price of the artist's, or one that a service told, and keep it for later sessions where that works.

    Raises:
        RoomError: it cannot be kept.
    """
    global _prices
    known = prices().with_price(base_url, model, price)
    folder = user_folder()
    if folder is not None:
        from ..pipeline.models.prices import save_own_price

        save_own_price(folder, base_url, model, price)
    _prices = known


def forget_prices() -> None:
    """Read the list anew when it is needed next."""
    global _prices
    _prices = None
