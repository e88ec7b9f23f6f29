# SPDX-License-Identifier: GPL-3.0-or-later
"""Recording a model's answers and playing them back."""

import io
import json
import threading
from dataclasses import replace

import numpy as np
import pytest
from code_as_room.pipeline.errors import Cancelled, ModelError, OutputError, ReplyError
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.recorded import RecordedClient, Recorder, load_replies
from code_as_room.pipeline.prompting import prompt_hash, repair_prompt
from PIL import Image


class Speaker:
    """A client that says what it is told to."""

    name = "speaker"
    describes = "A speaker"

    def __init__(self, *texts):
        self.texts = list(texts)

    def answer(self, prompt, cancel, progress=None):
        return Reply(self.texts.pop(0) if len(self.texts) > 1 else self.texts[0], "speaker-1", 5, 6)


def picture(kind="PNG", shade=0, size=(64, 48)):
    rows = np.linspace(0, 200, size[1], dtype=np.uint8)[:, None, None]
    image = Image.fromarray(np.broadcast_to(rows + np.uint8(shade), (size[1], size[0], 3)).copy())
    buffer = io.BytesIO()
    image.save(buffer, kind)
    return buffer.getvalue()


def make_prompt(text="What is a?", images=(), key="01_test"):
    return Prompt("s01", key, text, tuple(images), "Answer", {}, prompt_hash(text, images, "Answer"))


def ask(client, prompt):
    return client.answer(prompt, threading.Event())


def test_what_was_recorded_is_played_back(tmp_path):
    prompt = make_prompt(images=[picture()])
    recorded = ask(Recorder(Speaker('```json\n{"a": [1, 2.5], "b": "ü"}\n```'), tmp_path / "new"), prompt)
    reply = ask(RecordedClient(tmp_path / "new"), prompt)
    assert "```" in recorded.text
    assert json.loads(reply.text) == {"a": [1, 2.5], "b": "ü"}
    assert (reply.model, reply.prompt_tokens, reply.completion_tokens) == ("speaker-1", 5, 6)
    assert reply.notes == ()


def test_the_file_is_sorted_and_readable(tmp_path):
    for key in ("b", "a/2", "a/10"):
        objects = [{"id": f"chair_{i}", "size": [0.5, 0.5, 0.9], "label": "ü"} for i in range(9)]
        ask(Recorder(Speaker(json.dumps({"objects": objects})), tmp_path), make_prompt(key=key))
    text = (tmp_path / "replies.json").read_text(encoding="utf-8")
    assert list(json.loads(text)["replies"]) == ["s01/a/10", "s01/a/2", "s01/b"]
    assert '{"id": "chair_3", "size": [0.5, 0.5, 0.9], "label": "ü"}' in text
    assert max(map(len, text.splitlines())) <= 130
    assert sorted(path.name for path in tmp_path.iterdir()) == ["replies.json"]


def test_an_answer_that_is_not_json_is_kept_as_it_is(tmp_path):
    ask(Recorder(Speaker("I see no room."), tmp_path), make_prompt())
    assert ask(RecordedClient(tmp_path), make_prompt()).text == "I see no room."


def test_a_changed_prompt_is_answered_and_the_drift_reported(tmp_path):
    ask(Recorder(Speaker("{}"), tmp_path), make_prompt(images=[picture()]))
    client = RecordedClient(tmp_path)
    [note] = ask(client, make_prompt("What is b?", [picture()])).notes
    assert "words" in note and "s01/01_test" in note
    [note] = ask(client, make_prompt(images=[picture(shade=40)])).notes
    assert "pictures" in note
    assert len(ask(client, make_prompt("What is b?")).notes) == 2


def test_the_same_picture_in_another_encoding_is_no_drift(tmp_path):
    ask(Recorder(Speaker("{}"), tmp_path), make_prompt(images=[picture("PNG")]))
    client = RecordedClient(tmp_path)
    assert ask(client, make_prompt(images=[picture("JPEG")])).notes == ()
    assert ask(client, make_prompt(images=[picture("PNG", size=(128, 96))])).notes == ()


def test_a_repair_rounds_answer_is_the_one_that_stays(tmp_path):
    prompt = make_prompt()
    recorder = Recorder(Speaker('{"a": "wrong"}', '{"a": 1}'), tmp_path)
    ask(recorder, prompt)
    ask(recorder, repair_prompt(prompt, ["a: is no number"], '{"a": "wrong"}'))
    reply = ask(RecordedClient(tmp_path), prompt)
    assert json.loads(reply.text) == {"a": 1}
    assert reply.notes == ()


def test_an_unreadable_answer_never_replaces_a_good_one(tmp_path):
    recorder = Recorder(Speaker('{"a": 1}', "sorry"), tmp_path)
    ask(recorder, make_prompt())
    assert ask(recorder, make_prompt()).text == "sorry"
    assert json.loads(ask(RecordedClient(tmp_path), make_prompt()).text) == {"a": 1}


def test_a_missing_key_and_a_repair_are_told_in_plain_words(tmp_path):
    ask(Recorder(Speaker("{}"), tmp_path), make_prompt())
    client = RecordedClient(tmp_path)
    with pytest.raises(ModelError, match="s01/other") as caught:
        ask(client, make_prompt(key="other"))
    assert caught.value.fix and str(tmp_path) not in str(caught.value)
    with pytest.raises(ReplyError, match="does not fit"):
        ask(client, replace(make_prompt(), repair=True))


def test_a_stopped_run_gets_no_answer(tmp_path):
    ask(Recorder(Speaker("{}"), tmp_path), make_prompt())
    cancel = threading.Event()
    cancel.set()
    with pytest.raises(Cancelled):
        RecordedClient(tmp_path).answer(make_prompt(), cancel)


DAMAGED = ["", "{", "[]", "{}", '{"format": "other", "replies": {}}', "[" * 100_000]
DAMAGED.append('{"format": "code-as-room/replies/1", "replies": {"a": 3}}')


@pytest.mark.parametrize("text", DAMAGED)
def test_damaged_recordings_are_refused(tmp_path, text):
    (tmp_path / "replies.json").write_text(text)
    with pytest.raises(ModelError):
        RecordedClient(tmp_path)


def test_a_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(ModelError, match="no recorded answers"):
        RecordedClient(tmp_path / "missing")


def test_an_unwritable_folder_is_told(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError):
        ask(Recorder(Speaker("{}"), tmp_path / "file" / "folder"), make_prompt())


def test_answers_recorded_side_by_side_are_all_kept(tmp_path):
    recorder = Recorder(Speaker("{}"), tmp_path)
    threads = [threading.Thread(target=ask, args=(recorder, make_prompt(key=str(i)))) for i in range(12)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(load_replies(tmp_path)) == 12
