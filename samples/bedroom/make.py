"""Makes the sample bedroom: `picture.png` and `truth.json` beside this file.

.venv/bin/python samples/bedroom/make.py [--out DIR] [--percent 100] [--samples 16] [--blend FILE] [--no-render]
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import bpy
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent))

import scene
from truth import scene_truth

PAPER = (250, 249, 247)


def render(picture: Path, samples: int, percent: int) -> None:
    """Renders through the camera and lays the result on near-white paper."""
    scene.set_render(samples, percent)
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "raw.png"
        bpy.context.scene.render.filepath = str(raw)
        bpy.ops.render.render(write_still=True)
        with Image.open(raw) as image:
            paper = Image.new("RGBA", image.size, (*PAPER, 255))
            paper.alpha_composite(image.convert("RGBA"))
            paper.convert("RGB").save(picture, optimize=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--percent", type=int, default=100, help="size of the picture in per cent")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--blend", type=Path, help="also save the scene")
    parser.add_argument("--no-render", action="store_true", help="build and check only")
    args = parser.parse_args()
    started = time.time()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    roots = scene.add_items()
    scene.add_shell()
    scene.add_light(roots)
    camera = scene.add_camera()
    args.out.mkdir(parents=True, exist_ok=True)
    truth = scene_truth(roots, camera, "picture.png")
    (args.out / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    print(f"{len(truth['objects'])} objects, every mesh within its box; built in {time.time() - started:.0f} s")
    if args.blend:
        bpy.ops.wm.save_as_mainfile(filepath=str(args.blend))
    if not args.no_render:
        render(args.out / "picture.png", args.samples, args.percent)
        print(f"{args.out / 'picture.png'} after {time.time() - started:.0f} s")


if __name__ == "__main__":
    main()
