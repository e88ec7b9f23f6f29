# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures and their ground truth: `<room>/picture.png` and `<room>/truth.json` beside this file.

python -m benchmark.pictures.make [room ...] [--out DIR] [--samples N] [--percent 100] [--no-render]
"""

from __future__ import annotations

import argparse
import importlib
import json
import time
from pathlib import Path
from typing import Any

from .model import Scene

FOLDER = Path(__file__).parent
ROOMS = ("studio_l", "office_tilted", "living_ortho", "flat_plan", "cafe_photo")


def scene_of(room: str) -> Scene:
    """The description of a room."""
    found: Scene = importlib.import_module(f".scenes.{room}", __package__).scene()
    return found


def make(room: str, out: Path, samples: int = 0, percent: int = 100, render: bool = True) -> dict[str, Any]:
    """Make one room's files in a folder, and return its truth.

    Args:
        samples: of every pixel; 0 for the room's own. percent: size of the picture; render: False for the truth alone.
    """
    scene = scene_of(room)
    out.mkdir(parents=True, exist_ok=True)
    truth, picture = _drawn(scene) if scene.plan else _photographed(scene, samples, percent, render)
    (out / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    if picture is not None:
        picture.save(out / "picture.png", optimize=True)
    return truth


def _drawn(scene: Scene) -> tuple[dict[str, Any], Any]:
    from . import drawing, truth

    items = list(scene.items)
    return truth.truth_of(scene, items, drawing.sights(scene), "picture.png"), drawing.draw(scene)


def _photographed(scene: Scene, samples: int, percent: int, render: bool) -> tuple[dict[str, Any], Any]:
    from . import pieces, studio, truth

    things = pieces.settle(scene.items)
    objects = studio.build(scene, things)
    shown = studio.seen(scene, objects)
    size = scene.camera.image_size
    sights = {}
    for id, obj in objects.items():
        faces = [tuple(p.vertices) for p in obj.data.polygons]
        sights[id] = truth.sight_of(studio.outline_in_picture(scene, obj), faces, shown[id], size)
    document = truth.truth_of(scene, [item for item, _ in things.values()], sights, "picture.png")
    if not render:
        return document, None
    studio.build(scene, things)
    return document, studio.photograph(scene, samples or scene.look.samples, percent)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("rooms", nargs="*", choices=[*ROOMS, []], help="all when none is named")
    parser.add_argument("--out", type=Path, default=FOLDER)
    parser.add_argument("--samples", type=int, default=0)
    parser.add_argument("--percent", type=int, default=100)
    parser.add_argument("--no-render", action="store_true")
    options = parser.parse_args()
    for room in options.rooms or ROOMS:
        started = time.monotonic()
        truth = make(room, options.out / room, options.samples, options.percent, not options.no_render)
        print(f"{room}: {len(truth['objects'])} objects, {time.monotonic() - started:.0f} s")


if __name__ == "__main__":
    main()
