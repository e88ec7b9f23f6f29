# SPDX-License-Identifier: GPL-3.0-or-later
"""How written meshes look: round things smooth, their edges sharp, a texture on every face."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.prelude import growing, operations, profiles, solids
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.scene.arrays import mesh_arrays
from code_as_room.pipeline.scene.meshes import is_hand_made, write_arrays


def written(*shapes: Any, furniture: bool = False) -> Any:
    mesh = bpy.data.meshes.new("test")
    write_arrays(mesh, mesh_arrays(list(shapes), furniture=furniture), "table", "digest")
    return mesh


def sharp(mesh: Any) -> set[tuple[int, ...]]:
    return {tuple(sorted(edge.vertices)) for edge in mesh.edges if edge.use_edge_sharp}


@pytest.mark.parametrize("segments", [6, 8, 12, 24, 64])
def test_a_cylinder_is_round_and_its_rims_are_sharp(segments: int) -> None:
    mesh = written(solids.cylinder(0.3, 0.5, segments=segments))
    rims = {
        tuple(sorted((ring * segments + i, ring * segments + (i + 1) % segments)))
        for ring in (0, 1)
        for i in range(segments)
    }
    assert sharp(mesh) == rims and all(face.use_smooth for face in mesh.polygons)


def test_flat_things_stay_flat_and_soft_ones_have_no_sharp_edges() -> None:
    box = written(solids.box((1, 1, 1)))
    assert not sharp(box) and not any(face.use_smooth for face in box.polygons)
    ball = written(solids.sphere(1, segments=8, rings=6), growing.leaves(3, 0.3, 0.1, kind="succulent"))
    assert not sharp(ball) and all(face.use_smooth for face in ball.polygons)


def test_a_program_can_say_what_is_sharp() -> None:
    octagon = operations.smooth(solids.prism(8, 0.3, 0.5))
    round_one = operations.smooth(solids.prism(8, 0.3, 0.5), angle=50)
    assert len(sharp(written(octagon))) == 24 and len(sharp(written(round_one))) == 16


def test_mixed_parts_keep_their_own_edges() -> None:
    leg, top = solids.cylinder(0.03, 0.7, segments=8), solids.box((1, 1, 0.03))
    together = operations.join([leg, operations.move(leg, (0.5, 0, 0)), top])
    assert isinstance(together, Shape) and together.smooth
    mesh = written(together)
    assert len(sharp(mesh)) == 2 * 16 + 12


def test_every_corner_gets_its_texture_in_metres() -> None:
    mesh = written(solids.box((2, 1, 0.5)), profiles.tube([(0, 0, 0), (0, 0, 1)], 0.1))
    assert len(mesh.uv_layers) == 1
    uvs = np.array([tuple(c.vector) for c in mesh.uv_layers[0].uv])
    for face in list(mesh.polygons)[:6]:
        corners = uvs[list(face.loop_indices)]
        area = abs(np.cross(corners[1] - corners[0], corners[2] - corners[1]))
        assert area == pytest.approx(face.area, rel=1e-5)


def test_marks_and_textures_are_not_taken_for_hand_edits() -> None:
    mesh = written(solids.cylinder(0.3, 0.5), solids.box((1, 1, 1)))
    assert not is_hand_made(mesh)
    mesh.vertices[0].co.x += 0.01
    assert is_hand_made(mesh)


def test_nothing_and_outlines_alone_can_be_written() -> None:
    outline = Shape(np.zeros((2, 3)), (), extra={"edges": ((0, 1),)})
    assert len(written(outline).edges) == 1
    assert len(written().vertices) == 0


def test_boards_in_one_plane_are_drawn_apart_and_the_last_lies_on_top() -> None:
    """Cycles renders faces that lie in one place black: each shades the other."""
    post, rail = solids.box((0.1, 0.04, 1.0), at=(0, 0, 0.5)), solids.box((0.8, 0.04, 0.1), at=(0.3, 0, 0.95))
    mesh = written(post, rail, furniture=True)
    points = np.array([vertex.co for vertex in mesh.vertices])
    first, last = points[: len(post.vertices)], points[len(post.vertices) :]
    assert np.allclose(last, rail.vertices, atol=1e-6)  # what is seen of an object is where it was put
    assert first[:, 1].min() - last[:, 1].min() == pytest.approx(5e-5, abs=1e-6)
    many = written(*(solids.box((0.002, 1, 1)) for _ in range(40)), furniture=True)
    points = np.array([vertex.co for vertex in many.vertices])
    assert np.ptp(points[:, 0]) > 0.0018 and 1.0 - np.ptp(points[:8, 1]) < 0.0016
