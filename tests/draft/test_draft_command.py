# SPDX-License-Identifier: GPL-3.0-or-later
"""`--draft` on the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from code_as_room.operators.command import EXIT_PROBLEM, cli_main
from PIL import Image


def test_a_draft_without_a_model_says_what_to_do_and_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("PROVIDER", "BASE_URL", "MODEL"):
        monkeypatch.delenv(f"CODE_AS_ROOM_{name}", raising=False)
    picture = tmp_path / "room.png"
    Image.new("RGB", (300, 300), (200, 190, 180)).save(picture)
    assert cli_main([str(picture), "--out", str(tmp_path / "out"), "--draft"]) == EXIT_PROBLEM
    told = capsys.readouterr().err
    assert "needs a model" in told and "--model" in told and not (tmp_path / "out" / "memory.json").exists()
