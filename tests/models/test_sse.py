# SPDX-License-Identifier: GPL-3.0-or-later
"""Server-sent events, however the network cuts them."""

from code_as_room.pipeline.models.sse import EventReader
from hypothesis import given
from hypothesis import strategies as st

lines = st.text(st.characters(blacklist_characters="\r\n", blacklist_categories=["Cs"]), max_size=20)


@given(st.lists(lines.filter(bool), max_size=6), st.sampled_from(["\n", "\r\n", "\r"]), st.lists(st.integers(0, 400)))
def test_events_do_not_depend_on_how_the_stream_is_cut(texts, end, cuts):
    stream = "".join(f": comment{end}event: x{end}data: {text}{end}{end}" for text in texts).encode()
    places = sorted({0, len(stream), *(cut % (len(stream) + 1) for cut in cuts)})
    reader = EventReader()
    got = [event for a, b in zip(places, places[1:], strict=False) for event in reader.feed(stream[a:b])]
    assert got + reader.finish() == texts


def test_lines_of_one_event_are_joined_and_a_missing_last_line_end_is_forgiven():
    reader = EventReader()
    assert reader.feed(b"data: a\ndata:b\n\ndata: c") == ["a\nb"]
    assert reader.finish() == ["c"]
    assert reader.finish() == []


@given(st.lists(st.binary(max_size=30)))
def test_any_bytes_are_survived(pieces):
    reader = EventReader()
    for piece in pieces:
        reader.feed(piece)
    reader.finish()
