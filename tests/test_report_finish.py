# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a finished room: looks, images, light and mended faults are told, scores are drawn, and it stays one file."""

from __future__ import annotations

import io
import os
import re
from html.parser import HTMLParser
from pathlib import Path

from code_as_room.operators.report_pictures import fresh_renders
from code_as_room.pipeline.artifacts.analysis import Finding
from code_as_room.pipeline.artifacts.correction import CorrectionReport, Fix
from code_as_room.pipeline.artifacts.layout import Iteration, LayoutProgram, Score
from code_as_room.pipeline.artifacts.light import Brightness, LightPlan
from code_as_room.pipeline.artifacts.materials import Materials, ObjectMaterials, PartMaterial
from code_as_room.pipeline.artifacts.textures import Texture, TextureQuality, Textures
from code_as_room.pipeline.memory import EntryMeta, Memory
from code_as_room.pipeline.report import make_report
from code_as_room.pipeline.report_page import text
from code_as_room.pipeline.report_scores import score_plots
from PIL import Image

META = EntryMeta(time="2026-11-22T10:00:00+00:00", client="builtin", model="builtin")


class Cells(HTMLParser):
    """A page's table rows, its text, and the sources of its pictures."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.said: list[str] = []
        self.sources: list[str] = []
        self.tags: list[str] = []
        self.inside = False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.inside = True
        if tag == "img":
            self.sources.append(dict(attrs)["src"] or "")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self.inside = False

    def handle_data(self, data: str) -> None:
        self.said.append(data)
        if self.inside:
            self.rows[-1][-1] += data

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.said).split())

    def row(self, start: str) -> list[str]:
        return next(row for row in self.rows if row and row[0].startswith(start))


def noise(size: tuple[int, int]) -> bytes:
    """A PNG that no compression makes small."""
    buffer = io.BytesIO()
    Image.frombytes("RGB", size, os.urandom(size[0] * size[1] * 3)).save(buffer, "PNG")
    return buffer.getvalue()


def finished(colour: str = "8A5A3C", why: str = "the picture shows oak") -> Memory:
    """A memory as stages 8 to 10 leave it."""
    memory = Memory("bedroom.png", "0" * 64)
    top = PartMaterial(part="top", role="wood", look="oak_1", colour=colour, why=why, source="model")
    leg = PartMaterial(part="leg", role="steel", look="steel_1", colour="B9BCC0", source="measured")
    materials = Materials(
        objects=[ObjectMaterials(id="desk_1", parts=[top, leg]), ObjectMaterials(id="bed_1", parts=[top])],
        looks={"oak_1": 'wood("#8A5A3C")', "steel_1": 'metal("#B9BCC0")'},
    )
    memory.append("s08_materials", materials, META)
    floor = Texture(
        surface="floor", kind="floor", source="picture", name="floor_1", pixels=(512, 256), size=(2.4, 1.2), tiles=True,
        quality=TextureQuality(seen=0.7, filled=0.1, detail=120),
    )  # fmt: skip
    poster = Texture(surface="poster_1", kind="picture", note="The picture shows too little of it.")
    memory.append("s09_textures", Textures(surfaces=[floor, poster]), META)
    bright = Brightness(about="floor", picture=0.5, before=0.7, after=0.52, places=10)
    memory.append("s10_finish", LightPlan(style="evening", lamps=["lamp_1"], brightness=[bright]), META)
    fixes = [
        Fix(
            kind="overlap",
            id="chair_1",
            other="desk_1",
            before="(1, 2, 0.4)",
            after="(1, 1.9, 0.4)",
            amount=0.1,
            message="Moved.",
        ),
        Fix(
            kind="light",
            id="lamp_light",
            before="energy=9000",
            after="energy=90",
            amount=0.01,
            message="Far too bright.",
        ),
    ]
    left = [Finding(about="bench_1", message="It floats. It is locked, so it was left.")]
    memory.append("s10_finish", CorrectionReport(fixes=fixes, left=left, off=["camera"]), META)
    return memory


def test_looks_are_told_part_by_part_with_who_decided() -> None:
    page = make_report(finished(), {})
    cells = Cells(page)
    assert "wood oak, #8A5A3C, 2 parts" in cells.text and "metal steel, #B9BCC0, 1 part" in cells.text
    parts, decided = cells.row("desk_1")[1:]
    assert "top, wood" in parts and "leg, metal" in parts
    assert "chosen by the model, measured in the picture: the picture shows oak" in decided
    assert page.count('style="background:#8A5A3C"') == 3


def test_textures_tell_their_source_or_why_there_is_none() -> None:
    cells = Cells(make_report(finished(), {"texture/floor_1": noise((64, 32))}))
    assert len(cells.sources) == 1
    assert "taken from the picture" in cells.text and "repeats every 2.40 x 1.20 m, 512 x 256 pixels" in cells.text
    assert "70% of it is seen in the picture, 10% made up" in cells.text
    assert "made material, no image" in cells.text and "The picture shows too little of it." in cells.text


def test_mended_faults_tell_before_and_after_and_what_was_left() -> None:
    cells = Cells(make_report(finished(), {}))
    moved, dimmed = cells.row("chair_1"), cells.row("lamp_light")
    assert moved[1:5] == ["Inside of each other", "(1, 2, 0.4)", "(1, 1.9, 0.4)", "10.0 cm"] and "desk_1" in moved[0]
    assert dimmed[1:5] == ["Strength of a light", "energy=9000", "energy=90", "x 0.01"]
    assert "It is locked, so it was left." in cells.text and "Switched off: camera." in cells.text
    clean = Memory("a.png", "0" * 64)
    clean.append("s10_finish", CorrectionReport(), META)
    assert "nothing had to be mended" in make_report(clean, {})


def test_light_tells_how_bright_the_room_came_out() -> None:
    cells = Cells(make_report(finished(), {}))
    assert cells.row("floor")[1:] == ["0.50", "0.52", "+0.02"]
    assert "evening" in cells.text and "lamp_1" in cells.text


def rounds(*totals: float) -> list[Iteration]:
    measured = {"coverage": 1, "overlap": 1, "bounds": 1, "relations": 0.5, "boxes": 0.8}
    return [Iteration(number=n, program="", score=Score(total=t, measured=t, model=0.7, **measured))
            for n, t in enumerate(totals)]  # fmt: skip


def test_the_plot_rises_with_the_score_and_marks_what_was_kept() -> None:
    drawn = text(score_plots(rounds(0.62, 0.91, 0.84), best=1))
    dots = re.findall(r'<circle class="(dot[^"]*)" cx="([\d.]+)" cy="([\d.]+)"', drawn)
    assert [kept for kept, _, _ in dots] == ["dot", "dot kept", "dot"]
    across, down = [float(x) for _, x, _ in dots], [float(y) for _, _, y in dots]
    assert across == sorted(across) and down[1] < down[2] < down[0]
    assert "0.91, kept" in drawn and all(0 <= y <= 240 for y in down)
    labels = [float(v) for v in re.findall(r'text-anchor="end">(-?[\d.]+)<', drawn)]
    assert min(labels) >= 0 and min(labels) <= 0.62 and 0.91 <= max(labels) <= 1
    assert score_plots(rounds(0.62), best=0) is None


def test_one_round_has_its_numbers_and_no_course() -> None:
    memory = Memory("a.png", "0" * 64)
    memory.append(
        "s03_layout",
        LayoutProgram(text="", stage="s03_layout", score=rounds(0.7)[0].score, iterations=rounds(0.7)),
        META,
    )
    page = make_report(memory, {})
    assert "<svg" not in page and Cells(page).row("1, kept")[1] == "0.70"


def test_many_large_pictures_make_one_file_that_can_be_sent() -> None:
    names = ("reference", "top", "view", "overlay", "render_reference", "render_top", "render_eye_1", "render_eye_2")
    large = noise((2400, 2000))
    page = make_report(finished(), {**dict.fromkeys(names, large), "texture/floor_1": large})
    # Noise is the worst that there is: a picture of a room takes a fifth of it.
    assert len(page) < 5 * 8_000_000 and len(Cells(page).sources) == 9
    assert (
        page.index("rendered as in the picture")
        < page.index("Rendered at eye level")
        < page.index("The room from the side")
    )


def test_what_models_wrote_into_looks_never_becomes_markup() -> None:
    plain = Cells(make_report(finished(), {}))
    hostile = Cells(make_report(finished('";}</style><script>', "<img src=x onerror=alert(1)>"), {}))
    assert [t for t in hostile.tags if t != "span"] == [t for t in plain.tags if t != "span"]
    assert "script" not in hostile.tags and not hostile.sources


def test_renders_of_an_earlier_state_of_the_room_are_not_shown(tmp_path: Path) -> None:
    memory = Memory("a.png", "0" * 64)
    memory.append("s10_finish", LayoutProgram(text="", stage="s10_finish", score=rounds(0.7)[0].score), META)
    for name, time in (("old", 1_700_000_000), ("new", 1_900_000_000)):
        (tmp_path / f"{name}.png").write_bytes(b"")
        os.utime(tmp_path / f"{name}.png", (time, time))
    assert fresh_renders(tmp_path, ["old", "new", "gone"], memory) == {"new": tmp_path / "new.png"}
