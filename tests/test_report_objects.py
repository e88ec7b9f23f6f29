"""The rows of the list of objects: every detected thing is in it once, under the name that it has now."""

from __future__ import annotations

from code_as_room.pipeline.artifacts.analysis import Calibration, ObjectResidual, SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.corrections import AddedObject, Corrections, ObjectCorrection
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram, LedgerEntry, Score
from code_as_room.pipeline.layout.initial import Evidence, first_layout
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.report_objects import ObjectRow, object_rows

SCORE = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)
NOTHING = Corrections()


def by_id(rows: tuple[ObjectRow, ...]) -> dict[str, ObjectRow]:
    assert len({row.id for row in rows}) == len(rows)
    return {row.id: row for row in rows}


def built(analysis: SceneAnalysis, calibration: Calibration, *ledger: LedgerEntry) -> LayoutProgram:
    """The large furniture, placed."""
    layout, _ = first_layout(analysis, calibration, Evidence({o.id: o for o in analysis.objects}))
    return LayoutProgram(text=print_layout(layout), stage="s04_auxiliary", score=SCORE, ledger=list(ledger))


def test_before_anything_is_placed_everything_is_detected(analysis: SceneAnalysis) -> None:
    rows = object_rows(analysis, analysis, None, None, NOTHING)
    assert [row.id for row in rows] == [o.id for o in analysis.objects]
    assert {row.state for row in rows} == {"detected"} and {row.name for row in rows} == {""}


def test_the_ledger_tells_what_was_put_off_or_dropped_and_why(
    analysis: SceneAnalysis, calibration: Calibration
) -> None:
    ledger = (
        LedgerEntry(id="lamp", category="table lamp", state="deferred", reason="what carries it is not known yet"),
        LedgerEntry(id="art", category="painting", state="dropped", reason="nothing is there"),
        LedgerEntry(id="rug", category="rug", state="placed"),
    )
    rows = by_id(object_rows(analysis, analysis, None, built(analysis, calibration, *ledger), NOTHING))
    assert rows["bed"].state == "placed" and rows["bed"].name == "bed"
    assert rows["lamp"].sentence == "Put off: what carries it is not known yet"
    assert rows["art"].sentence == "Dropped: nothing is there"
    assert rows["rug"].state == "detected", "the ledger is older than the program, in which there is no rug"


def test_what_was_edited_by_hand_is_shown_as_it_stands_now(analysis: SceneAnalysis, calibration: Calibration) -> None:
    edits = [
        LayoutEdit(op="rename", id="chair", new_id="reading_chair", origin="artist"),
        LayoutEdit(op="remove", id="closet", origin="artist"),
        LayoutEdit(op="move", id="bed", centre=(0.5, 0.5, 0.45), origin="parent"),
        LayoutEdit(
            op="add", id="pouf", category="pouf", centre=(1.0, -1.0, 0.2), size=(0.4, 0.4, 0.4), origin="artist"
        ),
    ]
    locked = {"reading_chair", "pouf"}
    rows = by_id(object_rows(analysis, analysis, None, built(analysis, calibration), NOTHING, edits, locked))
    chair = rows["chair"]
    assert (chair.title, chair.state, chair.edited, chair.locked) == ("reading_chair", "placed", True, True)
    assert rows["closet"].sentence == "Dropped: removed by hand"
    assert not rows["bed"].edited, "it only moved along"
    assert rows["pouf"].origin == "later" and rows["pouf"].confidence is None


def test_what_the_artist_said_is_in_the_rows_and_what_is_left_out_keeps_its_place(
    analysis: SceneAnalysis, calibration: Calibration
) -> None:
    box = ImageBox(x_min=10, y_min=10, x_max=60, y_max=60)
    corrections = Corrections(
        objects=[
            ObjectCorrection(id="stand", include=False),
            ObjectCorrection(id="bed", note="faces the window", category="bunk bed"),
        ],
        added=[AddedObject(id="basket", category="basket", box=box)],
    )
    without = analysis.model_copy(update={"objects": [o for o in analysis.objects if o.id != "stand"]})
    fitted = calibration.model_copy(update={"residuals": [ObjectResidual(id="bed", iou=0.6, shift=(0, 0))]})
    rows = object_rows(analysis, without, fitted, None, corrections)
    assert [row.id for row in rows] == [*(o.id for o in analysis.objects), "basket"]
    found = by_id(rows)
    assert found["stand"].state == "left out" and not found["stand"].included
    assert (found["bed"].note, found["bed"].category) == ("faces the window", "bunk bed")
    assert "fair fit" in found["bed"].seen_well
    assert found["basket"].origin == "drawn"


def test_what_was_given_geometry_is_detailed(analysis: SceneAnalysis, calibration: Calibration) -> None:
    program = built(analysis, calibration)
    program = program.model_copy(update={"text": program.text + '\nfurnish("bed", [])\n'})
    rows = by_id(object_rows(analysis, analysis, None, program, NOTHING))
    assert rows["bed"].state == "detailed"
    assert rows["chair"].state != "detailed"
