"""Generated rooms with faults of every kind: found, none brought, locked things as they were, a second pass does nothing."""

from __future__ import annotations

from code_as_room.pipeline.artifacts.correction import FAULT_KINDS
from code_as_room.pipeline.correction.correct import Options, correct, find_faults
from code_as_room.pipeline.program.lines import parse_layout
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.broken_rooms import PICTURES, break_room, make_room
from benchmark.corrected import measure


@settings(max_examples=12)
@given(st.integers(1000, 100_000), st.booleans())
def test_a_second_pass_does_nothing_and_no_fault_is_new(number: int, hold: bool) -> None:
    text, injected, locked = break_room(make_room(number), number)
    if hold:
        locked |= {name for fault in injected[::2] for name in fault.ids}
    options = Options(locked=locked, pictures=PICTURES)
    once = correct(text, options)
    twice = correct(once.text, options)
    assert twice.text == once.text and not twice.report.fixes
    assert {f.key for f in find_faults(once.text, options)} <= {f.key for f in find_faults(text, options)}
    before, after = parse_layout(text), parse_layout(once.text)
    for name in ("proxies", "lights", "cameras"):
        for old, new in zip(getattr(before, name), getattr(after, name), strict=True):
            assert old == new or old.id not in locked
    # Only places change: no object is made larger, turned or given to another one.
    for old, new in zip(before.proxies, after.proxies, strict=True):
        assert new.model_copy(update={"centre": old.centre}) == old


def test_every_fault_put_in_is_found() -> None:
    table = measure(4, seed=3)
    for kind in FAULT_KINDS:
        assert table[kind]["found"] == table[kind]["injected"]
        assert not table[kind]["introduced"]
    assert not table["all"]["touched"] and not table["all"]["second pass"]
