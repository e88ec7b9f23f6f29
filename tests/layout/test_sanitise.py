"""What the critic may not do, whatever it says: against evidence, against itself, to the room, to what is locked."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.layout import Layout
from code_as_room.pipeline.artifacts.replies import CritiqueReply
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.layout.initial import Evidence, first_layout
from code_as_room.pipeline.layout.past import Past
from code_as_room.pipeline.layout.revise import revise
from code_as_room.pipeline.layout.sanitise import Sanitised, sanitise


class Critic:
    """A true room, and what becomes of edits in it."""

    def __init__(self, analysis: SceneAnalysis, calibration: Calibration) -> None:
        self.calibration, self.past = calibration, Past()
        self.evidence = Evidence({o.id: o for o in analysis.objects})
        self.layout: Layout = first_layout(analysis, calibration, self.evidence)[0]

    def see(self, identifier: str, **update: Any) -> None:
        """From now on something was detected otherwise."""
        self.evidence = self.evidence.with_object(self.evidence.objects[identifier].model_copy(update=update))

    def asks(self, *edits: dict[str, Any], locked: frozenset[str] = frozenset()) -> Sanitised:
        reply = CritiqueReply.model_validate({"score": 50, "edits": list(edits)})
        return sanitise(reply, self.layout, self.evidence, self.calibration, locked, None, self.past)

    def does(self, *edits: dict[str, Any]) -> Sanitised:
        """Asks, and carries out what is left."""
        wanted = self.asks(*edits)
        self.layout, self.evidence = revise(self.layout, wanted, self.calibration), wanted.evidence
        return wanted

    def box(self, identifier: str, right: float = 0.0, down: float = 0.0) -> dict[str, float]:
        box = self.evidence.box(identifier)
        assert box is not None
        return {k: v + (right if k[0] == "x" else down) for k, v in box.model_dump().items()}

    def seen_at(self, x: float, y: float, size: tuple[float, float, float] = (0.6, 0.6, 0.6)) -> dict[str, float]:
        return image_box_of(self.calibration.camera, (x, y, size[2] / 2), size, 0.0).model_dump()


@pytest.fixture
def critic(analysis: SceneAnalysis, calibration: Calibration) -> Critic:
    return Critic(analysis, calibration)


def refused(wanted: Sanitised) -> str:
    assert not wanted.edits and len(wanted.refused) == 1
    return wanted.refused[0].message


@pytest.mark.parametrize("op", ["move", "remove", "turn", "recategorise", "resize"])
@pytest.mark.parametrize("part", ["wall_n", "room"])
def test_the_room_itself_is_not_the_critics(critic: Critic, op: str, part: str) -> None:
    edit = {"op": op, "id": part, "box": critic.box("bed"), "category": "bed", "yaw_deg": 90}
    assert "part of the room" in refused(critic.asks(edit))


def test_unknown_and_locked_things_stay(critic: Critic) -> None:
    assert "not a proxy" in refused(critic.asks({"op": "turn", "id": "ghost", "yaw_deg": 90}))
    locked = critic.asks({"op": "turn", "id": "chair", "yaw_deg": 220}, locked=frozenset({"chair"}))
    assert "locked" in refused(locked)


def test_what_was_seen_or_carries_something_is_not_removed(critic: Critic) -> None:
    assert "clearly seen" in refused(critic.asks({"op": "remove", "id": "chair"}))
    critic.see("stand", confidence=0.2)
    assert "carries lamp" in refused(critic.asks({"op": "remove", "id": "stand"}))
    critic.see("chair", confidence=0.2)
    assert [e.op for e in critic.asks({"op": "remove", "id": "chair"}).edits] == ["remove"]


def test_a_turn_to_the_wall_or_against_the_picture_is_refused(critic: Critic) -> None:
    assert "face the wall" in refused(critic.asks({"op": "turn", "id": "closet", "facing": "right", "yaw_deg": 90}))
    assert "would not fit" in refused(critic.asks({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 85}))
    turned = critic.asks({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 220})
    assert [e.yaw for e in turned.edits] == [220.0]


def test_two_measurements_that_agree_outvote_a_third_and_a_lone_one_does_not(critic: Critic) -> None:
    far = {"op": "move", "id": "chair", "box": critic.seen_at(1.0, -1.2)}
    assert "neither measurement" in refused(critic.asks(far))
    box = ImageBox(**critic.seen_at(-0.2, -1.2, (0.8, 0.8, 0.8)))
    critic.see("chair", box=box)
    back = critic.asks({"op": "move", "id": "chair", "box": critic.seen_at(-1.6, -1.2, (0.8, 0.8, 0.8))})
    [edit] = back.edits
    assert edit.centre is not None and abs(edit.centre[0] + 1.6) < 0.05, "the critic and the metres against the box"


def test_a_small_correction_counts_as_a_second_reading(critic: Critic) -> None:
    before = critic.evidence.box("bed")
    wanted = critic.asks({"op": "move", "id": "bed", "box": critic.box("bed", right=8.0)})
    after = wanted.evidence.box("bed")
    assert before is not None and after is not None and after.x_min == pytest.approx(before.x_min + 4.0)


def test_a_size_alone_is_enough_to_resize(critic: Critic) -> None:
    size = {"width": 0.8, "depth": 0.8, "height": 1.1}
    [edit] = critic.asks({"op": "resize", "id": "chair", "size_m": size}).edits
    assert edit.size is not None and edit.size[2] > 0.85
    assert "no usable box" in refused(critic.asks({"op": "move", "id": "chair", "size_m": size}))


def test_going_back_and_forth_ends_where_it_is(critic: Critic) -> None:
    assert critic.does({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 220}).edits
    assert "back and forth" in refused(critic.does({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 42}))
    assert "back and forth" in refused(critic.does({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 130}))
    chair = critic.layout.proxy("chair")
    assert chair is not None and chair.yaw == 220.0
    assert critic.does({"op": "recategorise", "id": "chair", "category": "stool"}).edits, "other fields are free"
    assert "back and forth" in refused(critic.does({"op": "recategorise", "id": "chair", "category": "Armchair"}))


def test_a_box_that_returns_to_the_first_place_is_not_followed(critic: Critic) -> None:
    first, second = critic.box("bed"), critic.box("bed", down=60.0)
    assert critic.does({"op": "move", "id": "bed", "box": second}).edits
    assert "back and forth" in refused(critic.does({"op": "move", "id": "bed", "box": first}))


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        ({"category": "armchair", "at": (-1.5, -1.2)}, "already known as chair"),
        ({"category": "crate", "at": (0.2, 0.9)}, "where bed stands"),
        ({"category": "stool", "at": (4.0, -1.2)}, "outside"),
        ({"category": "shelf", "at": (0.8, -1.2), "base_m": 1.4}, "comes later"),
        ({"category": "", "at": (0.8, -1.2)}, "without box, size or category"),
    ],
)
def test_what_is_added_must_be_new_and_have_room(critic: Critic, edit: dict[str, Any], said: str) -> None:
    size = {"width": 0.6, "depth": 0.6, "height": 0.6}
    box = critic.seen_at(*edit.pop("at"))
    message = refused(critic.asks({"op": "add", "id": "new", "box": box, "size_m": size, **edit}))
    assert said in message or (said == "outside" and "box" in message)


def test_what_is_really_missing_is_added_where_it_was_seen(critic: Critic) -> None:
    size = {"width": 0.6, "depth": 0.6, "height": 0.6}
    critic.does({"op": "add", "id": "new", "category": "stool", "box": critic.seen_at(0.8, -1.2), "size_m": size})
    stool = critic.layout.proxy("new")
    assert stool is not None and stool.centre[:2] == pytest.approx((0.8, -1.2), abs=0.03)
    assert "carries" not in refused(critic.does({"op": "remove", "id": "new"})), "adding and removing it is no progress"


def test_the_critic_is_reminded_in_two_short_lines(critic: Critic) -> None:
    wanted = critic.does({"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 220}, {"op": "remove", "id": "bed"})
    assert critic.past.told() == ""
    critic.past.note(wanted.edits, wanted.refused)
    done, not_done = critic.past.told().splitlines()
    assert "turn chair" in done and "bed" in not_done and "clearly seen" in not_done


def test_no_answer_of_any_kind_raises(critic: Critic) -> None:
    wild = {"x_min": -1e9, "y_min": 1e9, "x_max": 1e9, "y_max": -1e9}
    zero = {"width": 0, "depth": -1, "height": 1e9}
    for op in ("move", "resize", "turn", "remove", "recategorise", "add"):
        for identifier in ("bed", "", "x" * 5000, "wall_n", "rug"):
            wanted = critic.asks(
                {"op": op, "id": identifier, "box": wild, "size_m": zero, "yaw_deg": 1e12, "base_m": -1e9}
            )
            assert not [e for e in wanted.edits if e.id == "wall_n"], "walls are nobody's to edit"
            assert {o.id for o in wanted.evidence.objects.values()} >= {"chair"}, "one wild edit costs nothing else"


def test_evidence_of_others_is_left_alone(critic: Critic) -> None:
    wanted = critic.asks({"op": "move", "id": "bed", "box": critic.box("bed", right=8.0)})
    others: list[DetectedObject] = [o for i, o in critic.evidence.objects.items() if i != "bed"]
    assert all(wanted.evidence.objects[o.id] is o for o in others)
