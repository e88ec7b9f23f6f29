# SPDX-License-Identifier: GPL-3.0-or-later
"""The preferences of the enabled extension: the key reaches nothing but the service that it was typed for."""

from __future__ import annotations

import base64
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("__init__.py", "blender_manifest.toml", "operators", "panels", "pipeline", "prompts")
CANARY = "CANARY"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with everything that the extension wrote and said in a session of its own."""
    home: Path = tmp_path_factory.mktemp("preferences")
    target = home / "profile" / "extensions" / "user_default" / "code_as_room"
    target.mkdir(parents=True)
    for name in PARTS:
        (target / name).symlink_to(ROOT / name)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("CODE_AS_ROOM")}
    sample = ROOT / "samples" / "bedroom"
    script = Path(__file__).with_name("preferences_inside.py")
    done = subprocess.run(
        [sys.executable, str(script), str(home), str(sample / "picture.png"), str(sample / "replies")],
        env={**environment, "BLENDER_USER_RESOURCES": str(home / "profile")},
        capture_output=True,
        timeout=400,
        check=False,
    )
    (home / "console.txt").write_bytes(done.stdout + done.stderr)
    assert (home / "found.json").is_file(), done.stderr.decode()[-3000:]
    return home


@pytest.fixture(scope="module")
def found(home: Path) -> dict[str, Any]:
    """What was noted."""
    result: dict[str, Any] = json.loads((home / "found.json").read_text(encoding="utf-8"))
    return result


def test_the_key_is_in_nothing_that_was_written_or_said(home: Path, found: dict[str, Any]) -> None:
    assert found["statuses"] and set(found["statuses"]) == {"done"}, found
    shown = {
        name: value
        for name, value in found.items()
        if name not in ("anthropic again", "custom again", "authorizations")
    }
    (home / "found.json").write_text(json.dumps(shown), encoding="utf-8")
    forms = [CANARY.encode(), CANARY.lower().encode(), base64.b64encode(b"sk-CANARY-4f8")[:16]]
    looked_at = 0
    for path in sorted(home.rglob("*")):
        # The preferences themselves may hold it, as their warning says; the source is only linked to.
        if (
            path.is_file()
            and not path.is_symlink()
            and path.name != "userpref.blend"
            and "code_as_room/" not in str(path)
        ):
            looked_at += 1
            data = path.read_bytes()
            assert not any(form in data for form in forms), path
    names = {path.name for path in home.rglob("*")}
    assert any(path.is_file() for path in home.glob("profile/extensions/.user/**/journal/*")), (
        "answers are in the journal"
    )
    assert looked_at > 10 and {"saved.blend", "room.blend", "memory.json", "report.html", "console.txt"} <= names


def test_every_failure_was_told_in_words_that_name_it(found: dict[str, Any]) -> None:
    for way in ("test", "run"):
        assert "does not accept the API key" in found[f"{way} key"]
        assert "no credit" in found[f"{way} money"]
        assert "not a chat reply" in found[f"{way} junk"]
    assert "FINISHED" in found["test good"] and "'good'" in found["report"]


def test_the_key_went_to_the_service_that_it_was_typed_for(found: dict[str, Any]) -> None:
    assert found["authorizations"] == ["Bearer sk-CANARY-4f8a1c77e2"]
    assert found["models"] == ["served"]


def test_nothing_is_asked_that_the_artist_did_not_ask_for(found: dict[str, Any]) -> None:
    assert found["looked at"].startswith("['not run'") and found["requests without a run"] == []


def test_nothing_is_asked_while_blender_is_offline(found: dict[str, Any]) -> None:
    assert found["poll while offline"] is False and "online access is off" in found["test while offline"]
    assert found["asked while offline"] == 0


def test_a_test_stops_and_its_result_does_not_outlive_a_change(found: dict[str, Any]) -> None:
    assert found["seconds to stop"] < 2.0 and found["report after stop"] == "None"
    assert found["report after change"] == "None" and found["timer left"] is False


def test_what_was_typed_for_one_provider_never_stands_in_anothers_fields(found: dict[str, Any]) -> None:
    assert found["default"] == "BUILTIN"
    assert found["anthropic"] == ["https://api.anthropic.com/v1", "", "", ""]
    assert found["ollama"] == ["http://localhost:11434", "", ""]
    assert found["anthropic again"] == ["https://api.anthropic.com/v1", "claude", "ant-CANARY-99b2"]
    assert found["custom again"] == ["served", "eyes", "sk-CANARY-4f8a1c77e2"]


def test_the_cap_stops_before_anything_is_sent_and_costs_are_counted(found: dict[str, Any]) -> None:
    assert "spending cap" in found["run over the cap"] and found["asked over the cap"] == 0
    assert "$" in found["estimate"]
    prompt_tokens, completion_tokens, cost = found["spent"]
    assert cost == pytest.approx((prompt_tokens + completion_tokens) * 1e3 / 1e6) and cost > 0
