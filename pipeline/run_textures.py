# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist says of where images come from: an order for all surfaces, and a source for single ones."""

from __future__ import annotations

from collections.abc import Sequence

from .artifacts.textures import SOURCES, TextureChoice, TextureChoices, Textures, TextureSource
from .memory import EntryMeta, Memory, now
from .run_corrections import ARTIST


def choices_of(memory: Memory) -> TextureChoices:
    """What the artist says by now."""
    return memory.latest(TextureChoices) or TextureChoices()


def choose_source(memory: Memory, surface: str, source: TextureSource | None) -> bool:
    """Note the source of one surface, None for the best there is; False when that was said already."""
    before = choices_of(memory)
    others = [c for c in before.surfaces if c.surface != surface]
    chosen = [] if source is None else [TextureChoice(surface=surface, source=source)]
    return _note(memory, before.model_copy(update={"surfaces": [*others, *chosen]}))


def prefer(memory: Memory, first: Sequence[TextureSource]) -> bool:
    """Note the order for all surfaces; single surfaces keep what was chosen for them."""
    return _note(memory, choices_of(memory).model_copy(update={"first": list(first)}))


def _note(memory: Memory, choices: TextureChoices) -> bool:
    before = choices_of(memory)
    if _said(before) == _said(choices):
        return False
    memory.append(ARTIST, choices, EntryMeta(time=now(), model=ARTIST))
    return True


def _said(choices: TextureChoices) -> tuple[list[TextureSource], dict[str, TextureSource | None]]:
    return choices.first, {c.surface: c.source for c in choices.surfaces}


def changed_since(memory: Memory) -> frozenset[str]:
    """The surfaces that the artist wants from another source, since their images were made."""
    made = next((n for n in reversed(range(len(memory.entries))) if memory.entries[n].type == Textures.__name__), None)
    if made is None:
        return frozenset()
    earlier = next((e for e in reversed(memory.entries[:made]) if e.type == TextureChoices.__name__), None)
    before = TextureChoices() if earlier is None else TextureChoices.model_validate(earlier.output)
    after, textures = choices_of(memory), Textures.model_validate(memory.entries[made].output)
    orders = [(t, before.order(t.surface), after.order(t.surface)) for t in textures.surfaces]
    return frozenset(t.surface for t, then, wanted in orders if then != wanted and wanted[0] != t.source)


ORDERS: dict[str, tuple[TextureSource, ...]] = {
    "MODEL_FIRST": SOURCES,
    "PICTURE_FIRST": ("picture", "model", "procedural"),
    "PICTURE_ONLY": ("picture", "procedural"),
    "MODEL_ONLY": ("model", "procedural"),
    "MADE": ("procedural",),
}
"""The orders that the panel offers."""


def order_name(choices: TextureChoices) -> str:
    """Which of `ORDERS` the artist's order is, "" for another one."""
    wanted = tuple(dict.fromkeys(choices.first))
    wanted = wanted[: wanted.index("procedural") + 1] if "procedural" in wanted else (*wanted, "procedural")
    return next((name for name, order in ORDERS.items() if order == wanted), "")
