# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the README's pictures of the add-on in Blender's real window.

    python tests/desktop/take_screenshots.py --blender "..." [--out docs/pictures]

The sidebar in the middle of a run, editing by hand, and the result, each on the bundled sample with its recorded replies.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from run_panel import ROOT, DesktopError, build_zip, install_zip, start

INSIDE = Path(__file__).with_name("inside") / "screenshots.py"
NAMES = ("sidebar-running.png", "hand-editing.png", "result.png")
COLOURS = 256


def shrink(path: Path) -> None:
    """Keep a picture small enough for a repository; a screen has few colours."""
    from PIL import Image

    with Image.open(path) as image:
        image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--blender", default=os.environ.get("BLENDER", "blender"))
    parser.add_argument("--zip", type=Path)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    environment = {
        "CODE_AS_ROOM_SHOTS": str(options.out.resolve()),
        "CODE_AS_ROOM_PICTURE": str(ROOT / "samples" / "bedroom" / "picture.png"),
        "CODE_AS_ROOM_REPLIES": str(ROOT / "samples" / "bedroom" / "replies"),
    }
    try:
        with tempfile.TemporaryDirectory(prefix="code-as-room-pictures-") as folder:
            profile = Path(folder) / "profile"
            profile.mkdir()
            install_zip(options.blender, options.zip or build_zip(Path(folder) / "zips"), profile)
            start(options.blender, INSIDE, profile, environment)
    except DesktopError as error:
        print(f"screenshots: {error}", file=sys.stderr)
        return 2
    (options.out / "results.json").unlink(missing_ok=True)
    missing = [name for name in NAMES if not (options.out / name).is_file()]
    for name in set(NAMES) - set(missing):
        shrink(options.out / name)
        print(options.out / name)
    if missing:
        print(f"screenshots: not taken: {', '.join(missing)}", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    raise SystemExit(main())
