# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's chatter is kept from the artist's terminal; what may matter is not."""

from __future__ import annotations

import os

import pytest
from code_as_room.pipeline.scene.compat import quiet


def test_only_chatter_is_kept_back(capfd: pytest.CaptureFixture[str]) -> None:
    with quiet():
        os.write(1, b"Saved: somewhere\n")
        os.write(2, b"EGL Error (0x3009): EGL_BAD_MATCH: Arguments are inconsistent\n")
        os.write(2, b"the disk is full\n")
    os.write(1, b"after\n")
    told = capfd.readouterr()
    assert told.out == "after\n"
    assert told.err == "the disk is full\n"


def test_output_comes_back_after_an_error(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError), quiet():
        raise ValueError
    os.write(1, b"heard\n")
    assert capfd.readouterr().out == "heard\n"
