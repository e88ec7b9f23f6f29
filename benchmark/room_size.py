# SPDX-License-Identifier: GPL-3.0-or-later
"""How long room.py is, and what its length is made of: `python -m benchmark.room_size [FOLDER...] [--kinds 24] [--build]`.

Always a room of 100 objects, furnished with library pieces, with finishes of every family, lights, cameras and pictures;
and the rooms of FOLDERs that the command line wrote. `--build` also times plain Blender making it.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.assemble import MARKER, MOST_BYTES, assemble, assemble_file, prelude_text, room_part

COUNT = 100
KINDS = (
    "double_bed", "nightstand", "wardrobe", "desk", "chair", "bookcase", "sofa", "armchair", "coffee_table", "floor_rug",
    "picture_frame", "book_stack", "table_lamp", "floor_lamp", "potted_plant", "curtain_pair", "bed_pillow", "mug", "plate",
    "wall_mirror", "flower_vase", "laptop", "throw_blanket", "sideboard", "office_chair", "stool", "dining_table", "wall_clock",
    "tv_stand", "monitor", "keyboard", "bowl", "bottle", "candle", "tray", "teapot", "chandelier", "pendant", "side_table",
    "ottoman", "wing_chair", "indoor_tree", "upright_piano", "glass_cabinet", "vanity", "alarm_clock", "speaker",
    "photo_frame", "fruit_bowl", "small_plant",
)  # fmt: skip
"""Pieces of the library, the most usual ones first."""
LOOKS = (
    'wood("#8A5F3C")', 'planks("#A9825A")', 'painted_wood("#E8E2D6")', 'wicker("#B08A5A")', 'fabric("#7A8B6F")',
    'linen("#D9C7A8")', 'velvet("#3E4A56")', 'knit("#C9B8A0")', 'carpet("#9A8F80")', 'leather("#5A3A28")', 'metal("#8A8A8C")',
    'glass("#E8F0F0")', 'mirror_glass("#F0F0F0")', 'marble("#E8E6E2")', 'stone("#8C8880")', 'tile("#C8D0D0")',
    'concrete("#9A9A96")', 'plaster("#E6E0D4")', 'ceramic("#F2EEE6")', 'plastic("#303438")', 'rubber("#2A2A2A")',
    'paper("#F4EEDC")', 'foliage("#4A6A3A")', 'soil("#4A3A2C")', 'water("#A8C8D0")', 'screen("#101418")', 'shade("#F0E0C0")',
    'glow("#FFD8A0")', 'principled(base=picture("print"), roughness=0.7, bump=bump(noise_map(0.02), 0.001))',
    'principled(base=ramp(wave_map(0.05), [(0, "#6A4A32"), (1, "#8A6A4A")]), roughness=mix(0.3, 0.7, voronoi_map(0.04)))',
    'principled(base=mix("#B08060", "#908070", brick_map((0.2, 0.1))), metallic=0.1)',
)  # fmt: skip
SHELL = """# Shell
room(size=(12, 9, 2.7), floor=[(-6, -4.5), (6, -4.5), (6, 4.5), (-6, 4.5)])
wall("wall_s", (-6, -4.5), (6, -4.5), height=2.7, thickness=0.12)
wall("wall_e", (6, -4.5), (6, 4.5), height=2.7, thickness=0.12)
wall("wall_n", (6, 4.5), (-6, 4.5), height=2.7, thickness=0.12)
wall("wall_w", (-6, 4.5), (-6, -4.5), height=2.7, thickness=0.12)

# Doors, windows and openings
door("door_1", wall="wall_s", start=(4, -4.5), end=(4.9, -4.5), height=2.05, open=60)
window("window_1", wall="wall_n", start=(1, 4.5), end=(-1, 4.5), sill=0.9, height=1.3)
opening("opening_1", wall="wall_e", start=(6, -1), end=(6, 0.2), sill=0, height=2.2)
"""
LIGHTS = """# Lights
light("sun_1", "sun", at=(0, 0, 6), energy=3, color=(1, 1, 1), size=0.01, target=(1, -1, 0), kelvin=5600)
light("window_1_light", "area", at=(0, 4.3, 1.6), energy=120, color=(1, 1, 1), size=2, target=(0, 0, 1), size_y=1.3)
light("lamp_1_light", "point", at=(2, 1, 1.4), energy=20, color=(1, 0.9, 0.8), size=0.05, kelvin=2700)
light("spot_1", "spot", at=(-2, 1, 2.5), energy=60, color=(1, 1, 1), size=0.05, target=(-2, 1, 0))
world("world_1", color=(1, 1, 1), strength=0.4, kelvin=7000, background=(0.8, 0.9, 1))

# Cameras
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 14, 0, 0, 0, 1), fov_y=0.7, image_size=(1200, 900))
camera("top", "orthographic", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 8, 0, 0, 0, 1), ortho_height=10, image_size=(1200, 900))
view("view_1", exposure=0.3, transform="AgX", look="", ceiling=2.7, cut=2.0)
"""


def make_room(kinds: int = 24, count: int = COUNT) -> str:
    """A room text of so many objects of so many kinds, each function written once, as the stages write it."""
    names = list(KINDS[:kinds])
    pieces = catalogue.pieces()
    proxies, furnish, finishes = ["# Objects"], [], ["# Materials"]
    finishes += [f"look_{n} = {look}" for n, look in enumerate(LOOKS)]
    finishes += ['finish("floor", look_1)', 'finish("walls", look_17)', 'finish("skirting", look_2)']
    for n in range(count):
        name = names[n % len(names)]
        piece = pieces[name]
        w, d, h = (round(side * (1 - 0.01 * (n // len(names))), 4) for side in piece.typical)
        x, y = -5.4 + 1.2 * (n % 10), -4 + 0.9 * (n // 10)
        proxies.append(
            f'proxy("{name}_{n}", "{piece.words[0]}", centre=({x:.4g}, {y:.4g}, {h / 2:.4f}), size=({w}, {d}, {h}), '
            f'yaw={15 * (n % 24)}, placement="floor",\n    salience="major", label="{piece.title.lower()[:60]}")'
        )
        furnish.append(f'furnish("{name}_{n}", {name}{", lying=True" if name == "throw_blanket" else ""})')
        looks = f'"": look_{n % len(LOOKS)}, "wood": look_{(n + 7) % len(LOOKS)}, "metal": look_{(n + 13) % len(LOOKS)}'
        finishes.append(f'finish("{name}_{n}", {{{looks}}})')
    parts = [SHELL, "\n".join(proxies) + "\n", LIGHTS, "# Furniture library\n" + catalogue.source(sorted(names))]
    return "\n".join([*parts, "", "\n".join(furnish), "", "\n".join(finishes), "", "build()", ""])


def told(name: str, room_text: str) -> int:
    """Print what a room's file is made of; returns its bytes."""
    began = time.perf_counter()
    text = assemble(room_text)
    seconds = time.perf_counter() - began
    began = time.perf_counter()
    file = assemble_file(room_text)
    more = time.perf_counter() - began
    above, _, room = file.partition(f"\n\n{MARKER}\n")
    size = len(file.encode())
    print(f"{name}: {size:,} bytes (at most {MOST_BYTES:,}) {'reached' if size <= MOST_BYTES else 'NOT REACHED'}")
    print(
        f"  prelude {len(above.encode()):,} of {len(prelude_text().encode()):,}; room {len(room.encode()):,} of {len(room_text.encode()):,}"
    )
    print(f"  in the .blend {len(text.encode()):,}; written in {seconds:.2f} s, the file in {more:.2f} s more")
    sections = re.split(r"^# ---- (.+?) -+$", above, flags=re.MULTILINE)
    largest = sorted(zip(sections[1::2], sections[2::2], strict=True), key=lambda pair: -len(pair[1]))[:8]
    print("  largest sections: " + ", ".join(f"{title} {len(body) / 1000:.1f} kB" for title, body in largest))
    return size


def build_seconds(full: str) -> float:
    """How long plain Python with bpy takes for a room.py, without starting."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "room.py").write_text(full, encoding="utf-8")
        code = "import runpy, time, bpy; t = time.perf_counter(); runpy.run_path('room.py'); print(time.perf_counter() - t)"
        done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    return float(done.stdout.split()[-1])


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("folders", nargs="*", type=Path)
    options.add_argument("--kinds", type=int, default=24, help="different pieces among the 100 objects")
    options.add_argument("--build", action="store_true")
    chosen = options.parse_args(arguments)
    prelude_text()
    for folder in chosen.folders:
        told(str(folder), room_part((folder / "room.py").read_text(encoding="utf-8")))
    text = make_room(chosen.kinds)
    told(f"{COUNT} objects of {chosen.kinds} kinds", text)
    if chosen.build:
        print(f"  made by plain Blender in {build_seconds(assemble_file(text)):.1f} s")


if __name__ == "__main__":
    main()
