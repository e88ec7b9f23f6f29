# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen through the windows of a room by day, in pictures taken inside it.

Round a room seen from above lies what lies round it in the picture, often grey. Inside, with an exposure for walls, a window of
that grey would be a blind one: there the sky is as bright as a photograph of such a room shows it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..light.tone import luminance, scene_light, shown

SEEN_NODE = "What a camera sees"
"""Label of the world's node for what lies round the room and outside its windows (`scene/lighting.py`)."""
_DAY = 0.6
"""On the screen, round the room; what is darker is an evening, and stays."""
_SKY: tuple[tuple[float, float, tuple[float, float, float]], ...] = (
    (-0.3, 0.74, (1.0, 1.0, 0.94)), (-0.03, 0.83, (0.97, 1.0, 1.0)), (0.04, 0.9, (0.93, 1.0, 1.06)),
    (0.3, 0.84, (0.74, 0.96, 1.24)),
)  # fmt: skip
"""Height of what is looked at (the sine of its angle above the horizon), how bright it is on the screen, and its hue.

Ground, haze, the horizon and the sky: bright, but not burnt out, and different enough that a pane is not a lamp.
"""


def brighten_outside(stage: Any, exposure: float) -> Any | None:
    """Give a scene that pictures are taken in a world of its own with a bright sky; None where it is none of ours, or dark.

    The light that comes from the world stays as it is. The caller removes the world with the scene.

    Args:
        exposure: the room's, in stops; that of the scene may be this view's own.
    """
    node = _seen(stage.world)
    if node is None:
        return None
    view = stage.view_settings
    transform, look = view.view_transform, "" if view.look == "None" else view.look
    now = float(luminance(np.array(node.inputs["Color"].default_value[:3]))) * 2.0**exposure
    if float(shown(np.array([now]), transform, look)[0]) < _DAY:
        return None
    world = stage.world.copy()
    bright = scene_light(np.array([light for _, light, _ in _SKY]), transform, look)
    colours = bright[:, None] * np.array([hue for _, _, hue in _SKY]) / 2.0**view.exposure
    _shade(world, [height for height, _, _ in _SKY], colours)
    stage.world = world
    return world


def _shade(world: Any, heights: list[float], colours: NDArray[np.float64]) -> None:
    """Let what a camera sees go from colour to colour with the height of what it looks at."""
    tree, seen = world.node_tree, _seen(world)
    assert seen is not None
    place, parts, height, ramp = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "MapRange", "ValToRGB")
    )
    tree.links.new(place.outputs["Generated"], parts.inputs["Vector"])
    tree.links.new(parts.outputs["Z"], height.inputs["Value"])
    height.inputs["From Min"].default_value, height.inputs["From Max"].default_value = -1.0, 1.0
    tree.links.new(height.outputs["Result"], ramp.inputs["Fac"])
    stops = ramp.color_ramp.elements
    while len(stops) < len(heights):
        stops.new(1.0)
    for stop, at in zip(stops, heights, strict=True):
        stop.position = (at + 1.0) / 2.0
    for stop, colour in zip(stops, colours, strict=True):
        stop.color = (*(float(v) for v in colour), 1.0)
    tree.links.new(ramp.outputs["Color"], seen.inputs["Color"])


def _seen(world: Any) -> Any | None:
    tree = world.node_tree if world is not None else None
    return (
        next((n for n in tree.nodes if n.label == SEEN_NODE and n.type == "BACKGROUND"), None)
        if tree is not None
        else None
    )
