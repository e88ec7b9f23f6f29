"""Surfaces found on shapes made by the language's own constructors, and seats on them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.geometry.camera import camera_looking_at
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.surfaces.choose import Carriers
from code_as_room.pipeline.surfaces.find import Surface, support_surfaces
from code_as_room.pipeline.surfaces.rasters import sample
from code_as_room.pipeline.surfaces.seat import Seat, find_seat, occupied
from code_as_room.pipeline.surfaces.settle import FINE, drop
from hypothesis import example, given, settings
from hypothesis import strategies as st


def surfaces(body: str) -> list[Surface]:
    text = "def thing():\n    return [" + body + "]\n"
    return support_surfaces(evaluate_object(text, "thing"))


def block(name: str, size: tuple[float, float, float], x: float = 0.0, y: float = 0.0, z: float = 0.0) -> str:
    """A box whose base is at z."""
    return f'part("{name}", box({size}, at=({x}, {y}, {z + size[2] / 2})), material="wood")'


TABLE = ", ".join(
    [
        block("top", (1.2, 0.8, 0.04), z=0.71),
        block("leg", (0.06, 0.06, 0.71), -0.5, -0.3),
        block("leg", (0.06, 0.06, 0.71), 0.5, 0.3),
    ]
)
SHELF = ", ".join(block("board", (0.8, 0.3, 0.02), z=z) for z in (0.1, 0.5, 0.9))


def test_a_table_has_one_surface_of_its_size_at_its_height() -> None:
    [top] = surfaces(TABLE)
    assert top.level == pytest.approx(0.75, abs=1e-6)
    assert top.area == pytest.approx(1.2 * 0.8, rel=0.03)
    assert top.part == "top"
    assert top.open_share == 1.0


def test_every_board_of_a_shelf_is_found_with_the_room_above_it() -> None:
    found = surfaces(SHELF)
    assert [s.level for s in found] == pytest.approx([0.92, 0.52, 0.12], abs=1e-6)
    assert found[0].open_share == 1.0
    assert found[1].open_share == 0.0
    assert np.nanmax(found[1].clearance) == pytest.approx(0.38, abs=1e-6)


def test_what_lies_inside_or_right_under_another_part_carries_nothing() -> None:
    found = surfaces(f"{block('mattress', (2.0, 1.6, 0.4))}, {block('duvet', (2.0, 1.0, 0.1), z=0.38)}")
    assert [s.part for s in found] == ["duvet", "mattress"]
    assert found[1].area == pytest.approx(2.0 * 0.6, rel=0.05)


def test_a_rim_with_a_hole_is_a_ring_and_what_is_in_the_box_stays_free() -> None:
    """Concave faces were filled across their holes, and four balls lay on the rim of an open toy box."""
    rim = 'part("rim", extrude(rectangle(0.8, 0.4), 0.02, holes=[rectangle(0.74, 0.34)], at=(0, 0, 0.38)), material="wood")'
    inside = block("inside", (0.78, 0.38, 0.02), z=0.1)
    found = {s.part: s for s in surfaces(f"{rim}, {inside}")}
    assert found["rim"].area == pytest.approx(0.8 * 0.4 - 0.74 * 0.34, rel=0.25)
    assert found["inside"].level == pytest.approx(0.12) and found["inside"].area > 0.9 * 0.74 * 0.34
    corner = 'part("top", extrude([(-1, -0.5), (1, -0.5), (1, 0), (0, 0), (0, 1), (-1, 1)], 0.04), material="wood")'
    [top] = surfaces(corner)
    assert top.area == pytest.approx(1.0 + 1.0, rel=0.03)


def test_a_slope_and_an_underside_are_no_surfaces() -> None:
    assert surfaces('part("roof", turn(box((1.0, 1.0, 0.02)), 40, axis="x"), material="wood")') == []
    assert surfaces('part("rod", cylinder(0.01, 1.0), material="metal")') == []


def test_a_thing_stands_where_it_is_wanted_when_that_is_free() -> None:
    [top] = surfaces(TABLE)
    seat = find_seat(top, (0.1234, -0.0567), (0.2, 0.1, 0.1), 30.0)
    assert seat is not None
    assert (seat.x, seat.y, seat.moved, seat.scale) == (0.1234, -0.0567, 0.0, 1.0)
    assert seat.z == pytest.approx(0.75, abs=1e-6)


def test_what_is_wanted_beyond_the_edge_comes_to_the_nearest_place_inside() -> None:
    [top] = surfaces(TABLE)
    seat = find_seat(top, (0.8, 0.0), (0.2, 0.2, 0.1), 0.0)
    assert seat is not None
    assert 0.45 < seat.x < 0.56
    assert abs(seat.y) < 0.03
    assert find_seat(top, (0.8, 0.0), (0.2, 0.2, 0.1), 0.0, reach=0.1) is None


def test_too_large_a_thing_is_made_smaller_within_reason_or_refused() -> None:
    [top] = surfaces(TABLE)
    smaller = find_seat(top, (0.0, 0.0), (1.5, 0.7, 0.3), 0.0)
    assert smaller is not None
    assert smaller.scale == 0.85
    assert find_seat(top, (0.0, 0.0), (3.0, 2.0, 0.3), 0.0) is None


def test_a_tall_thing_does_not_go_under_a_low_board() -> None:
    found = surfaces(SHELF)
    assert find_seat(found[1], (0.0, 0.0), (0.1, 0.1, 0.5), 0.0, reach=1.0) is not None  # made smaller
    assert find_seat(found[1], (0.0, 0.0), (0.1, 0.1, 0.6), 0.0) is None


spots = st.tuples(
    st.floats(-0.6, 0.6), st.floats(-0.4, 0.4), st.floats(0.05, 0.25), st.floats(0.05, 0.25), st.floats(0, 360)
)


@settings(deadline=None, max_examples=40)
@given(st.lists(spots, min_size=1, max_size=10))
@example([(0.0, 0.0, 0.125, 0.0625, 0.0), (0.0, 0.0, 0.25, 0.25, 0.0)])
def test_seats_stay_on_the_surface_and_off_each_other(things: list[tuple[float, float, float, float, float]]) -> None:
    [top] = surfaces(TABLE)
    taken: list[tuple[Seat, float, float, float]] = []
    for x, y, width, depth, turn in things:
        seat = find_seat(top, (x, y), (width, depth, 0.1), turn)
        if seat is None:
            continue
        assert abs(seat.x) <= 0.6 and abs(seat.y) <= 0.4
        assert seat.moved == pytest.approx(math.hypot(seat.x - x, seat.y - y))
        own = occupied(top.grid, seat.x, seat.y, width * seat.scale, depth * seat.scale, turn)
        for _, _, _, other in [(None, None, None, t[0].cells) for t in taken]:
            assert (own & other).sum() <= 0.25 * min(own.sum(), other.sum()) + 4
        taken.append((seat, width, depth, turn))
        top = top.taken(seat.cells)
    assert taken


def test_a_thing_keeps_out_of_what_rises_beside_its_surface() -> None:
    """An armchair's seat between a back and arms: a cushion that is wanted inside of the back stands before it."""
    seat = block("seat", (0.6, 0.6, 0.4))
    back = block("back", (0.6, 0.1, 0.9), y=0.35)
    found = next(s for s in surfaces(f"{seat}, {back}") if s.part == "seat")
    cushion = find_seat(found, (0.0, 0.26), (0.4, 0.16, 0.3), 0.0)
    assert cushion is not None and cushion.y + 0.08 <= 0.31 and cushion.moved < 0.06
    open_edge = find_seat(found, (0.0, -0.26), (0.4, 0.12, 0.3), 0.0)
    assert open_edge is not None and open_edge.moved == 0.0, "over an open edge it may hang a little"


def test_a_rim_counts_and_a_shelf_above_counts_only_for_what_reaches_it() -> None:
    tray = f"{block('base', (0.4, 0.3, 0.02))}, {block('rim', (0.4, 0.02, 0.06), y=0.14)}"
    found = next(s for s in surfaces(tray) if s.part == "base")
    glass = find_seat(found, (0.0, 0.11), (0.08, 0.08, 0.12), 0.0)
    assert glass is not None and glass.y + 0.04 <= 0.14
    beam = f"{block('base', (0.4, 0.3, 0.02))}, {block('beam', (0.4, 0.1, 0.05), y=0.16, z=0.3)}"
    low = next(s for s in surfaces(beam) if s.part == "base")
    under = find_seat(low, (0.0, 0.11), (0.08, 0.08, 0.12), 0.0)
    assert under is not None and under.moved == 0.0


def test_a_round_thing_is_let_down_until_the_two_meshes_touch() -> None:
    """A ball of 20 cm between two ridges that its box's corners rest on, but it does not."""
    ridges = ", ".join([block("floor", (1.0, 1.0, 0.1)), block("ridge", (1.0, 0.06, 0.02), y=0.08, z=0.1)])
    carrier = sample(evaluate_object("def thing():\n    return [" + ridges + "]\n", "thing"), FINE)
    ball = evaluate_object("def ball():\n    return sphere(0.1, at=(0, 0, 0.1))\n", "ball")
    assert carrier is not None
    down = drop(ball, 1.0, carrier, (0.0, 0.0, 0.12), 0.0)
    assert 0.005 < down < 0.02
    assert drop(ball, 1.0, carrier, (0.0, -0.3, 0.1), 0.0) == pytest.approx(0.0, abs=2e-3)
    assert drop(ball, 1.0, carrier, (0.0, -0.3, 0.09), 0.0) == pytest.approx(-0.01, abs=2e-3), "lifted out"


def test_a_pillow_leans_against_a_pillow_and_a_book_does_not_lie_in_one() -> None:
    """Pillows piled at a headboard were laid out side by side, the white ones before the brown ones."""

    def thing(name: str, category: str) -> DetectedObject:
        return DetectedObject(id=name, category=category, placement="surface", parent="bed", size=(0.5, 0.3, 0.2),
                              centre=(0.0, 0.3, 0.6), box=None)  # fmt: skip

    bed = ProxyLine(id="bed", category="bed", centre=(0, 0, 0.25), size=(1.6, 2.0, 0.5))
    carriers = Carriers(
        {"bed": evaluate_object(f"def thing():\n    return [{block('top', (1.6, 2.0, 0.5))}]\n", "thing")}
    )
    carriers.add(bed)
    carriers.add(
        ProxyLine(id="pillow_1", category="pillow", centre=(0, 0.3, 0.6), size=(0.5, 0.3, 0.2), placement="surface",
                  parent="bed")
    )  # fmt: skip
    over = camera_looking_at("perspective", (0, 0, 6), (0, 0, 0), 45.0, (800, 800))
    calibration = Calibration(camera=over, floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)], height=2.5, error_px=0.0,
                              scale_source="truth")  # fmt: skip
    pillow, book = (carriers.seat(thing(c, c), calibration, "bed") for c in ("white pillow", "book"))
    assert pillow is not None and pillow.moved < 0.03
    assert book is not None and book.moved > 0.2
