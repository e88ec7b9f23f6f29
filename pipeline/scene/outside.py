# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen through the windows of a room by day, in pictures taken inside it.

Round a room seen from above lies what lies round it in the picture, often grey. Inside, with an exposure for walls, a window of
that grey would be a blind one: there the sky is as bright as a photograph of such a room shows it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..light.tone import luminance, scene_light, shown

SEEN_NODE = "What a camera sees"
"""Label of the world's node for what lies round the room and outside its windows (`scene/lighting.py`)."""
_DAY = 0.6
"""On the screen, round the room; what is darker is an evening, and stays."""
_SKY, _HUE = 0.88, (0.9, 1.0, 1.09)
"""On the screen: bright, but not burnt out, and blue enough to be a sky."""


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
    sky = scene_light(np.array([_SKY]), transform, look) * np.array(_HUE) / 2.0**view.exposure
    own: Any = _seen(world)
    former = np.array(own.inputs["Color"].default_value[:3])
    own.inputs["Color"].default_value = (*(float(v) for v in np.maximum(sky, former)), 1.0)
    stage.world = world
    return world


def _seen(world: Any) -> Any | None:
    tree = world.node_tree if world is not None else None
    return (
        next((n for n in tree.nodes if n.label == SEEN_NODE and n.type == "BACKGROUND"), None)
        if tree is not None
        else None
    )
