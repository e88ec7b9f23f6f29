# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages, in their order."""

from __future__ import annotations

from .base import Stage


def all_stages() -> tuple[Stage, ...]:
    """Every stage that this version has, in the order in which they run."""
    from . import (
        s01_analysis,
        s02_graph,
        s03_layout,
        s04_auxiliary,
        s05_descriptions,
        s06_geometry,
        s07_surfaces,
        s08_materials,
        s09_textures,
        s10_finish,
    )

    return (
        s01_analysis.STAGE,
        s02_graph.STAGE,
        s03_layout.STAGE,
        s04_auxiliary.STAGE,
        s05_descriptions.STAGE,
        s06_geometry.STAGE,
        s07_surfaces.STAGE,
        s08_materials.STAGE,
        s09_textures.STAGE,
        s10_finish.STAGE,
    )
