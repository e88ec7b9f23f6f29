# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist changed by hand."""

from __future__ import annotations

from .common import Artifact
from .layout import LayoutEdit


class HandEdits(Artifact):
    """Edits read back from the scene at one time, in the order in which they apply."""

    edits: list[LayoutEdit]
