# SPDX-License-Identifier: GPL-3.0-or-later
"""Safe corrections and the validation that follows them."""

import copy
import json
from typing import Literal

import pytest
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint, Metres3
from code_as_room.pipeline.errors import CutReplyError, ReplyError
from code_as_room.pipeline.models.repair import repair_reply
from code_as_room.pipeline.models.validate import validate_reply
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict


class Thing(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    id: str
    kind: Literal["floor_lamp", "bed"]
    size: Metres3
    box: ImageBox | None
    parent: str | None = None
    yaw: float = 0.0
    count: int = 1
    fixed: bool = False


class Answer(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    things: list[Thing]
    corners: list[ImagePoint] = []


GOOD = {"id": "a", "kind": "bed", "size": [1.0, 2.0, 0.5], "box": None}


def thing(**changes):
    return {"things": [{**GOOD, **changes}]}


REPAIRED = [
    (thing(yaw="90"), {"yaw": 90.0}),
    (thing(yaw="-45.5 deg"), {"yaw": -45.5}),
    (thing(size=["1.5 m", "2", 0.5]), {"size": (1.5, 2.0, 0.5)}),
    (thing(size={"x": 1, "y": 2, "z": 3}), {"size": (1.0, 2.0, 3.0)}),
    (thing(kind="Floor Lamp"), {"kind": "floor_lamp"}),
    (thing(kind="floor-lamp"), {"kind": "floor_lamp"}),
    (thing(parent="none"), {"parent": None}),
    (thing(parent=""), {"parent": None}),
    (thing(yaw=None, count=None), {"yaw": 0.0, "count": 1}),
    (thing(id=12), {"id": "12"}),
    (thing(count="3"), {"count": 3}),
    (thing(fixed="Yes"), {"fixed": True}),
    (thing(reasoning="it looks so"), {"id": "a"}),
    (thing(box={"xMin": 1, "Y_min": 2, "x max": 3, "y-max": 4}), {"box": ImageBox(x_min=1, y_min=2, x_max=3, y_max=4)}),
    ({"things": [{k: v for k, v in GOOD.items() if k != "box"}]}, {"box": None}),
    ({"things": GOOD}, {"id": "a"}),
    ({"things": {"bed_7": {k: v for k, v in GOOD.items() if k != "id"}}}, {"id": "bed_7"}),
    ([GOOD], {"id": "a"}),
    ({"answer": {"things": [GOOD]}}, {"id": "a"}),
    ({"Things": [GOOD, None]}, {"id": "a"}),
]


@pytest.mark.parametrize("data, expected", REPAIRED)
def test_what_has_one_reading_is_corrected_and_reported(data, expected):
    before = copy.deepcopy(data)
    reply, notes = validate_reply(json.dumps(data), Answer)
    assert {name: getattr(reply.things[0], name) for name in expected} == expected
    assert len(reply.things) == 1
    assert notes
    assert data == before


def test_points_given_as_pairs_are_read():
    reply, _ = validate_reply('{"things": [], "corners": [[1, 2], {"x": 3, "y": 4}]}', Answer)
    assert [(point.x, point.y) for point in reply.corners] == [(1, 2), (3, 4)]


def test_what_fits_is_left_alone():
    data = thing(yaw=3.5, parent="bed_1")
    assert repair_reply(data, Answer) == (data, ())


GUESSES = [
    thing(size=[1, 2]),
    thing(size=["150 cm", 2, 1]),
    thing(size=[None, 2, 1]),
    thing(size=["1,5", 2, 1]),
    thing(kind="sofa"),
    thing(box=[1, 2, 3, 4]),
    thing(id=None),
    thing(yaw="east"),
    {"nothing": 1},
    "text",
    None,
    7,
]


@pytest.mark.parametrize("data", GUESSES)
def test_what_would_be_a_guess_is_refused_with_its_place(data):
    with pytest.raises(ReplyError) as caught:
        validate_reply(json.dumps(data), Answer)
    assert caught.value.problems
    if isinstance(data, dict) and "things" in data:
        assert "things[0]" in caught.value.problems[0]


def test_alike_problems_are_told_once_and_at_most_fifteen_lines():
    things = [{**GOOD, "id": f"t{i}", "size": [1, 2]} for i in range(40)]
    with pytest.raises(ReplyError) as caught:
        validate_reply(json.dumps({"things": things}), Answer)
    assert len(caught.value.problems) == 1 and "39 more" in caught.value.problems[0]
    different = [{**GOOD, "kind": f"k{i}", "size": [1] * i} for i in range(40)]
    with pytest.raises(ReplyError) as caught:
        validate_reply(json.dumps({"things": different}), Answer)
    assert len(caught.value.problems) <= 15


def test_salvage_leaves_out_few_bad_entries_and_names_them():
    things = [{**GOOD, "id": f"t{i}"} for i in range(8)]
    things[3]["size"] = [1, 2]
    things[5]["yaw"] = "east"
    text = json.dumps({"things": things})
    with pytest.raises(ReplyError):
        validate_reply(text, Answer)
    reply, notes = validate_reply(text, Answer, salvage=True)
    assert [item.id for item in reply.things] == ["t0", "t1", "t2", "t4", "t6", "t7"]
    assert any("t3, t5" in note for note in notes)


@pytest.mark.parametrize("bad", [3, 8])
def test_salvage_never_throws_away_much(bad):
    things = [{**GOOD, "id": f"t{i}", **({"kind": "sofa"} if i < bad else {})} for i in range(8)]
    with pytest.raises(ReplyError):
        validate_reply(json.dumps({"things": things}), Answer, salvage=True)


def test_a_cut_answer_stays_a_cut_answer():
    with pytest.raises(CutReplyError):
        validate_reply('{"things": [{"id": "a"', Answer)


odd = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=6)
odd_values = st.recursive(
    odd,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["id", "kind", "size", "box", "things", "x", "y", "x_min", "YAW", "zz"]), inner, max_size=5
        )
    ),
)


@given(odd_values)
def test_any_data_gives_a_valid_reply_or_a_reply_error(data):
    try:
        reply, _ = validate_reply(json.dumps(data), Answer, salvage=True)
    except ReplyError:
        return
    assert isinstance(reply, Answer)


@given(st.sampled_from(sorted(GOOD)) | st.sampled_from(["yaw", "parent", "count", "fixed"]), odd_values)
def test_any_value_in_any_field_is_repaired_or_refused(name, value):
    try:
        reply, _ = validate_reply(json.dumps(thing(**{name: value})), Answer, salvage=True)
    except ReplyError:
        return
    assert Answer.model_validate(reply.model_dump()) == reply
