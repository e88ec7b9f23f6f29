# SPDX-License-Identifier: GPL-3.0-or-later
"""What a graphics card draws with the camera's matrices lies where the camera model puts it."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.geometry.camera import GeometryError, camera_from, project, tilt_rotation, to_plane
from code_as_room.pipeline.geometry.projection import projection_matrix, view_matrix
from hypothesis import given
from hypothesis import strategies as st

angles, places = st.floats(-25, 25), st.floats(0, 1000)


@given(
    kind=st.sampled_from(["perspective", "orthographic"]),
    tilt=st.tuples(angles, angles, st.floats(-180, 180)),
    principal=st.tuples(st.floats(200, 800), st.floats(200, 800)),
    size=st.tuples(st.integers(200, 3000), st.integers(200, 3000)),
    spot=st.tuples(places, places),
    z=st.floats(0, 2.5),
)
def test_clip_space_is_the_picture(kind, tilt, principal, size, spot, z) -> None:  # type: ignore[no-untyped-def]
    scale = size[1] * (1.1 if kind == "perspective" else 0.2)
    camera = camera_from(kind, (0.3, -0.5, 8.0), tilt_rotation(*tilt), scale, size, principal)
    [point] = to_plane(camera, [spot], z)
    if not np.isfinite(point).all() or np.abs(point).max() > 60:
        return
    clip = projection_matrix(camera, 0.05, 100.0) @ view_matrix(camera) @ np.append(point, 1.0)
    x, y, depth = clip[:3] / clip[3]
    assert ((x + 1) * 500, (1 - y) * 500) == pytest.approx(spot, abs=1e-5)
    assert project(camera, [point])[0] == pytest.approx(spot, abs=1e-5)
    assert -1 <= depth <= 1


def test_nearer_things_are_nearer_in_clip_space() -> None:
    camera = camera_from("orthographic", (0, 0, 8.0), np.eye(3), 100, (400, 300))
    matrix = projection_matrix(camera, -1.0, 20.0) @ view_matrix(camera)
    low, high = matrix @ (0, 0, 0, 1), matrix @ (0, 0, 2, 1)
    assert high[2] < low[2]


def test_depths_that_cannot_be_are_refused() -> None:
    camera = camera_from("perspective", (0, 0, 8.0), np.eye(3), 400, (400, 300))
    for near, far in ((0.0, 10.0), (5.0, 5.0), (6.0, 5.0)):
        with pytest.raises(GeometryError):
            projection_matrix(camera, near, far)
