# SPDX-License-Identifier: GPL-3.0-or-later
"""Which colour a proxy has: one calm colour for each family of categories, so that a picture reads at a glance."""

from __future__ import annotations

# sRGB, as an artist would pick them; later entries lose against earlier ones when a category has words of both.
FAMILY_COLOURS: dict[str, str] = {
    "bed": "7C93B9",
    "seating": "C98B6C",
    "table": "C0A06A",
    "storage": "9482A8",
    "rug": "DCC9A6",
    "textile": "8DB3A4",
    "lamp": "E8C75A",
    "plant": "6F9C5F",
    "wall": "B56A7C",
    "electronics": "5F717B",
    "wet": "79B4C4",
    "decor": "CE86A6",
    "other": "A9A39B",
}

_FAMILY_WORDS: dict[str, str] = {
    "lamp": "lamp light chandelier sconce lantern pendant candle",
    "rug": "rug carpet mat runner",
    "textile": "pillow cushion blanket throw duvet curtain drape sheer towel clothes blind bedding quilt bolster",
    "bed": "bed crib cot bunk mattress daybed headboard",
    "seating": "sofa couch armchair chair stool bench pouf ottoman seat loveseat recliner beanbag chaise settee",
    "storage": "wardrobe closet dresser cabinet shelf shelves bookcase bookshelf drawer drawers chest sideboard "
    "console cupboard rack storage locker trunk basket box bin hanger credenza buffet vanity stand",
    "table": "table desk nightstand counter island workbench bedside",
    "plant": "plant tree flower flowers vase planter cactus bush pot",
    "wall": "mirror picture painting art poster frame clock wall whiteboard blackboard photo",
    "electronics": "tv television monitor computer laptop keyboard speaker screen console printer phone mouse "
    "radiator heater fan piano guitar",
    "wet": "bath bathtub toilet sink shower basin bidet washer fridge refrigerator oven stove hob dishwasher "
    "kitchen microwave tap",
    "decor": "book books decor tray bowl toy toys sculpture cup mug plate bottle dish ball fruit teddy",
}

# Colours of the parts that every room has, and of the two marks on a proxy; the fourth number is opacity.
ROLE_COLOURS: dict[str, tuple[str, float]] = {
    "floor": ("D8CFC3", 1.0),
    "wall": ("F1EEE8", 1.0),
    "partition": ("EAE6DE", 1.0),
    "ceiling": ("F7F5F1", 1.0),
    "section": ("77736E", 1.0),
    "frame": ("FBFAF8", 1.0),
    "door": ("CDB18E", 1.0),
    "metal": ("8C8C8C", 1.0),
    "glass": ("BFDDEA", 0.35),
    "marker": ("57524D", 1.0),
    "wood": ("B58B5E", 1.0),
    "dark wood": ("6F4E37", 1.0),
    "painted": ("F2EFEA", 1.0),
    "fabric": ("B9B4AA", 1.0),
    "accent": ("B5654A", 1.0),
    "linen": ("EFEAE0", 1.0),
    "velvet": ("5C6F7B", 1.0),
    "leather": ("8A5A3C", 1.0),
    "wicker": ("C29A5F", 1.0),
    "steel": ("B9BCC0", 1.0),
    "brass": ("C2A14D", 1.0),
    "mirror": ("DDE6EA", 1.0),
    "screen": ("1D2127", 1.0),
    "stone": ("A7A39C", 1.0),
    "marble": ("E9E7E3", 1.0),
    "tile": ("DDE0DF", 1.0),
    "ceramic": ("F6F5F2", 1.0),
    "plastic": ("E3E1DC", 1.0),
    "rubber": ("2E2E2E", 1.0),
    "paper": ("F5F1E6", 1.0),
    "foliage": ("5E8B4A", 1.0),
    "soil": ("4A3A2C", 1.0),
    "terracotta": ("B9714F", 1.0),
    "shade": ("F3E5C4", 1.0),
    "water": ("9CC6D8", 0.6),
}


def category_family(category: str) -> str:
    """The family of a category: "double bed" is "bed", "table lamp" is "lamp"; "other" when nothing fits.

    The last word that is known decides, since English puts the head noun last; plurals count as singulars.
    """
    words = "".join(c if c.isalnum() else " " for c in category.lower()).split()
    for word in reversed(words):
        singular = word[:-3] + "f" if word.endswith("ves") else word.removesuffix("s")
        for candidate in (word, singular):
            for family, known in _FAMILY_WORDS.items():
                if candidate in known.split():
                    return family
    return "other"


def linear_colour(code: str, opacity: float = 1.0) -> tuple[float, float, float, float]:
    """A six-digit sRGB code as linear RGBA, which is what Blender's colour fields hold (IEC 61966-2-1)."""
    values = [int(code[i : i + 2], 16) / 255 for i in (0, 2, 4)]
    red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values)
    return (red, green, blue, opacity)


def split_role(material: str) -> tuple[str, str]:
    """A material as its role and its own colour as six sRGB digits: "wood #8A5A3C" is ("wood", "8A5A3C"); "" for none."""
    role, mark, code = material.rpartition("#")
    if not mark or len(code) != 6 or not all(c in "0123456789abcdefABCDEF" for c in code):
        return material, ""
    return role.strip(), code.upper()


def coloured_role(role: str, code: str) -> str:
    """The inverse of `split_role`."""
    return f"{role} #{code}".strip() if code else role


def role_colour(role: str, family: str) -> tuple[float, float, float, float]:
    """Linear RGBA of a material role on an object of this family; "" is the family's colour, "front" a darker one.

    A colour of its own ("wood #8A5A3C") counts before the role's.
    """
    role, code = split_role(role)
    if code:
        return linear_colour(code, ROLE_COLOURS[role][1] if role in ROLE_COLOURS else 1.0)
    if role in ROLE_COLOURS:
        return linear_colour(*ROLE_COLOURS[role])
    red, green, blue, opacity = linear_colour(FAMILY_COLOURS.get(family, FAMILY_COLOURS["other"]))
    shade = 0.72 if role == "front" else 1.0
    return (red * shade, green * shade, blue * shade, opacity)
