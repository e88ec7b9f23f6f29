# SPDX-License-Identifier: GPL-3.0-or-later
"""Before the first request to a service on the internet the artist sees what is about to be sent and where to, and
agrees. Asked once for each host; in scripts and in background mode the user's own configuration is the consent."""

from __future__ import annotations

import json
import textwrap
from pathlib import Path
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from . import clients, painters
from .base import RoomOperator, manager
from .user_files import read_json, write_json

_FILE = "services.json"
_WIDTH, _CHARACTERS = 440, 72
IMAGES = "images:"
"""Before the host of an image model: what it is sent is less than what a model is sent that looks at the picture."""
_session: set[str] = set()


def is_allowed(host: str) -> bool:
    """Whether the artist agreed that pictures go to this host; "" (this computer) needs no consent."""
    return not host or host in _session or host in _hosts()


def allow(host: str) -> None:
    """Remember the artist's consent, for this session and in the user's folder."""
    _session.add(host)
    write_json(_file(), {"allowed": sorted({*_hosts(), host})})


def forget() -> None:
    """Forget all consent, so that the next run asks again."""
    _session.clear()
    write_json(_file(), {"allowed": []})


def _file() -> Path | None:
    folder = clients.user_folder()
    return folder / _FILE if folder is not None else None


def _hosts() -> list[str]:
    allowed = read_json(_file()).get("allowed", [])
    return [host for host in allowed if isinstance(host, str)] if isinstance(allowed, list) else []


def what_is_sent(context: Any, host: str) -> list[tuple[str, str]]:
    """What a run would send and where to: sentences, each with its icon."""
    if host.startswith(IMAGES):
        return [
            (f"To {host.removeprefix(IMAGES)} will be sent:", "WORLD"),
            ("for each floor, rug and picture a few words, its size and its colours", "DOT"),
            ("Nothing of the picture itself is sent, and nothing else of your file.", "NONE"),
            ("Each image is paid for. You are asked once for each service.", "NONE"),
        ]
    settings = context.scene.code_as_room
    image = settings.picture
    size = f", {image.size[0]} x {image.size[1]} pixels" if image is not None else ""
    name = settings.picture_name or "unnamed"
    lines = [
        (f"To {host} will be sent:", "WORLD"),
        (f"the reference picture ({name}{size}) and enlarged parts of it", "DOT"),
        ("pictures of the layout as it is built, and lists of the objects in it", "DOT"),
    ]
    if settings.notes.strip():
        lines.append(("your notes to the model", "DOT"))
    lines.append(("Nothing else of your file is sent. What the service keeps of it, its own terms say.", "NONE"))
    lines.append(("You are asked once for each service.", "NONE"))
    return lines


def ask_first(context: Any, operator: Any) -> bool:
    """Ask for consent when it is missing; True when the operator has to wait for it. It is called again afterwards."""
    try:
        hosts = [clients.service_host(), IMAGES + painters.image_host()]
    except RoomError:
        return False  # the run itself says what is wrong
    host = next((host for host in hosts if host != IMAGES and not is_allowed(host)), "")
    if bpy.app.background or not host:
        return False
    again = json.dumps(dict(operator.as_keywords()))
    ask: Any = bpy.ops.code_as_room.allow_service  # type: ignore[attr-defined]
    ask("INVOKE_DEFAULT", host=host, operator=operator.bl_idname, arguments=again)
    return True


class CODE_AS_ROOM_OT_allow_service(RoomOperator):
    """See what is about to be sent to the model service, and allow it"""

    bl_idname = "code_as_room.allow_service"
    bl_label = "Send Pictures to a Service?"
    bl_options = {"REGISTER", "INTERNAL"}

    host: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Host", description="The service's host name", options={"HIDDEN", "SKIP_SAVE"}
    )
    operator: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Then", description="What is done afterwards", options={"HIDDEN", "SKIP_SAVE"}
    )
    arguments: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Arguments", description="What it is called with, as JSON", options={"HIDDEN", "SKIP_SAVE"}
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Show what is about to be sent."""
        title = "Ask an Image Model?" if self.host.startswith(IMAGES) else "Send Pictures to a Service?"
        result: set[Any] = manager(context).invoke_props_dialog(
            self, width=_WIDTH, title=title, confirm_text="Allow and Run"
        )
        return result

    def draw(self, context: bpy.types.Context) -> None:
        """What is sent, and where to."""
        layout: Any = self.layout
        column = layout.column(align=True)
        for line, icon in what_is_sent(context, self.host):
            for number, part in enumerate(textwrap.wrap(line, _CHARACTERS)):
                column.label(text=part, icon=icon if number == 0 or icon == "NONE" else "BLANK1")

    def perform(self, context: bpy.types.Context) -> None:
        """Remember, and go on with what was asked for."""
        allow(self.host)
        name = self.operator.rpartition(".")[2].removeprefix("CODE_AS_ROOM_OT_")
        if name:
            ours: Any = bpy.ops.code_as_room  # type: ignore[attr-defined]
            getattr(ours, name)("INVOKE_DEFAULT", **json.loads(self.arguments or "{}"))


CLASSES = (CODE_AS_ROOM_OT_allow_service,)
