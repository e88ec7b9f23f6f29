# SPDX-License-Identifier: GPL-3.0-or-later
"""The way a room is made: drafted in one answer and then refined, or stage by stage. Remembered for each provider."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any, Literal

from ..pipeline.draft.kept import DRAFT_STAGE, is_drafted
from ..pipeline.models.strength import modelling_of
from ..pipeline.stages import all_stages
from ..pipeline.stages.base import Stage
from . import clients, view_state
from .user_files import read_json, write_json

if TYPE_CHECKING:
    from ..pipeline.memory import Entry
    from ..pipeline.models.base import ModelClient
    from ..pipeline.run import Run

Way = Literal["draft", "stages"]
DRAFT = DRAFT_STAGE
_FILE = "ways.json"
_chosen: dict[str, str] = {}
"""What was chosen in this session, by provider."""


def path_of(way: Way) -> tuple[Stage, ...]:
    """The stages of a way, in their order."""
    if way == "stages":
        return all_stages()
    from ..pipeline.stages.s00_draft import STAGE

    return (STAGE, *all_stages())


def path(scene: Any) -> tuple[Stage, ...]:
    """The stages that the panel shows of a scene's room."""
    state = view_state.peek(scene)
    return path_of(state.way if state is not None else "stages")


def provider() -> str:
    """What a choice is remembered for."""
    preferences = clients.add_on_preferences()
    return str(preferences.provider) if preferences is not None else clients.client_settings().kind


def offers_draft(client: ModelClient) -> bool:
    """Whether a client can write a room in one answer: no built-in analysis can, and a recording where it holds one."""
    return client.name != "builtin" and bool(getattr(client, "has_draft", bool(client.name)))


def chosen(client: ModelClient) -> Way:
    """The way that was chosen for the present provider, else the one that suits its model. Reads a small file."""
    if not offers_draft(client):
        return "stages"
    kept = _chosen.get(provider()) or read_json(_file()).get(provider())
    if kept in ("draft", "stages"):
        return "draft" if kept == "draft" else "stages"
    return "draft" if modelling_of(client.name) == "programs" else "stages"


def choose(way: Way) -> None:
    """Remember the artist's choice for the present provider, in this session and in the user's folder."""
    _chosen[provider()] = way
    write_json(_file(), {**read_json(_file()), provider(): way})


def forget() -> None:
    """Forget what was chosen in this session."""
    _chosen.clear()


def _file() -> Any:
    folder = clients.user_folder()
    return folder / _FILE if folder is not None else None


def derived(scene: Any, stages: Sequence[Stage], redo: Collection[str] = ()) -> frozenset[str]:
    """Ids of the stages that are answered from the draft and not asked of the model.

    Args:
        stages: those of a job; redo: ids of those that the artist wants asked.
    """
    state = view_state.peek(scene)
    ids = {stage.id for stage in stages}
    if state is None or not (state.has_draft or DRAFT in ids):
        return frozenset()
    ours = {row.id for row in state.stages if row.by_draft or DRAFT in ids}
    return frozenset((ids & ours) - set(redo) - {DRAFT})


def is_derived(entry: Entry) -> bool:
    """Whether what a stage wrote was answered from a draft."""
    return is_drafted(entry.meta.client)


def deriving(run: Run) -> ModelClient:
    """A client that answers from the draft which the run's memory holds by then, and asks the run's own for what needs eyes."""
    from ..pipeline.draft.client import DraftedClient

    return DraftedClient(run.client, run.memory)
