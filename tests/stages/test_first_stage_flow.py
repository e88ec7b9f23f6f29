"""Stage 1 fits before it looks again, asks about what contradicts itself, and can be run without parts of it."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.picture import ReferencePicture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

ANALYSIS = all_stages()[0]


def run_with(picture: ReferencePicture, answers: Any, scene: Any, **settings: str) -> Run:
    run = Run(picture, Memory(settings=settings), answers, scene)
    run.run_all([ANALYSIS])
    return run


def narrow_bed(answers: Any) -> None:
    bed = answers.by_key["01_analysis"]["objects"][0]
    bed["size_m"]["width"] = 1.0


def test_a_contradiction_is_asked_about_and_the_answer_taken(
    picture: ReferencePicture, answers: Any, scene: Any
) -> None:
    narrow_bed(answers)
    fix = {"id": "bed", "size_m": {"width": 1.71, "depth": 2.1, "height": 0.9}}
    answers.by_key["01_second_look"] = {"missed": [], "corrections": [fix]}
    run = run_with(picture, answers, scene)
    second = next(p for p in answers.asked if p.key == "01_second_look")
    assert "- bed: by its box it is 1.7" in second.text and "by its metres 1.00 m" in second.text
    bed = run.memory.latest(SceneAnalysis).objects[0]
    assert bed.size[0] == pytest.approx(1.71, rel=0.03)


def test_without_a_second_look_one_question_is_asked(picture: ReferencePicture, answers: Any, scene: Any) -> None:
    run_with(picture, answers, scene, second_look="off")
    assert [p.key for p in answers.asked] == ["01_analysis"]


def test_without_calibration_the_stated_room_is_taken(picture: ReferencePicture, answers: Any, scene: Any) -> None:
    answers.by_key["01_analysis"]["room_width_m"] = 6.0
    run = run_with(picture, answers, scene, calibration="off")
    assert run.memory.latest(SceneAnalysis).room_size[:2] == pytest.approx((6.0, 3.9))


@pytest.mark.parametrize("sources", ["metres", "boxes"])
def test_placements_can_be_made_from_one_source(
    picture: ReferencePicture, answers: Any, scene: Any, sources: str
) -> None:
    run = run_with(picture, answers, scene, evidence=sources)
    trust = run.memory.latest(Calibration).trust
    assert trust is not None and trust.evidence == sources


def test_what_was_learnt_is_kept_with_the_calibration(picture: ReferencePicture, answers: Any, scene: Any) -> None:
    run = run_with(picture, answers, scene)
    trust = run.memory.latest(Calibration).trust
    assert trust is not None and trust.objects == 6 and trust.box_sigma < 5
    run.memory.settings["evidence"] = "boxes"
    assert run.status(ANALYSIS) == "stale"


def test_a_picture_from_the_side_is_refused_before_it_is_looked_at_again(
    picture: ReferencePicture, answers: Any, scene: Any
) -> None:
    sliver = [{"x": 100, "y": 520}, {"x": 900, "y": 520}, {"x": 900, "y": 490}, {"x": 100, "y": 490}]
    answers.by_key["01_analysis"] |= {"floor_polygon": sliver, "wall_top_polygon": None}
    with pytest.raises(RoomError):
        run_with(picture, answers, scene)
    assert [p.key for p in answers.asked] == ["01_analysis"]
