# SPDX-License-Identifier: GPL-3.0-or-later
"""Asking a service for its models, and testing the connection to it: in a worker thread, so that Blender goes on.

The worker never touches bpy; it is handed settings and puts what it finds into a queue that a timer looks into. The
preferences draw what was found last. Nothing is sent unless the artist presses a button.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import bpy

from ..pipeline.errors import Cancelled, ModelError, RoomError
from ..pipeline.models.addresses import is_local_url
from ..pipeline.models.presets import preset
from ..pipeline.models.registry import SERVICES, ClientSettings
from . import clients, model_prices
from .base import manager

if TYPE_CHECKING:
    from ..pipeline.models.connection import ConnectionReport
    from ..pipeline.models.listing import ModelInfo

log = logging.getLogger(__name__)
_INTERVAL = 0.1
_STATUS_SECONDS = 10.0


@dataclass
class Activity:
    """What is being asked now."""

    what: str
    work: Callable[[Activity], Any]
    done: Callable[[Any], None]
    cancel: threading.Event = field(default_factory=threading.Event)
    news: queue.SimpleQueue[str] = field(default_factory=queue.SimpleQueue)
    result: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    progress: str = ""
    began: float = field(default_factory=time.monotonic)
    seconds: int = 0

    def run(self) -> None:
        """The worker's side."""
        try:
            self.result.put(self.work(self))
        except BaseException as error:
            self.result.put(error)


_activity: Activity | None = None
_report: ConnectionReport | None = None
_problem: RoomError | None = None
_models: dict[tuple[str, str], tuple[ModelInfo, ...]] = {}
_status_until = 0.0


# What the preferences draw ----------------------------------------------------------------------------------------


def activity() -> Activity | None:
    """What is being asked now, None when nothing is."""
    return _activity


def report() -> ConnectionReport | None:
    """What the last test found; None when there was none since the settings changed."""
    return _report


def problem() -> RoomError | None:
    """Why the last request for the list of models failed."""
    return _problem


def models_at(settings: ClientSettings) -> tuple[ModelInfo, ...]:
    """The models that a service listed in this session."""
    return _models.get((settings.kind, settings.base_url.strip()), ())


def models_of(preferences: Any) -> tuple[ModelInfo, ...]:
    """The models that the service listed in this session; none when it was not asked yet."""
    return _models.get(_place(preferences), ())


def _place(preferences: Any) -> tuple[str, str]:
    return preset(preferences.provider).kind, str(preferences.base_url).strip()


# News from the preferences ----------------------------------------------------------------------------------------


def settings_changed() -> None:
    """The preferences changed: what was found does not hold any more."""
    global _report, _problem
    _report = _problem = None
    if _activity is not None:
        _activity.cancel.set()
    model_prices.look_up()


# Running ----------------------------------------------------------------------------------------------------------


def blocker(preferences: Any) -> str:
    """Why nothing can be asked now, "" when it can. No I/O."""
    if preferences is None:
        return "The add-on's preferences are not there"
    if preset(preferences.provider).kind not in SERVICES:
        return "This provider needs no connection"
    if _activity is not None:
        return "The service is being asked; wait for it, or stop it"
    if not bpy.app.online_access and not is_local_url(str(preferences.base_url)):
        return "Blender's online access is off: allow it in Preferences, System, Network"
    return ""


def start_test() -> Activity:
    """Begin testing the connection.

    Raises:
        RoomError: the settings are not complete, or online access is off.
    """
    global _report
    settings = _settings()
    chosen = preset(clients.add_on_preferences().provider)
    _report = None

    def work(task: Activity) -> Any:
        from ..pipeline.models.connection import try_connection

        return try_connection(settings, chosen, task.cancel, task.news.put)

    return _start(Activity("Testing the connection", work, _tested))


def start_listing() -> Activity:
    """Begin asking for the list of models.

    Raises:
        RoomError: as `start_test`.
    """
    global _problem
    settings = _settings()
    _problem = None

    def work(task: Activity) -> Any:
        from ..pipeline.models.listing import list_models

        return list_models(settings, task.cancel, task.news.put)

    def done(found: Any) -> None:
        global _problem
        if isinstance(found, RoomError):
            _problem = found
            return
        _models[(settings.kind, settings.base_url.strip())] = found
        model_prices.look_up()

    return _start(Activity("Fetching the models", work, done))


def _tested(found: Any) -> None:
    global _report
    from ..pipeline.models.connection import ConnectionReport

    if isinstance(found, RoomError):
        found = ConnectionReport("bad", "settings", found.message, found.fix)
    _report = found


def _settings() -> ClientSettings:
    if _activity is not None:
        raise RoomError("The service is being asked.", "Wait for it, or stop it.")
    if clients.add_on_preferences() is None:
        raise RoomError("The add-on's preferences are not there.", "Enable Code-as-Room as an add-on.")
    settings = clients.client_settings()
    if not settings.is_service:
        raise RoomError("This provider needs no connection.", "There is nothing to test.")
    if not bpy.app.online_access and not is_local_url(settings.base_url):
        raise ModelError(clients.OFFLINE.message, clients.OFFLINE.fix)
    return settings


def _start(task: Activity) -> Activity:
    global _activity
    _activity = task
    task.progress = task.what
    threading.Thread(target=task.run, name="code-as-room-connection", daemon=True).start()
    return task


def run_in_window() -> None:
    """Let Blender's timer look for the result; it goes on when another file is loaded."""
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0, persistent=True)
    redraw()


def run_blocking() -> None:
    """Wait for the result here and now."""
    while _activity is not None:
        if not look():
            time.sleep(0.02)


def stop() -> None:
    """Stop what is being asked."""
    if _activity is not None:
        _activity.cancel.set()


def look() -> bool:
    """Take what the worker has found; True when it has ended. Main thread only."""
    global _activity
    task = _activity
    if task is None:
        return True
    if not bpy.app.online_access and not _is_local():
        task.cancel.set()
    while not task.news.empty():
        task.progress = task.news.get()
    if task.result.empty():
        return False
    _activity = None
    found = task.result.get()
    if isinstance(found, Cancelled) or task.cancel.is_set():
        return True
    if isinstance(found, BaseException) and not isinstance(found, RoomError):
        log.error("%s failed unexpectedly", task.what, exc_info=found)
        found = RoomError("Something unexpected went wrong.", "The details are in Blender's console.")
    task.done(found)
    return True


def _is_local() -> bool:
    preferences = clients.add_on_preferences()
    return preferences is None or is_local_url(str(preferences.base_url))


def _tick() -> float | None:
    """The timer. Nothing may be raised here."""
    global _status_until
    task = _activity
    try:
        if task is not None:
            before = (task.progress, task.seconds)
            ended = look()
            task.seconds = int(time.monotonic() - task.began)
            if not ended:
                if (task.progress, task.seconds) != before:
                    _tell(f"{task.progress} ({task.seconds} s)")
                    redraw()
                return _INTERVAL
            _tell(_outcome(task))
            _status_until = time.monotonic() + _STATUS_SECONDS
            redraw()
        if time.monotonic() < _status_until:
            return _INTERVAL
        _tell(None)
    except Exception:
        log.exception("The connection's result could not be shown")
        forget()
    return None


def _outcome(task: Activity) -> str:
    if task.cancel.is_set():
        return f"{task.what}: stopped"
    if _report is not None and task.what.startswith("Testing"):
        return f"{_report.sentence} {_report.fix}".strip()
    if _problem is not None:
        return str(_problem)
    preferences = clients.add_on_preferences()
    return f"{len(models_of(preferences))} models found" if preferences is not None else ""


def _tell(text: str | None) -> None:
    """A sentence in Blender's status bar; None gives it back."""
    for window in manager(bpy.context).windows if manager(bpy.context) else ():
        workspace: Any = window.workspace
        workspace.status_text_set(text)


def redraw() -> None:
    """Redraw the preferences' windows."""
    for window in manager(bpy.context).windows if manager(bpy.context) else ():
        for area in window.screen.areas:
            if area.type == "PREFERENCES":
                area.tag_redraw()


def forget() -> None:
    """The add-on is disabled: stop, and leave nothing behind."""
    global _activity, _report, _problem, _status_until
    stop()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
        _tell(None)
    _activity = _report = _problem = None
    _status_until = 0.0
    _models.clear()
