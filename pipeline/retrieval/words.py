# SPDX-License-Identifier: GPL-3.0-or-later
"""Names as assets have them ("SM_CoffeeTable_02", "Stehlampe", "chair.wood"), as words that can be compared."""

from __future__ import annotations

import functools
import re
import unicodedata

from ..library import catalogue

_WORD = re.compile(r"[^\W\d_]+")
_CAMEL = re.compile(r"(?<=[a-zß-ÿ0-9])(?=[A-ZÀ-Þ])|(?<=[A-ZÀ-Þ])(?=[A-ZÀ-Þ][a-zß-ÿ])")


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_NOISE = _set(
    """sm sk bp prop asset mesh obj object model geo geometry low high mid poly lowpoly highpoly lod hd pbr free new
    final collection col group pack set lib the of with and for in on at to by ver version copy small large big tall
    mini medium tiny huge var variant type style pcs item thing fbx blend"""
)
"""What says nothing of a thing, wherever it stands in a name."""
_MODIFIERS = _set(
    """wood wooden oak pine walnut birch beech teak bamboo metal metallic steel iron brass copper gold golden silver
    chrome aluminium aluminum glass plastic ceramic porcelain clay terracotta stone marble granite concrete leather
    fabric cotton linen wool velvet wicker rattan paper black white grey gray red green blue yellow orange brown beige
    pink purple dark light cream modern classic classical vintage rustic antique contemporary scandinavian industrial
    retro simple basic fancy round square rectangular oval open closed single double left right painted old"""
)
"""What says how a thing is, not what it is, unless nothing else is said."""
_ALIKE: tuple[tuple[str, ...], ...] = (
    ("sofa", "couch", "settee", "loveseat"),
    ("nightstand", "bedside table", "bedside cabinet", "night stand", "night table", "bedside"),
    ("wardrobe", "closet", "armoire", "clothes cabinet"),
    ("dresser", "chest of drawers", "chest drawers", "drawer chest", "commode"),
    ("bookcase", "bookshelf", "book shelf", "book case", "shelving unit"),
    ("cabinet", "cupboard"),
    ("sideboard", "credenza", "buffet"),
    ("tv stand", "television stand", "tv unit", "media console", "tv cabinet"),
    ("television", "tv", "tv set"),
    ("coffee table", "sofa table"),
    ("desk", "writing table", "writing desk", "work table"),
    ("armchair", "arm chair", "easy chair", "lounge chair"),
    ("office chair", "desk chair", "swivel chair", "task chair"),
    ("stool", "barstool"),
    ("ottoman", "pouf", "pouffe", "footstool"),
    ("lamp", "light", "luminaire"),
    ("table lamp", "desk lamp", "bedside lamp", "reading lamp"),
    ("floor lamp", "standing lamp"),
    ("pendant lamp", "pendant", "hanging lamp", "ceiling lamp", "chandelier"),
    ("rug", "carpet", "mat"),
    ("curtain", "drape", "drapery"),
    ("cushion", "pillow", "throw pillow"),
    ("blanket", "throw", "throw blanket", "plaid"),
    ("duvet", "comforter", "quilt", "bedspread"),
    ("plant", "houseplant", "house plant", "potted plant", "pot plant", "indoor plant"),
    ("picture", "painting", "artwork", "wall art", "picture frame", "photo frame", "framed picture", "framed photo",
     "poster", "canvas"),
    ("waste bin", "bin", "trash can", "trash bin", "garbage can", "wastebasket", "waste basket", "rubbish bin"),
    ("cup", "mug", "teacup", "coffee cup", "coffee mug", "tea cup"),
    ("laptop", "notebook computer", "macbook", "laptop computer"),
    ("monitor", "computer screen", "computer monitor", "display"),
    ("phone", "smartphone", "mobile phone", "cell phone", "cellphone", "iphone"),
    ("refrigerator", "fridge"),
    ("stove", "cooker", "range"),
    ("hob", "cooktop"),
    ("sink", "washbasin", "basin", "wash basin"),
    ("toilet", "wc", "lavatory"),
    ("bathtub", "bath", "bath tub", "tub"),
    ("washing machine", "washer", "laundry machine"),
    ("radiator", "heater"),
    ("speaker", "loudspeaker"),
    ("clock", "alarm clock", "desk clock"),
    ("vase", "flower vase"),
    ("basket", "storage basket"),
    ("box", "storage box", "crate"),
    ("book stack", "stack of book", "stack book", "pile of book"),
    ("blind", "roller blind", "venetian blind"),
)  # fmt: skip


def words_of(text: str) -> list[str]:
    """The words of a name or a sentence: small letters, without accents, singular, numbers and noise left out."""
    plain = unicodedata.normalize("NFKC", text)
    plain = _CAMEL.sub(" ", plain)
    plain = "".join(c for c in unicodedata.normalize("NFKD", plain) if not unicodedata.combining(c))
    found = [_singular(word) for word in _WORD.findall(plain.casefold())]
    kept = [word for word in found if word not in _NOISE and (len(word) > 1 or not word.isascii())]
    return kept or [word for word in found if len(word) > 1]


@functools.lru_cache(maxsize=1 << 15)
def concepts_of(text: str) -> tuple[str, ...]:
    """As `words_of`, with synonyms under one name: "Bedside Table" and "night stand" are ("nightstand",)."""
    words, known = words_of(text), _synonyms()
    found: list[str] = []
    at = 0
    while at < len(words):
        length = next((n for n in (3, 2, 1) if tuple(words[at : at + n]) in known and at + n <= len(words)), 0)
        found += known[tuple(words[at : at + length])] if length else (words[at],)
        at += max(1, length)
    return tuple(dict.fromkeys(found))


@functools.lru_cache(maxsize=1 << 14)
def heads_of(concepts: tuple[str, ...]) -> frozenset[str]:
    """What a name is the name of: its last word, and its last that is no colour, material or style."""
    things = [c for c in concepts if c not in _MODIFIERS]
    return frozenset([*concepts[-1:], *things[-1:]])


def is_modifier(concept: str) -> bool:
    """Whether a word says how a thing is."""
    return concept in _MODIFIERS


@functools.lru_cache(maxsize=1)
def things() -> frozenset[str]:
    """Everything that is known to be a thing that stands in rooms: all that the library has a name for."""
    named = [concepts_of(word) for piece in catalogue.pieces().values() for word in piece.words]
    alike = [concepts_of(group[0]) for group in _ALIKE]
    return frozenset(concepts[-1] for concepts in (*named, *alike) if concepts) - _MODIFIERS


@functools.lru_cache(maxsize=1)
def _synonyms() -> dict[tuple[str, ...], tuple[str, ...]]:
    """A phrase's words -> the words of what it is called here."""
    return {tuple(words_of(phrase)): tuple(words_of(group[0])) for group in _ALIKE for phrase in group}


def _singular(word: str) -> str:
    if word.endswith("ves") and len(word) > 4:
        return {"knives": "knife", "gloves": "glove"}.get(word, word[:-3] + "f")
    if word.endswith(("ches", "shes", "xes", "sses")):
        return word[:-2]
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us", "is")) else word
