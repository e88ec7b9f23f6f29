# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's sections on what finishes a room: materials, textures, light, and the faults that were mended."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

from .artifacts.correction import CorrectionReport, FaultKind, Fix
from .artifacts.light import LightPlan
from .artifacts.materials import Materials, MaterialSource, ObjectMaterials, PartMaterial
from .artifacts.textures import Texture, TextureQuality, Textures, TextureSource
from .report_page import Column, Content, Markup, element, folded, picture, swatch, table, together
from .report_words import words

THUMBNAIL = 360
"""Longest side of a texture's picture, pixels."""
TEXTURE = "texture/"
"""Before the names of images among the report's pictures."""
FAULTS: dict[FaultKind, str] = {
    "material": "Without material",
    "picture": "Image missing",
    "light": "Strength of a light",
    "outside": "Outside of the room",
    "blocked": "In the way of a door",
    "overlap": "Inside of each other",
    "support": "Floating or sunken",
    "coincident": "Flickering faces",
    "camera": "Camera",
}
_MOST_LOOKS = 25  # that are seen without asking
_MOVED = ("outside", "blocked", "overlap", "support", "coincident", "camera")
_DECIDED: dict[MaterialSource, str] = {
    "model": "chosen by the model",
    "measured": "measured in the picture",
    "usual": "as such parts usually are",
    "artist": "yours",
    "kept": "kept from before",
}
_TAKEN: dict[TextureSource, str] = {
    "model": "painted by an image model",
    "picture": "taken from the picture",
    "procedural": "made material, no image",
}


# ---- materials ----


def materials_section(materials: Materials | None) -> list[Content]:
    """The room's palette, then every part of every object; [] before stage 8."""
    parts = [part for item in materials.objects for part in item.parts] if materials is not None else []
    if materials is None or not parts:
        return []
    uses = Counter(part.look for part in parts)
    shown = {part.look: part for part in reversed(parts)}
    sources = Counter(part.source for part in parts)
    decided = ", ".join(f"{count} {_DECIDED[source]}" for source, count in sources.most_common())
    cards = [_card(name, materials.looks.get(name, name), shown[name], count) for name, count in uses.most_common()]
    count = len(materials.objects)
    rest = cards[_MOST_LOOKS:]
    return [
        element("p", f"{len(uses)} different looks on {len(parts)} parts. Colours: {decided}."),
        element("div", *cards[:_MOST_LOOKS], of="looks"),
        folded(f"{len(rest)} more looks", element("div", *rest, of="looks")) if rest else None,
        folded(f"Part by part, {count} objects and surfaces", _parts_table(materials)),
    ]


def _card(name: str, expression: str, part: PartMaterial, count: int) -> Markup:
    title = expression.partition("(")[0].replace("_", " ") or name
    own = name.rpartition("_")[0].replace("_", " ") or name
    said = f"{own}, " if own not in ("", title) else ""
    used = f"{said}{'#' + part.colour if part.colour else 'colours of an image'}, {_times(count)}"
    return element("div", swatch(part.colour), element("div", title, element("small", used)), of="look")


def _times(count: int) -> str:
    return "1 part" if count == 1 else f"{count} parts"


def _parts_table(materials: Materials) -> Markup:
    columns = [Column("Object"), Column("Parts", prose=True), Column("Decided by", prose=True)]
    return table(columns, [_parts_row(item, materials.looks) for item in materials.objects])


def _parts_row(item: ObjectMaterials, looks: Mapping[str, str]) -> list[Content]:
    seen: dict[tuple[str, str, str], None] = {}
    for part in item.parts:
        family = looks.get(part.look, part.look).partition("(")[0].replace("_", " ")
        seen[part.part or part.role or "all of it", family, part.colour] = None
    chips = [element("span", swatch(colour), f"{name}, {family}" if family else name) for name, family, colour in seen]
    why = list(dict.fromkeys(p.why for p in item.parts if p.why and p.source in ("model", "artist")))
    sources = ", ".join(dict.fromkeys(_DECIDED[p.source] for p in item.parts))
    return [
        element("code", item.id),
        element("div", *chips, of="parts"),
        f"{sources}: {'; '.join(why[:3])}" if why else sources,
    ]


# ---- textures ----


def textures_section(
    textures: Textures | None, pictures: Mapping[str, bytes], materials: Materials | None = None
) -> list[Content]:
    """A card for each surface that an image could lie on: the image, where it comes from, and why; [] before stage 9.

    Args:
        pictures: the report's pictures; the images are under `TEXTURE` and their names.
        materials: whose colours stand where there is no image.
    """
    if textures is None or not textures.surfaces:
        return []
    images = len(textures.images)
    intro = f"{images} of {len(textures.surfaces)} surfaces that could show an image do."
    cards = [_texture(t, pictures.get(TEXTURE + t.name, b""), _own_colour(t, materials)) for t in textures.surfaces]
    return [element("p", intro), element("div", *cards, of="textures")]


def _own_colour(texture: Texture, materials: Materials | None) -> str:
    """The colour of a surface without an image."""
    made = materials.of(texture.surface) if materials is not None else None
    found = [texture.colour, *(part.colour for part in (made.parts if made is not None else []))]
    return next((code for code in found if re.fullmatch("[0-9a-fA-F]{6}", code)), "")


def _texture(texture: Texture, data: bytes, colour: str) -> Markup:
    shown = picture(data, f"The image on {texture.surface}", THUMBNAIL) if data else None
    empty = f' style="background:#{colour}"' if colour else ""
    where = texture.surface + (f", {texture.part}" if texture.part else "")
    source = _TAKEN[texture.source] + (f" ({texture.model})" if texture.model else "")
    lines = [line for line in (_extent(texture), _quality(texture.quality), texture.note) if line]
    return element(
        "div",
        shown or Markup(f'<div class="none"{empty}></div>'),
        element("p", element("strong", words(where)), " ", element("span", source, of=f"chip {texture.source}")),
        *(element("small", line) for line in lines),
        of="texture",
    )


def _extent(texture: Texture) -> str:
    if not texture.name:
        return ""
    width, depth = texture.size
    tiles = "repeats every" if texture.tiles else "covers"
    return f"{tiles} {width:.2f} x {depth:.2f} m, {texture.pixels[0]} x {texture.pixels[1]} pixels"


def _quality(quality: TextureQuality | None) -> str:
    if quality is None:
        return ""
    said = [f"{quality.seen:.0%} of it is seen in the picture"] if quality.seen < 1 else []
    said += [f"{quality.filled:.0%} made up"] if quality.filled >= 0.005 else []
    said += [f"{quality.detail:.0f} pixels of the picture a metre"] if quality.detail else []
    return ", ".join(said)


# ---- light ----


def light_section(plan: LightPlan | None) -> list[Content]:
    """What lights the room, and whether it came out as bright as the picture; [] before stage 10."""
    if plan is None:
        return []
    facts: list[tuple[str, str, str]] = [
        ("Light", plan.style, "as the model says" if plan.source == "model" else "as measured in the picture")
    ]
    if plan.direction is not None:
        high = f"{plan.elevation:.0f} degrees high" if plan.elevation is not None else ""
        facts.append(("Sun", _compass(plan.direction), high))
    facts.append(("Daylight", f"{plan.warmth:.0f} K", f"through {', '.join(plan.windows)}" if plan.windows else ""))
    if plan.lamps:
        facts.append(("Lamps that are on", str(len(plan.lamps)), ", ".join(plan.lamps)))
    facts.append(("Exposure", f"{plan.exposure:+.2f} stops", ""))
    listed = [
        element("div", element("dt", k), element("dd", v, element("small", s) if s else None)) for k, v, s in facts
    ]
    parts: list[Content] = [element("dl", *listed, of="facts")]
    if plan.brightness:
        columns = [
            Column("Brightness on the screen"),
            *(Column(t, number=True) for t in ("Picture", "Room", "Difference")),
        ]
        rows: list[list[Content]] = [
            [b.about, f"{b.picture:.2f}", f"{b.after:.2f}", f"{round(b.after - b.picture, 2) + 0.0:+.2f}"]
            for b in plan.brightness
        ]
        parts += [element("p"), table(columns, rows)]
    return parts


def _compass(degrees: float) -> str:
    """Where something stands, as the picture shows it."""
    sides = ("right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right")
    return f"from the {sides[round(degrees / 45) % 8]}"


# ---- faults ----


def fixes_section(report: CorrectionReport | None) -> list[Content]:
    """Each fault that was mended with before and after, then what was left and why; [] where nobody looked."""
    if report is None:
        return []
    parts: list[Content] = []
    if report.fixes:
        count = "1 fault was" if len(report.fixes) == 1 else f"{len(report.fixes)} faults were"
        parts.append(element("p", f"{count} found in the finished room and mended with the least change."))
        columns = [Column("What"), Column("Fault"), Column("Before", prose=True), Column("After", prose=True)]
        columns += [Column("Change", number=True), Column("Why", prose=True)]
        parts.append(table(columns, [_fix(fix) for fix in report.fixes]))
    else:
        parts.append(element("p", "The finished room was looked through for faults, and nothing had to be mended."))
    if report.off:
        off = ", ".join(FAULTS[kind].lower() for kind in report.off)
        parts.append(element("p", f"Switched off: {off}.", of="quiet"))
    if report.left:
        items = [element("li", element("code", f.about), " ", f.message) for f in report.left]
        title = f"Left as it is ({len(items)})"
        parts.append(element("section", element("h3", title), element("ul", *items), of="warning"))
    return parts


def _fix(fix: Fix) -> list[Content]:
    about: Content = element("code", fix.id)
    if fix.other and fix.other != fix.before:
        about = together([about, element("div", f"and {fix.other}", of="quiet")], "")
    return [
        about,
        FAULTS[fix.kind],
        element("code", fix.before or "nothing"),
        element("code", fix.after),
        _change(fix),
        fix.message,
    ]


def _change(fix: Fix) -> str:
    if fix.kind in _MOVED:
        return f"{fix.amount * 100:.1f} cm" if fix.amount < 1 else f"{fix.amount:.2f} m"
    return f"x {fix.amount:.3g}" if fix.kind == "light" else ""
