# SPDX-License-Identifier: GPL-3.0-or-later
"""Watches a draft grow in Blender's window: a model's answer is played piece by piece, photographed and measured.

    python tests/desktop/drafting.py --blender /path/to/blender --answer answer.txt [--picture room.png] [--pace 2500]

The answer is the whole text that a model gave to the draft's prompt; `--pace` is characters a second. Screenshots and
`results.json` are written to `--shots`. Needs a screen (a virtual one does).
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from run_panel import ROOT, install_source, start


def record(folder: Path, answer: str, pace: float, more: Path | None) -> None:
    """A folder of recorded answers that holds the draft, and what another one has for the second look."""
    replies = {}
    if more is not None:
        replies = json.loads((more / "replies.json").read_text(encoding="utf-8"))["replies"]
    replies["s00_draft/draft"] = {"text": answer, "model": "played", "characters_a_second": pace}
    text = json.dumps({"format": "code-as-room/replies/1", "replies": replies})
    (folder / "replies.json").write_text(text, encoding="utf-8")


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--blender", default=os.environ.get("BLENDER", "blender"))
    parser.add_argument("--answer", type=Path, required=True)
    parser.add_argument("--picture", type=Path, default=ROOT / "samples" / "bedroom" / "picture.png")
    parser.add_argument("--more", type=Path, help="folder of recorded answers to other questions")
    parser.add_argument("--pace", type=float, default=2500.0)
    parser.add_argument("--profile", action="store_true", help="profile the longest tick of the job too")
    parser.add_argument("--shots", type=Path, default=ROOT / "out" / "drafting")
    options = parser.parse_args()
    shots = options.shots.resolve()
    shots.mkdir(parents=True, exist_ok=True)
    results = shots / "results.json"
    results.unlink(missing_ok=True)
    profile = Path(tempfile.mkdtemp(prefix="code-as-room-drafting-"))
    try:
        install_source(profile)
        replies = profile / "replies"
        replies.mkdir()
        record(replies, options.answer.read_text(encoding="utf-8"), options.pace, options.more)
        environment = {
            "CODE_AS_ROOM_SHOTS": str(shots),
            "CODE_AS_ROOM_PICTURE": str(options.picture.resolve()),
            "CODE_AS_ROOM_REPLIES": str(replies),
            "CODE_AS_ROOM_PROFILE": "1" if options.profile else "",
        }
        start(options.blender, Path(__file__).parent / "inside" / "drafted.py", profile, environment)
    finally:
        shutil.rmtree(profile, ignore_errors=True)
    if not results.is_file():
        print("Blender left no results.", file=sys.stderr)
        return 1
    found = json.loads(results.read_text(encoding="utf-8"))
    profile_text = found.pop("profile", "")
    print(json.dumps(found, indent=1))
    print(profile_text)
    return 0 if all(found["checks"].values()) and not found["error"] else 1


if __name__ == "__main__":
    raise SystemExit(main())
