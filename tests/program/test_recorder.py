# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout lines check what they are given and say what is wrong."""

from __future__ import annotations

import inspect
from typing import Any

import pytest
from code_as_room.pipeline.program.lines import LINE_TYPES
from code_as_room.pipeline.program.prelude.recorder import Recorder
from code_as_room.pipeline.program.prelude.solids import box

FLOOR = [(-2, -1), (2, -1), (2, 1), (-2, 1)]
IDENTITY = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)


def room() -> Recorder:
    """A recorder with a floor, a wall and a bed."""
    recorder = Recorder()
    recorder.room(size=(4, 2, 2.5), floor=FLOOR)
    recorder.wall("wall_s", (-2, -1), (2, -1), height=2.5)
    recorder.proxy("bed_1", "bed", centre=(0, 0, 0.25), size=(1, 2, 0.5))
    return recorder


def test_a_record_holds_the_fields_of_the_typed_lines() -> None:
    recorder = room()
    recorder.door("door_1", "wall_s", (0, -1), (0.9, -1))
    recorder.window("window_1", "wall_s", (-1, -1), (-0.5, -1))
    recorder.opening("opening_1", "wall_s", (1, -1), (1.5, -1))
    recorder.light("sun", "sun", at=(0, 0, 5), energy=3)
    recorder.world("sky", strength=0.4, kelvin=6500)
    recorder.view("view", exposure=0.5, ceiling=2.5)
    recorder.camera("reference", "perspective", IDENTITY, fov_y=0.9)
    recorder.furnish("bed_1", [box((1, 1, 1))])
    recorder.build()
    record = recorder.record
    lists = [record.walls, record.doors, record.windows, record.openings, record.proxies, record.lights]
    lists += [record.worlds, record.views, record.cameras]
    for kind, lines in zip(list(LINE_TYPES)[1:], lists, strict=True):
        typed = LINE_TYPES[kind].model_validate(lines[0])
        assert typed.model_dump() == lines[0]
    assert record.built and len(record.furnished["bed_1"]) == 1


@pytest.mark.parametrize("kind", LINE_TYPES)
def test_parameters_are_the_fields_in_order_with_the_same_defaults(kind: str) -> None:
    parameters = list(inspect.signature(getattr(Recorder(), kind)).parameters.values())
    fields = LINE_TYPES[kind].model_fields
    assert [p.name for p in parameters] == list(fields)
    for parameter in parameters:
        info = fields[parameter.name]
        assert (parameter.default is inspect.Parameter.empty) == info.is_required()
        assert info.is_required() or parameter.default == info.default


def bed(**changes: Any) -> Any:
    """A call of proxy with some arguments changed."""
    given = {"id": "bed_2", "category": "bed", "centre": (0, 0, 0), "size": (1, 1, 1), **changes}
    return lambda r: r.proxy(**given)


REFUSED: dict[str, Any] = {
    "room: there is already a room line": lambda r: r.room((1, 1, 1), FLOOR),
    "the id 'bed_1' is used twice": bed(id="bed_1"),
    "the id 'wall_s' is used twice": bed(id="wall_s"),
    "the id must be text in quotes": bed(id=3),
    "the id must not be empty": bed(id=""),
    "centre must be (x, y, z), three finite numbers": bed(centre=(0, 0)),
    "size must be three positive numbers": bed(size=(1, -1, 1)),
    "yaw must be a finite number": bed(yaw=float("inf")),
    "placement must be one of floor, wall, ceiling, surface": bed(placement="roof"),
    "salience must be one of": bed(salience="huge"),
    "shape must be one of": bed(shape="cube"),
    "label must be text": bed(label=5),
    "wall: start and end are the same point": lambda r: r.wall("w", (0, 0), (0, 0), 2),
    "wall: height must be a positive number": lambda r: r.wall("w", (0, 0), (1, 0), 0),
    "wall: partition must be True or False": lambda r: r.wall("w", (0, 0), (1, 0), 2, partition=1),
    "door: open must be between": lambda r: r.door("d", "wall_s", (0, 0), (1, 0), open=720),
    "window: sill must be between": lambda r: r.window("w", "wall_s", (0, 0), (1, 0), sill=-1),
    "light: kind must be one of": lambda r: r.light("l", "lava", (0, 0, 0), 3),
    "light: energy must be between": lambda r: r.light("l", "sun", (0, 0, 0), -3),
    "camera: matrix must be 16 finite numbers": lambda r: r.camera("c", "perspective", (1, 2), fov_y=1),
    "camera: a perspective camera needs fov_y": lambda r: r.camera("c", "perspective", IDENTITY),
    "camera: orthographic cameras need ortho_height": lambda r: r.camera("c", "orthographic", IDENTITY),
    "camera: image_size must be": lambda r: r.camera("c", "perspective", IDENTITY, 1, 0, (1.5, 2)),
    "furnish: there are no shapes": lambda r: r.furnish("bed_1", []),
    "furnish: expected a shape or a list of shapes, not text": lambda r: r.furnish("bed_1", "bed"),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_wrong_lines_are_refused_with_a_sentence(sentence: str) -> None:
    with pytest.raises(ValueError) as caught:
        REFUSED[sentence](room())
    assert sentence in str(caught.value)


WRONG_AT_BUILD: dict[str, Any] = {
    "'door_1' lies in 'wall_x', which is not a wall": lambda r: r.door("door_1", "wall_x", (0, 0), (1, 0)),
    "'door_1' lies in 'bed_1', which is not a wall": lambda r: r.door("door_1", "bed_1", (0, 0), (1, 0)),
    "the parent 'sofa' of 'bed_2' does not exist": bed(parent="sofa"),
    "furnish names 'sofa'": lambda r: r.furnish("sofa", box((1, 1, 1))),
    "run in a circle": lambda r: [bed(parent="bed_3")(r), bed(id="bed_3", parent="bed_2")(r)],
}


@pytest.mark.parametrize("sentence", WRONG_AT_BUILD)
def test_references_are_checked_by_build(sentence: str) -> None:
    recorder = room()
    WRONG_AT_BUILD[sentence](recorder)
    with pytest.raises(ValueError) as caught:
        recorder.build()
    assert sentence in str(caught.value) and not recorder.record.built


def test_children_may_come_before_their_parents_and_hang_on_walls() -> None:
    recorder = Recorder()
    bed(id="pillow", parent="bed_2")(recorder)
    bed(id="picture", parent="wall_s", placement="wall")(recorder)
    bed()(recorder)
    recorder.wall("wall_s", (-2, -1), (2, -1), height=2.5)
    with pytest.raises(ValueError, match="room line is missing"):
        recorder.build()
    recorder.room((4, 2, 2.5), FLOOR)
    recorder.build()
    with pytest.raises(ValueError, match="must be the last statement"):
        bed(id="late")(recorder)


def test_a_clockwise_floor_is_refused() -> None:
    with pytest.raises(ValueError, match="counter-clockwise"):
        Recorder().room((4, 2, 2.5), FLOOR[::-1])


def test_a_room_has_a_limited_number_of_lines() -> None:
    recorder = Recorder()
    with pytest.raises(ValueError, match="at most 2000 layout lines"):
        for index in range(2001):
            bed(id=f"bed_{index}")(recorder)
