# SPDX-License-Identifier: GPL-3.0-or-later
"""Started in Blender's window by `run_panel.py`: a generator that a timer drives, so that Blender draws between steps."""

from __future__ import annotations

import json
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))

import basics
import edits
import lifetime
import looking
import modelling
import pointing
from window import SHOTS, results

STEPS = (
    basics.enable,
    basics.load,
    basics.run_all,
    edits.undo_and_redo,
    pointing.correct_in_the_picture,
    basics.stop,
    edits.move_and_resume,
    looking.capture_in_the_view,
    looking.look_through,
    modelling.model_one_object,
    lifetime.results_and_reload,
    lifetime.resume_after_reload,
    lifetime.disable,
)


def steps() -> Iterator[float]:
    """All steps, one after the other."""
    for step in STEPS:
        print(f"step: {step.__module__}.{step.__name__}", flush=True)
        yield from step()


def drive() -> float | None:
    """The timer."""
    try:
        return next(TEST)
    except StopIteration:
        pass
    except BaseException:
        results["error"] = traceback.format_exc()
    (SHOTS / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
TEST = steps()
bpy.app.timers.register(drive, first_interval=1.0, persistent=True)
