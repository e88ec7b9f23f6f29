# SPDX-License-Identifier: GPL-3.0-or-later
"""The pieces of the report's page: text is escaped here and nowhere else, pictures are embedded, nothing is loaded."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from PIL import Image, UnidentifiedImageError

from .report_style import STYLE

PICTURE_LONG_SIDE = 1400
"""Longest side of an embedded picture, pixels."""
_MOST_EMBEDDED = 350_000
_KINDS = ((b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg"))


@dataclass(frozen=True)
class Markup:
    """HTML that is ready for the page. Everything else is text and is escaped."""

    html: str


Content = Markup | str | int | float | None


def text(value: Content) -> str:
    """A value as HTML: markup as it is, None as nothing, everything else escaped."""
    if isinstance(value, Markup):
        return value.html
    return "" if value is None else html.escape(str(value))


def element(tag: str, *content: Content, of: str = "") -> Markup:
    """An element with an optional class."""
    opening = f'<{tag} class="{html.escape(of)}">' if of else f"<{tag}>"
    return Markup(f"{opening}{''.join(text(c) for c in content)}</{tag}>")


def together(parts: Iterable[Content], between: str = "\n") -> Markup:
    """Several pieces after one another."""
    return Markup(html.escape(between).join(text(p) for p in parts))


@dataclass(frozen=True)
class Column:
    """A table's column; `number` columns are set to the right, `prose` columns may break anywhere."""

    title: str
    number: bool = False
    prose: bool = False

    @property
    def of(self) -> str:
        """The class of its cells."""
        return "number" if self.number else "text" if self.prose else ""


def table(columns: Sequence[Column], rows: Iterable[Sequence[Content]], row_class: Sequence[str] = ()) -> Markup:
    """A table; `row_class` gives a class for each row, "" for none."""
    head = element("tr", *(element("th", c.title, of="number" if c.number else "") for c in columns))
    body = []
    for index, row in enumerate(rows):
        cells = [element("td", value, of=column.of) for column, value in zip(columns, row, strict=True)]
        body.append(element("tr", *cells, of=row_class[index] if index < len(row_class) else ""))
    inside = element("table", element("thead", head), element("tbody", *body))
    return element("div", inside, of="wide")


def bar(value: float) -> Markup:
    """A value 0..1 as a small bar and a number."""
    share = max(0.0, min(1.0, value)) * 100
    return Markup(
        f'<span class="measure"><span class="bar"><i style="width:{share:.0f}%"></i></span>{value:.2f}</span>'
    )


def heading(title: str, anchor: str) -> Markup:
    """A section's heading that the list at the top of the page leads to."""
    return Markup(f'<h2 id="{html.escape(anchor)}">{html.escape(title)}</h2>')


def contents(sections: Iterable[tuple[str, str]]) -> Markup:
    """The list of sections, (anchor, title) each."""
    links = [f'<a href="#{html.escape(anchor)}">{html.escape(title)}</a>' for anchor, title in sections]
    return Markup(f"<nav>{''.join(links)}</nav>")


def swatch(code: str) -> Markup:
    """A small square of a colour of six sRGB digits; an empty one for anything else."""
    known = len(code) == 6 and all(c in "0123456789abcdefABCDEF" for c in code)
    shown = f' style="background:#{code}"' if known else ""
    return Markup(f'<span class="swatch"{shown}></span>')


def folded(title: str, *content: Content) -> Markup:
    """What is seen only when it is asked for."""
    return element("details", element("summary", title), *content)


def figure(data: bytes | None, caption: str) -> Markup | None:
    """An embedded picture with its caption, None when there are no usable bytes."""
    image = picture(data, caption) if data else None
    return element("figure", image, element("figcaption", caption)) if image is not None else None


def picture(data: bytes, about: str, long_side: int = PICTURE_LONG_SIDE) -> Markup | None:
    """An embedded picture alone, None when there are no usable bytes."""
    source = data_uri(data, long_side)
    return Markup(f'<img src="{source}" alt="{html.escape(about)}">') if source else None


def data_uri(data: bytes, long_side: int = PICTURE_LONG_SIDE) -> str:
    """A PNG or JPEG as a data URI, made smaller where it is larger than a report needs; "" when it is neither."""
    kind = next((mime for magic, mime in _KINDS if data.startswith(magic)), "")
    if not kind:
        return ""
    try:
        with Image.open(io.BytesIO(data)) as image:
            if max(image.size) > long_side or len(data) > _MOST_EMBEDDED:
                image.thumbnail((long_side, long_side))
                buffer = io.BytesIO()
                image.convert("RGB").save(buffer, "JPEG", quality=86)
                data, kind = buffer.getvalue(), "image/jpeg"
    except (OSError, UnidentifiedImageError, ValueError):
        return ""
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"


def page(title: str, parts: Iterable[Content]) -> str:
    """The whole page."""
    head = (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        # Nothing is ever loaded or run, even if something slipped through the escaping.
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; img-src data:; '
        "style-src 'unsafe-inline'\">\n"
        f"<title>{html.escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
    )
    return head + together(parts).html + "\n</body>\n</html>\n"
