# SPDX-License-Identifier: GPL-3.0-or-later
"""What a part is made of where no model says it: by its role, its name, and the material words of its description."""

from __future__ import annotations

import functools
import re

from ..artifacts.objects import ObjectDescription
from ..program.prelude.dressing import usual_look
from ..program.prelude.palette import ROLE_COLOURS
from .choice import Choice
from .parts import Cell

# What a family may become by a word. Metal is not made cloth by the word for a cushion beside it.
_KINDS: dict[str, tuple[str, ...]] = {
    "cloth": ("fabric", "linen", "velvet", "knit", "leather", "carpet"),
    "stone": ("stone", "marble", "tile", "concrete", "plaster", "ceramic"),
    "made": ("plastic", "ceramic", "painted_wood"),
}
_WORDS: tuple[tuple[str, str], ...] = (
    ("velvet|velour|chenille", "velvet"), ("leather|suede|leatherette", "leather"),
    ("chunky knit|knit|knitted|crochet", "knit"), ("linen|cotton|percale|satin|muslin|gauze|voile", "linen"),
    ("wool|shag|jute|sisal|pile", "fabric"), ("boucle|bouclé|tweed|fabric|cloth|upholster\\w*|canvas|felt", "fabric"),
    ("rattan|wicker|cane|seagrass|bamboo", "wicker"),
    ("marble", "marble"), ("granite|slate|stone|travertine|terrazzo", "stone"), ("concrete|cement", "concrete"),
    ("ceramic|porcelain|terracotta|clay|enamel|glazed", "ceramic"),
    ("painted|lacquered|lacquer|mdf|laminate", "painted_wood"),
    ("wood|wooden|oak|walnut|pine|beech|ash|birch|teak|mahogany|maple|cherry|veneer|plywood", "wood"),
    ("brass|gold|steel|chrome|metal|iron|aluminium|aluminum|copper|bronze", "metal"),
    ("plastic|acrylic|polycarbonate|vinyl", "plastic"), ("rubber|silicone", "rubber"), ("paper|card|cardboard", "paper"),
)  # fmt: skip
_NAMES = ("oak", "walnut", "pine", "beech", "ash", "birch", "teak", "mahogany", "maple", "cherry", "brass", "chrome",
          "steel", "copper", "bronze", "iron", "terracotta", "porcelain", "wool", "cotton", "rattan", "boucle")  # fmt: skip
_METALS = (("brass|gold\\w*", "C2A14D", "polished"), ("copper", "B4704C", "polished"), ("bronze", "7E6244", "brushed"),
           ("chrome|polished steel", "C6C9CC", "polished"), ("black", "2B2A29", "cast"), ("white", "E4E2DD", "cast"))  # fmt: skip
_BESIDE = frozenset({"frame", "back", "edge", "rim", "stand", "handle", "border", "base", "trim", "leg", "foot"})


def by_name(cell: Cell, category: str) -> str:
    """The family that a part's name or role decides whatever anybody says: glass and mirrors; "" for all others."""
    words = set(re.findall(r"[a-z]+", cell.part.lower()))
    if cell.role in ("mirror", "screen"):
        return {"mirror": "mirror_glass", "screen": "screen"}[cell.role]
    if words & _BESIDE:
        return "glass" if cell.role == "glass" else ""
    of_mirror = "mirror" in category.lower()
    if "mirror" in words or (of_mirror and (cell.role == "glass" or words & {"glass", "pane"})):
        return "mirror_glass"
    return "glass" if cell.role == "glass" or words & {"glass", "glazing", "pane"} else ""


_look_of = functools.lru_cache(maxsize=1024)(usual_look)


def usual(cell: Cell, described: ObjectDescription, category: str, object_family: str, code: str) -> Choice:
    """What a part is made of by role and words.

    Args:
        object_family: of the object's category. code: the part's colour, six sRGB digits, "" for the usual one.
    """
    plain = _look_of(cell.material, object_family) or _look_of(
        f"{cell.role} #{code or 'A9A39B'}".strip(), object_family
    )
    family = plain.name if plain is not None else "plastic"
    options = dict(_options_of(plain.key)) if plain is not None else {}
    veil = re.search(
        r"\b(sheers?|voiles?|veils?)\b",
        f"{phrase_of(cell, described)} {cell.part} {category}".replace("_", " ").lower(),
    )
    if not_lit(cell.role, object_family):
        family, options = "linen", {}
        veil = veil or re.search(r"curtain|drape", category.lower())
    fixed = by_name(cell, category)
    if fixed:
        return Choice(
            fixed, _own(cell, fixed, family, plain.colour if plain else ""), (), why="by its name", source="usual"
        )
    phrase = phrase_of(cell, described)
    said = [f for words, f in _WORDS if re.search(rf"\b({words})\b", phrase)]
    # Of several words the one that the role means stands: oak sides do not become paint by the doors' word.
    # "Fabric" is any cloth, so that other words say more.
    named = "" if family in said and family != "fabric" else next((f for f in said if may_be(family, f)), "")
    if object_family == "rug" and (named or family) in _KINDS["cloth"]:
        named = "carpet"
    if cell.role == "" and not named and said:
        named = said[0]
    if named and named != family:
        family, options = named, {}
    colour = code or (plain.colour if plain is not None else "#A9A39B").lstrip("#")
    if family == "metal":
        colour, options = _metal(cell, phrase, colour, options)
    elif family in ("linen", "fabric") and veil:
        options["sheer"] = "0.5"
    elif family in ("wood", "painted_wood", "plastic") and re.search(r"\b(gloss\w*|lacquered|polished)\b", phrase):
        options["gloss"] = "0.8"
    elif family == "ceramic" and re.search(r"\b(terracotta|clay|unglazed)\b", phrase):
        options["gloss"] = "0.05"
    word = next((w for w in _NAMES if re.search(rf"\b{w}\b", phrase) and _fits(w, family)), "")
    why = f"{family.replace('_', ' ')} by the words of its description" if named else "what such parts usually are"
    return Choice(
        family, colour, tuple(sorted(options.items())), word=word, why=why, source="measured" if code else "usual"
    )


def not_lit(role: str, object_family: str) -> bool:
    """Whether a lamp shade's cloth is what something hangs or lies of that no lamp is in: it lets light through, and gives none."""
    return role == "shade" and object_family == "textile"


def may_be(family: str, other: str) -> bool:
    """Whether a part whose role means one family may be of another."""
    if family == other:
        return True
    if family == "wood":
        return other in ("painted_wood", "wicker")
    return family != "painted_wood" and any(family in group and other in group for group in _KINDS.values())


def phrase_of(cell: Cell, described: ObjectDescription) -> str:
    """The words of a description that speak of a part, else all that it says of materials."""
    phrases = [p.strip().lower() for p in re.split(r"[,;]", f"{described.material},{described.colour}") if p.strip()]
    names = {w.rstrip("s") for w in re.findall(r"[a-z]+", cell.part.lower()) if len(w) > 2}
    about = [p for p in phrases if names & {w.rstrip("s") for w in re.findall(r"[a-z]+", p)}]
    return " , ".join(about or [p.strip().lower() for p in described.material.split(",")])


def _metal(cell: Cell, phrase: str, colour: str, options: dict[str, str]) -> tuple[str, dict[str, str]]:
    """A metal's colour and finish by its words; the colour that a program gives it stays."""
    if cell.role not in ("", "metal"):
        return colour, {"finish": '"brushed"'} if "brushed" in phrase else options
    found = next((m for m in _METALS if re.search(rf"\b({m[0]})\b", phrase)), None)
    if found is None:
        return colour, options
    finish = "brushed" if "brushed" in phrase else found[2]
    return cell.code or found[1], {} if finish == "brushed" else {"finish": f'"{finish}"'}


def _own(cell: Cell, fixed: str, family: str, colour: str) -> str:
    """The colour of glass, mirrors and screens: the program's, else the usual one; never a reflection that was measured."""
    if fixed == "mirror_glass":
        return "E9EEEE"
    if cell.code and fixed == family:
        return cell.code
    return colour.lstrip("#") if fixed == family and colour else ROLE_COLOURS[fixed][0]


def _options_of(key: str) -> list[tuple[str, str]]:
    return re.findall(r"(\w+)=(\"[^\"]*\"|\([^)]*\)|[^,()]+)", key)


def _fits(word: str, family: str) -> bool:
    metals, cloths = ("brass", "chrome", "steel", "copper", "bronze", "iron"), ("wool", "cotton", "boucle")
    if word in metals:
        return family == "metal"
    if word in cloths:
        return family in _KINDS["cloth"]
    if word in ("terracotta", "porcelain"):
        return family == "ceramic"
    return family == "wicker" if word == "rattan" else family == "wood"
