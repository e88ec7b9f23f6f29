"""The stand-in for weaker models: honest at no noise, steady, worse the stronger it is, and never the end of a run."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.artifacts.replies import AnalysisReply, SecondLookReply
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.recorded import RecordedClient, load_replies

from benchmark.draws import Draws
from benchmark.known import Known
from benchmark.metrics import Room, load_truth, mean, room_from_reply, room_of, score
from benchmark.noise import noised_analysis, turned_words
from benchmark.noisy_client import NoisyClient
from benchmark.noisy_look import second_look
from benchmark.seen import Seen
from benchmark.strengths import MEDIUM, NONE, STRENGTHS, STRONG, Strength
from benchmark.variants import Recording, load_recording, run_variant, write_run

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
FALLING = ("object_recall", "layout_iou", "footprint_iou", "rotation_all", "support_all", "relations_all")


@pytest.fixture(scope="module")
def recording() -> Recording:
    return load_recording(SAMPLE / "picture.png", SAMPLE / "replies")


@pytest.fixture(scope="module")
def truth() -> Room:
    return load_truth(SAMPLE / "truth.json")


def first(seen: Seen, strength: Strength, seed: int) -> AnalysisReply:
    return noised_analysis(seen.first, strength, Draws(seed)).reply


def prompt(schema: str, key: str, stage: str = "s01_analysis") -> Prompt:
    return Prompt(stage=stage, key=key, text="", images=(), schema_name=schema, schema={}, hash="")


def test_without_noise_the_first_answer_is_the_recorded_one(recording: Recording) -> None:
    assert first(recording.seen, NONE, 5) == recording.seen.first


def test_without_noise_recorded_requests_are_answered_as_recorded(recording: Recording) -> None:
    client = NoisyClient(recording.folder, recording.seen, NONE, 0, lambda: None)
    recorded = RecordedClient(recording.folder)
    for schema, key in (("AnalysisReply", "01_analysis"), ("SecondLookReply", "01_second_look")):
        asked, cancel = prompt(schema, key), threading.Event()
        assert client.answer(asked, cancel).text == recorded.answer(asked, cancel).text
    assert not client.simulated


def test_without_noise_a_simulated_second_look_says_what_the_recorded_one_did_and_nothing_else(
    recording: Recording,
) -> None:
    recorded = SecondLookReply.model_validate(load_replies(recording.folder)["s01_analysis/01_second_look"]["reply"])
    said = second_look(Known(recording.seen, NONE, 0), "")
    assert not said.missed
    assert {fix.id for fix in said.corrections} <= {fix.id for fix in recorded.corrections}


def test_the_same_seed_gives_the_same_answers_and_another_seed_others(recording: Recording) -> None:
    assert first(recording.seen, MEDIUM, 4) == first(recording.seen, MEDIUM, 4)
    assert first(recording.seen, MEDIUM, 4) != first(recording.seen, MEDIUM, 5)
    looks = [second_look(Known(recording.seen, STRONG, seed), "") for seed in (4, 4, 5)]
    assert looks[0] == looks[1] != looks[2]


def test_the_stronger_the_noise_the_worse_the_direct_answer_in_every_figure(recording: Recording, truth: Room) -> None:
    means = []
    for strength in (NONE, *STRENGTHS):
        rooms = [room_from_reply(first(recording.seen, strength, seed)) for seed in range(6)]
        means.append(mean([score(truth, room) for room in rooms]))
    for name in FALLING:
        values = [figures[name] or 0.0 for figures in means]
        assert values == sorted(values, reverse=True) and values[0] > values[-1] + 0.1, (name, values)


def test_what_is_overlooked_stays_overlooked_in_stronger_noise_and_small_things_go_first(recording: Recording) -> None:
    lost_large, lost_small = 0, 0
    for seed in range(20):
        kept = [set(noised_analysis(recording.seen.first, s, Draws(seed)).ids) for s in STRENGTHS]
        assert kept[0] >= kept[1] >= kept[2]
        lost_large += sum(name not in kept[2] for name in ("bed_1", "rug_1", "wardrobe_1", "duvet_1"))
        lost_small += sum(name not in kept[2] for name in ("table_lamp_1", "table_lamp_2", "cushion_1", "plant_2"))
    assert lost_small > 2 * lost_large


def test_the_second_look_finds_part_of_what_was_overlooked_under_ids_of_its_own(recording: Recording) -> None:
    overlooked, found = 0, 0
    for seed in range(10):
        known = Known(recording.seen, MEDIUM, seed)
        reply = second_look(known, "")
        listed = {o.id for o in known.first.reply.objects}
        assert not listed & {m.id for m in reply.missed}
        assert all(
            m.parent is None or m.parent in {*known.true, "left", "right", "top", "bottom"} for m in reply.missed
        )
        overlooked += len(recording.seen.objects) - len(known.first.ids)
        found += len(reply.missed)
    assert 0.4 * overlooked < found < 0.9 * overlooked


def test_a_second_look_answers_in_the_metres_of_the_room_that_it_is_told(recording: Recording) -> None:
    known = next(k for s in range(9) if second_look(k := Known(recording.seen, STRONG, s), "").missed)
    own = known.first.reply
    told = f"(room {2 * own.room_width_m:.4f} x {2 * own.room_depth_m:.4f} m)"
    for here, there in zip(second_look(known, "").missed, second_look(known, told).missed, strict=True):
        assert there.centre_m.x_m == pytest.approx(2 * here.centre_m.x_m, rel=1e-3)
        assert there.size_m.width == pytest.approx(2 * here.size_m.width, rel=1e-3)
        assert there.size_m.height == here.size_m.height and there.box == here.box


def test_the_words_for_a_front_turn_with_it() -> None:
    assert turned_words("headboard at the top left", 1) == "headboard at the left bottom"
    assert turned_words("headboard at the top", 2) == "headboard at the bottom"
    assert turned_words("screen, right", 0) == "screen, right"


def test_what_the_second_look_had_added_is_known_in_the_whole_pictures_coordinates(tmp_path: Path) -> None:
    """The last thing of the first answer is moved into the second look, with its box in an enlarged part."""
    data = json.loads((SAMPLE / "replies" / "replies.json").read_text(encoding="utf-8"))
    objects = data["replies"]["s01_analysis/01_analysis"]["reply"]["objects"]
    mirror = next(o for o in objects if o["id"] == "mirror_1")
    objects.remove(mirror)
    missed = {**mirror, "picture": 2, "box": {"x_min": 100, "y_min": 200, "x_max": 300, "y_max": 500}}
    data["replies"]["s01_analysis/01_second_look"]["reply"] = {"missed": [missed], "corrections": []}
    (tmp_path / "replies.json").write_text(json.dumps(data), encoding="utf-8")
    seen = load_recording(SAMPLE / "picture.png", tmp_path).seen
    assert "mirror_1" not in {o.id for o in seen.first.objects}
    box = seen.objects["mirror_1"].box
    assert 50 < box.x_min < 200 and 50 < box.x_max - box.x_min < 150, box


def test_a_request_of_a_kind_that_nobody_can_answer_is_said_so(recording: Recording) -> None:
    client = NoisyClient(recording.folder, recording.seen, MEDIUM, 0, lambda: None)
    with pytest.raises(ModelError, match="no answer"):
        client.answer(prompt("PoemReply", "09_poem"), threading.Event())


@pytest.mark.parametrize(("seed", "which"), [(0, 0), (1, 1), (2, 2), (3, 1), (0, 2)])
def test_no_noise_ends_a_run_and_the_method_recovers_what_it_can(
    recording: Recording, truth: Room, seed: int, which: int, tmp_path: Path
) -> None:
    strength = STRENGTHS[which]
    outcome = run_variant(recording, {"rounds": "2"}, strength, seed)
    program = outcome.memory.latest(LayoutProgram)
    assert program is not None and program.stage == "s04_auxiliary"
    figures = score(truth, room_of(outcome.document.model_dump(mode="json"), outcome.shapes))
    direct = score(truth, room_from_reply(first(recording.seen, strength, seed)))
    assert (figures["object_recall"] or 0) >= (direct["object_recall"] or 0) - 0.05
    assert (figures["self_overlap"] or 0) < 0.05
    write_run(outcome, tmp_path)
    assert json.loads((tmp_path / "scene.json").read_text(encoding="utf-8"))["objects"]


def test_a_stand_in_that_mends_everything_brings_the_room_back(recording: Recording, truth: Room) -> None:
    """The errors are those of the first answer alone: whoever corrects all of them is as good as the recording."""
    sharp = replace(MEDIUM, zoom=0.0, found=1.0, mend=1.0, harm=0.0, reading=0.0, grid=0.0, corner=0.0, tops_lost=0.0)
    figures, dull = (
        score(truth, room_of(run_variant(recording, {"rounds": "2"}, s, 2).document.model_dump(mode="json")))
        for s in (sharp, MEDIUM)
    )
    assert (figures["object_recall"] or 0) > 0.9
    assert (figures["footprint_iou"] or 0) > (dull["footprint_iou"] or 0)
