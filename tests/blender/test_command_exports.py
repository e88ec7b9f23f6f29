# SPDX-License-Identifier: GPL-3.0-or-later
"""`--glb` and `--usd` of the command: what an artist takes to another program lies beside the other results."""

from __future__ import annotations

import json
import struct
import zipfile
from typing import Any


def test_the_room_is_written_for_other_programs(room: Any) -> None:
    done = room.make("--glb", "--usd")
    assert done.code == 0 and {"room.glb", "room.usdz", "room.py"} <= {p.name for p in room.out.iterdir()}
    assert "room.glb" in done.out and "room.usdz" in done.out
    data = (room.out / "room.glb").read_bytes()
    document = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    assert {"floor", "bed", "closet", "chair"} <= {node["name"] for node in document["nodes"]}
    with zipfile.ZipFile(room.out / "room.usdz") as package:
        assert package.testzip() is None
    assert not [p for p in room.out.iterdir() if p.name.startswith(".part")]
