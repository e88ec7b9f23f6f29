# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist changed by hand."""

from __future__ import annotations

from .analysis import Finding
from .common import Artifact
from .layout import LayoutEdit


class HandEdits(Artifact):
    """Edits read back from the scene or the program's text at one time, in the order in which they apply.

    Attributes:
        findings: what came with them, and what could not be done.
    """

    edits: list[LayoutEdit]
    findings: list[Finding] = []
