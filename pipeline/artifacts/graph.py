# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 2: the scene graph and the sidecar of minor objects."""

from __future__ import annotations

from typing import Literal

from .analysis import Finding
from .common import Artifact

NodeKind = Literal["room", "wall", "opening", "major", "minor"]
EdgeSource = Literal["structure", "geometry", "model"]


class GraphNode(Artifact):
    """A room, wall, opening or object. `attributes` are short facts in words."""

    id: str
    kind: NodeKind
    category: str
    attributes: dict[str, str] = {}


class GraphEdge(Artifact):
    """`source relation target`, for example bed_1 against_wall wall_n. `origin` says who claims it."""

    source: str
    relation: str
    target: str
    origin: EdgeSource


class SceneGraph(Artifact):
    """Nodes and edges; every edge joins two existing nodes."""

    nodes: list[GraphNode]
    edges: list[GraphEdge]
    findings: list[Finding] = []


class MinorObjects(Artifact):
    """Ids of the minor objects by the id of what carries them ("" for the room itself)."""

    by_parent: dict[str, list[str]]
