# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and views as they stand, when only some objects are modelled anew: nothing is asked or measured.

Another desk gives back a little more or less light. Measured again, that would be another exposure by a thousandth, and all
lamps of the room would glow otherwise for it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..artifacts.correction import CorrectionReport
from ..artifacts.layout import Layout, LightLine, ProxyLine
from ..artifacts.light import LightStyle
from ..program.edits import LISTS
from ..program.prelude.shape import Shape
from .lights import lamp_lights


def as_it_stands(
    layout: Layout,
    standing: Layout,
    lamps: Sequence[ProxyLine],
    shapes: Mapping[str, Sequence[Shape]],
    style: LightStyle,
) -> Layout:
    """The layout with the lights, sky, exposure and cameras of the one that stands.

    Lamps shine from where their bulbs are now, those that shine in `standing`; the others stay dark.

    Args:
        lamps: all of the layout. shapes: their parts, by id. style: of the light that stands.
    """
    present = {line.id for name in ("proxies", *LISTS) for line in getattr(layout, name)}
    shining = {light.parent for light in standing.lights if light.energy > 0}
    kept = [light for light in standing.lights if light.id not in present and _stays(light, layout, lamps)]
    taken = present | _ids(*kept, *standing.worlds, *standing.views, *standing.cameras)
    own = [light for lamp in lamps if lamp.id in shining for light in lamp_lights(lamp, shapes[lamp.id], style, taken)]
    return layout.model_copy(
        update={
            "lights": [*layout.lights, *kept, *own],
            "worlds": standing.worlds,
            "views": standing.views,
            "cameras": [*layout.cameras, *(camera for camera in standing.cameras if camera.id not in present)],
        }
    )


def _stays(light: LightLine, layout: Layout, lamps: Sequence[ProxyLine]) -> bool:
    """Whether a light belongs to no lamp, and to nothing that is gone."""
    there = {line.id for name in ("proxies", "walls", "doors", "windows") for line in getattr(layout, name)}
    return not light.parent or (light.parent in there and light.parent not in {lamp.id for lamp in lamps})


def _ids(*lines: Any) -> set[str]:
    return {str(line.id) for line in lines}


def with_former_fixes(report: CorrectionReport, former: CorrectionReport | None, layout: Layout) -> CorrectionReport:
    """The report of a room whose light stands, with what was mended on that light before, since it still holds."""
    if former is None:
        return report
    own = _ids(*layout.cameras, *layout.worlds, *layout.views)
    own |= {light.id for light in layout.lights if light.parent not in {p.id for p in layout.proxies}}
    known = {(fix.kind, fix.id) for fix in report.fixes}
    kept = [f for f in former.fixes if f.kind in ("light", "camera") and f.id in own and (f.kind, f.id) not in known]
    return report.model_copy(update={"fixes": [*report.fixes, *kept]})
