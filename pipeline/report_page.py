# SPDX-License-Identifier: GPL-3.0-or-later
"""The pieces of the report's page: text is escaped here and nowhere else, pictures are embedded, nothing is loaded."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from PIL import Image, UnidentifiedImageError

PICTURE_LONG_SIDE = 1400
"""Longest side of an embedded picture, pixels."""
_MOST_EMBEDDED = 1_500_000
_KINDS = ((b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg"))


@dataclass(frozen=True)
class Markup:
    """HTML that is ready for the page. Everything else is text and is escaped."""

    html: str


Content = Markup | str | int | float | None

STYLE = """
:root { --ink: #23282e; --soft: #66707b; --line: #dfe3e7; --paper: #fff; --wash: #f5f6f7; --accent: #2f6f8f;
  --good: #2e7d4f; --warn: #9a6a00; --bad: #b3352b; }
* { box-sizing: border-box; }
html { background: var(--wash); }
body { margin: 0 auto; max-width: 1080px; padding: 36px 44px 60px; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
h1 { font-size: 27px; font-weight: 600; line-height: 1.25; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 18px; font-weight: 600; margin: 40px 0 10px; padding-bottom: 5px; border-bottom: 1px solid var(--line); }
h3 { font-size: 15px; font-weight: 600; margin: 20px 0 6px; }
p { margin: 6px 0; max-width: 75ch; }
.lead { color: var(--soft); margin-top: 2px; }
.answered { margin: 16px 0 0; padding: 9px 14px; background: var(--wash); border-left: 3px solid var(--accent);
  max-width: none; }
dl.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); gap: 14px 22px; margin: 22px 0 0; }
dl.facts dt { color: var(--soft); font-size: 13px; }
dl.facts dd { margin: 0; font-size: 17px; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
dl.facts small { display: block; color: var(--soft); font-size: 13px; }
.pictures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 18px; margin-top: 26px; }
figure { margin: 0; }
figure img { display: block; width: 100%; height: auto; max-height: 460px; object-fit: contain; background: var(--wash);
  border: 1px solid var(--line); border-radius: 4px; }
figcaption { color: var(--soft); font-size: 13px; margin-top: 4px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 14px; }
th { text-align: left; font-weight: 600; color: var(--soft); font-size: 13px; vertical-align: bottom; }
th, td { padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.text { overflow-wrap: anywhere; }
th.number, td.number { text-align: right; white-space: nowrap; }
td:first-child { white-space: nowrap; }
tr.sum td { font-weight: 600; border-bottom: 0; }
tr.kept td { background: #eef5f8; }
.chip { display: inline-block; padding: 0 8px; border-radius: 9px; font-size: 12.5px; line-height: 19px;
  background: var(--wash); color: var(--soft); white-space: nowrap; }
.chip.placed { background: #e5f2ea; color: var(--good); } .chip.deferred { background: #fbf1da; color: var(--warn); }
.chip.dropped { background: #f9e4e2; color: var(--bad); }
.bar { display: inline-block; width: 46px; height: 6px; border-radius: 3px; background: var(--line); margin-right: 7px;
  vertical-align: 2px; overflow: hidden; print-color-adjust: exact; }
.bar i { display: block; height: 100%; background: var(--accent); print-color-adjust: exact; }
ul { margin: 4px 0 10px; padding-left: 20px; } li { margin: 2px 0; overflow-wrap: anywhere; }
code { font: 13px ui-monospace, "SF Mono", Consolas, "DejaVu Sans Mono", monospace; }
.error h3 { color: var(--bad); } .warning h3 { color: var(--warn); }
.quiet { color: var(--soft); }
footer { margin-top: 48px; color: var(--soft); font-size: 13px; }
@media (max-width: 720px) { body { padding: 22px 16px; } .pictures { grid-template-columns: 1fr; }
  .wide { overflow-x: auto; } }
@media print { html { background: none; } body { max-width: none; padding: 0; font-size: 11pt; }
  figure img { max-height: 85mm; } h2, h3 { break-after: avoid; } tr, figure, li { break-inside: avoid; }
  .chip, tr.kept td { print-color-adjust: exact; } @page { margin: 16mm; } }
"""


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
    return Markup(f'<span class="bar"><i style="width:{share:.0f}%"></i></span>{value:.2f}')


def figure(data: bytes | None, caption: str) -> Markup | None:
    """An embedded picture with its caption, None when there are no usable bytes."""
    source = data_uri(data) if data else ""
    if not source:
        return None
    image = f'<img src="{source}" alt="{html.escape(caption)}">'
    return element("figure", Markup(image), element("figcaption", caption))


def data_uri(data: bytes) -> str:
    """A PNG or JPEG as a data URI, made smaller where it is larger than a report needs; "" when it is neither."""
    kind = next((mime for magic, mime in _KINDS if data.startswith(magic)), "")
    if not kind:
        return ""
    try:
        with Image.open(io.BytesIO(data)) as image:
            if max(image.size) > PICTURE_LONG_SIDE or len(data) > _MOST_EMBEDDED:
                image.thumbnail((PICTURE_LONG_SIDE, PICTURE_LONG_SIDE))
                buffer = io.BytesIO()
                image.convert("RGB").save(buffer, "JPEG", quality=88)
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
