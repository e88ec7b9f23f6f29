# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: nothing is lost, nothing is run or loaded, whatever stands in memory."""

from __future__ import annotations

import base64
import io
import re
from html.parser import HTMLParser

from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint
from code_as_room.pipeline.artifacts.layout import (
    Iteration,
    Layout,
    LayoutEdit,
    LayoutProgram,
    LedgerEntry,
    ProxyLine,
    RoomLine,
    Score,
)
from code_as_room.pipeline.memory import EntryMeta, Memory
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.report import make_report
from code_as_room.pipeline.run import StageReport
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

FLOOR = [(-2.0, -1.5), (2.0, -1.5), (2.0, 1.5), (-2.0, 1.5)]
MATRIX = (1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 6.0, 0, 0, 0, 1.0)
VOID = {"meta", "img", "br", "hr", "link"}


class Page(HTMLParser):
    """Reads a page: its text, its tags, and whether the tags are balanced."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.said: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.rows: list[list[str]] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" in self.open:
            return
        self.said.append(data)
        if any(tag in self.open for tag in ("td", "th")):
            self.rows[-1][-1] += data

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.said).split())

    def row(self, start: str) -> list[str]:
        return next(row for row in self.rows if row and row[0].startswith(start))


def png(colour: str = "red", size: tuple[int, int] = (40, 30)) -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", size, colour).save(buffer, "PNG")
    return buffer.getvalue()


def detected(name: str, category: str = "double_bed") -> DetectedObject:
    box = ImageBox(x_min=100, y_min=100, x_max=300, y_max=300)
    return DetectedObject(id=name, category=category, box=box, centre=(0, 0, 0.3), size=(1.6, 2.0, 0.6))


def score(total: float, boxes: float = 0.8) -> Score:
    return Score(total=total, measured=total, coverage=1, overlap=1, bounds=1, relations=0.5, boxes=boxes, model=0.7)


def room(message: str = "It was moved.", remarks: str = "The bed is too far left.") -> Memory:
    """A memory as four stages leave it: three objects, one placed, one deferred, one dropped, two rounds."""
    corners = [ImagePoint(x=x, y=y) for x, y in ((100, 900), (900, 900), (900, 100), (100, 100))]
    camera = CameraModel(kind="perspective", matrix=MATRIX, fov_y=0.8, image_size=(800, 600))
    finding = Finding(about="bed_1", message=message, severity="warning")
    analysis = SceneAnalysis(
        image_size=(800, 600), view="perspective", room_size=(4, 3, 2.6), floor=FLOOR, floor_polygon=corners,
        objects=[detected("bed_1"), detected("lamp_1", "lamp"), detected("ghost_1", "vase")], findings=[finding],
    )  # fmt: skip
    calibration = Calibration(camera=camera, floor=FLOOR, height=2.5, error_px=1.25, scale_source="known width")
    proxy = ProxyLine(id="bed_1", category="double_bed", centre=(0.5, 0.25, 0.3), size=(1.6, 2.0, 0.6))
    text = print_layout(Layout(room=RoomLine(size=(4, 3, 2.5), floor=FLOOR), proxies=[proxy]))
    edit = LayoutEdit(op="move", id="bed_1", centre=(0.5, 0.25, 0.3), reason="it stands further right")
    refused = Finding(about="lamp_1", message="The critic wants to remove it, but it was clearly seen.")
    rounds = [
        Iteration(number=0, program=text, score=score(0.8), edits=[edit], refused=[refused], remarks=remarks),
        Iteration(number=1, program=text, score=score(0.91)),
    ]
    ledger = [
        LedgerEntry(id="bed_1", category="double_bed", state="placed"),
        LedgerEntry(id="lamp_1", category="lamp", state="deferred", reason="what carries it is not known yet"),
        LedgerEntry(id="ghost_1", category="vase", state="dropped", reason="the second look saw nothing there"),
    ]
    memory = Memory("bedroom.png", "0" * 64)
    meta = EntryMeta(time="2026-11-22T10:00:00+00:00", client="builtin", model="builtin", seconds=2.5)
    memory.keep_answer("s01_analysis", "01_analysis", "{}", meta)
    memory.append("s01_analysis", analysis, meta)
    memory.append("s01_analysis", calibration, meta)
    first = LayoutProgram(text=text, stage="s03_layout", score=score(0.91), best=1, iterations=rounds)
    memory.append("s03_layout", first, meta)
    last = LayoutProgram(text=text, stage="s04_auxiliary", score=score(0.91), best=1, ledger=ledger)
    memory.append("s04_auxiliary", last, meta)
    return memory


def test_every_detected_object_is_told_with_its_state_and_reason() -> None:
    page = Page(make_report(room(), {}))
    assert page.row("bed_1")[1:4] == ["double bed", "floor", "placed"]
    assert "deferred" in page.row("lamp_1") and "what carries it is not known yet" in page.row("lamp_1")
    assert "dropped" in page.row("ghost_1") and "the second look saw nothing there" in page.row("ghost_1")


def test_rounds_tell_scores_edits_and_refusals_and_which_was_kept() -> None:
    page = Page(make_report(room(), {}))
    assert page.row("2, kept")[1] == "0.91"
    assert page.row("1")[1] == "0.80"
    assert "moved to 0.50, 0.25, 0.30 m: it stands further right" in page.text
    assert "clearly seen. (refused)" in page.text
    assert "The bed is too far left." in page.text


def test_room_size_scale_and_camera_are_told() -> None:
    text = Page(make_report(room(), {})).text
    assert "4.00 x 3.00 x 2.50 m" in text
    assert "from the width that you gave" in text
    assert "corners fit within 1.2 px" in text


def test_says_what_answered() -> None:
    assert "No model: the built-in picture analysis" in make_report(
        room(), {}, (), "No model: the built-in picture analysis"
    )
    mixed = room()
    meta = EntryMeta(
        time="2026-11-22T10:00:00+00:00", client="openai:big-1", model="big-1", cost=0.25, prompt_tokens=900
    )
    mixed.keep_answer("s03_layout", "03_critique/0", "{}", meta)
    text = Page(make_report(mixed, {}, (), "big-1 at example.com")).text
    assert "the built-in picture analysis, no model; openai:big-1 (big-1)" in text
    assert "$0.2500" in text and "0.2500 US dollars" in text


def test_stages_of_this_run_tell_their_own_work_and_prompt_text() -> None:
    report = StageReport("s01_analysis", 12.0, 3.5, 2, 5400, 4100, ("the answer was cut",))
    row = Page(make_report(room(), {}, [report])).row("Scene analysis")
    assert row[1:4] == ["2.5 s", "3.5 s", "1"]
    assert row[7] == "5.4 kB"
    assert "the answer was cut" in row[8]


def test_pictures_are_inside_and_nothing_is_loaded() -> None:
    pictures = {"reference": png(), "top": png("blue", (3000, 2000)), "overlay": b"not a picture"}
    text = make_report(room(), pictures)
    sources = [attrs["src"] or "" for tag, attrs in Page(text).tags if tag == "img"]
    assert len(sources) == 2
    sizes = []
    for source in sources:
        kind, data = re.fullmatch(r"data:image/(png|jpeg);base64,(.*)", source).groups()  # type: ignore[union-attr]
        with Image.open(io.BytesIO(base64.b64decode(data))) as image:
            assert image.format == kind.upper()
            sizes.append(max(image.size))
    assert sizes == [40, 1400]
    tags = {tag for tag, _ in Page(text).tags}
    assert not tags & {"script", "link", "iframe", "object", "embed"}
    assert "http://" not in text and "https://" not in text and "url(" not in text


def test_an_empty_memory_makes_a_page_too() -> None:
    page = Page(make_report(Memory(), {}))
    assert page.open == []
    assert "nothing has answered yet" in page.text
    assert page.row("Scene analysis")[-1] == "not run"


HOSTILE = st.text(st.sampled_from("<>&\"'/=;-! scriptonerrorimg\n\x0b\u202e"), max_size=60)


@settings(max_examples=25, deadline=None)
@given(HOSTILE, HOSTILE, HOSTILE)
def test_text_of_models_and_files_never_becomes_markup(name: str, message: str, remarks: str) -> None:
    memory = room(f"<script>{message}</script>", f'"><img src=x onerror={remarks}>')
    memory.picture_name = f"</title><b>{name}"
    page = Page(make_report(memory, {}, (), f"<i>{name}"))
    plain = Page(make_report(room(), {}, (), "x"))
    assert [tag for tag, _ in page.tags] == [tag for tag, _ in plain.tags]
    assert page.open == []
