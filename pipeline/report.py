# SPDX-License-Identifier: GPL-3.0-or-later
"""`report.html`: what a run did, on one page that opens anywhere without a network.

It is made from what memory holds, so a report of a room that was resumed tells of every stage, not only of the last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .artifacts.analysis import Calibration, Finding, SceneAnalysis
from .artifacts.correction import CorrectionReport
from .artifacts.graph import SceneGraph
from .artifacts.hand import HandEdits
from .artifacts.layout import LayoutProgram, LedgerEntry, ProxyLine
from .artifacts.light import LightPlan
from .artifacts.materials import Materials
from .artifacts.surfaces import SmallObjects
from .artifacts.textures import Textures
from .ask_replaced import replaced_answers
from .errors import RoomError
from .memory import Memory
from .program.lines import parse_layout
from .report_finish import fixes_section, light_section, materials_section, textures_section
from .report_page import Column, Content, Markup, contents, element, figure, heading, page, table
from .report_scores import rounds_section
from .report_stages import stages_table
from .report_words import numbers, words
from .run import StageReport

LAYOUT_STAGE = "s03_layout"
RENDER = "render_"
"""Before the ids of cameras among the report's pictures."""
CAPTIONS = {
    "reference": "The picture",
    RENDER + "reference": "The finished room, rendered as in the picture",
    "top": "The room through the fitted camera",
    RENDER + "eye_1": "Rendered at eye level",
    RENDER + "eye_2": "Rendered at eye level, from elsewhere",
    RENDER + "top": "Rendered from above",
    "view": "The room from the side",
    "overlay": "The layout drawn over the picture",
}
"""Every picture that is known, in the order in which they are shown."""
_SEVERITIES = {"error": "What went wrong", "warning": "Worth a look", "note": "Repaired or noted on the way"}
_SCALE = {
    "known width": "from the width that you gave",
    "model": "from the sizes that were recognised",
    "door": "from the height of a door",
}


def make_report(
    memory: Memory, pictures: Mapping[str, bytes], reports: Sequence[StageReport] = (), describes: str = ""
) -> str:
    """The report as one HTML page, with the pictures inside it.

    Args:
        pictures: PNG or JPEG bytes by name: those of `CAPTIONS`, further renders as "render_" and the camera's id, and
            textures as "texture/" and their image's name; any may be missing.
        reports: what the stages of this run took; stages of earlier runs are told from memory.
        describes: one sentence on what answers now (`ModelClient.describes`).
    """
    name = memory.picture_name or "a picture"
    materials = memory.latest(Materials)
    sections: list[tuple[str, str, list[Content]]] = [
        ("materials", "Materials", materials_section(materials)),
        ("textures", "Textures", textures_section(memory.latest(Textures), pictures, materials)),
        ("light", "Light", light_section(memory.latest(LightPlan))),
        ("corrections", "Corrections", fixes_section(memory.latest(CorrectionReport))),
        ("layout", "Layout, round by round", rounds_section(memory.latest(LayoutProgram, (LAYOUT_STAGE,)))),
        ("objects", "Objects", _objects(memory)),
        ("stages", "Stages, time and cost", [stages_table(memory, reports)]),
        ("findings", "Findings", _findings(memory)),
    ]
    sections = [section for section in sections if section[2]]
    first, more = _figures(pictures)
    parts: list[Content] = [
        element("h1", f"Room from {name}"),
        element("p", "What was seen, how it was built, and what it took.", of="lead"),
        contents((anchor, title.partition(",")[0]) for anchor, title, _ in sections),
        first,
        _facts(memory),
        element("p", element("strong", "Answered by: "), answered_by(memory, describes), of="answered"),
        more,
    ]
    for anchor, title, inside in sections:
        parts += [heading(title, anchor), *inside]
    parts.append(element("footer", "Made by Code-as-Room. Sizes are in metres; this page needs no network."))
    return page(f"Room from {name}", parts)


def answered_by(memory: Memory, describes: str = "") -> str:
    """One sentence on what answered, from the answers that memory keeps."""
    clients = list(dict.fromkeys(e.meta.client for e in memory.entries if e.type == "Answer"))
    if len(clients) <= 1 and describes:
        return describes
    said = []
    for client in clients:
        models = {e.meta.model for e in memory.entries if e.type == "Answer" and e.meta.client == client}
        models -= {"", client}
        said.append(f"{_client_words(client)} ({', '.join(sorted(models))})" if models else _client_words(client))
    return "; ".join(said) or describes or "nothing has answered yet"


def _client_words(client: str) -> str:
    if client == "builtin":
        return "the built-in picture analysis, no model"
    known = {"recorded": "recorded answers", "manual": "a chat, asked by hand"}
    return known.get(client.split(":")[0]) or client or "an unknown client"


def _facts(memory: Memory) -> Markup:
    calibration, analysis = memory.latest(Calibration), memory.latest(SceneAnalysis)
    program = memory.latest(LayoutProgram)
    facts: list[tuple[str, str, str]] = []
    if calibration is not None:
        width, depth = floor_size(calibration)
        spread = f", give or take {calibration.scale_spread:.0%}" if calibration.scale_spread else ""
        source = _SCALE.get(calibration.scale_source, f"from the {calibration.scale_source}")
        facts.append(("Room", f"{width:.2f} x {depth:.2f} x {calibration.height:.2f} m", f"{source}{spread}"))
        camera = calibration.camera
        facts.append(("Camera", camera.kind, f"corners fit within {calibration.error_px:.1f} px"))
    if analysis is not None:
        corners = f"{len(analysis.floor)} floor corners, {len(analysis.architecture)} doors, windows and other fittings"
        facts.append(("Seen", f"{len(analysis.objects)} objects", corners))
    if program is not None and program.ledger:
        facts.append(("Placed", _counted(program.ledger), ""))
    if program is not None:
        facts.append(("Layout score", f"{program.score.total:.2f}", "1 is best; measured against the picture"))
    prompt, completion, cost = memory.cost()
    if prompt or completion:
        price = f"{cost:.4f} US dollars" if cost else "cost not told by the service"
        facts.append(("Tokens", f"{prompt + completion:,}".replace(",", " "), price))
    return element(
        "dl",
        *(element("div", element("dt", k), element("dd", v, element("small", s) if s else None)) for k, v, s in facts),
        of="facts",
    )


def floor_size(calibration: Calibration) -> tuple[float, float]:
    """Width and depth of the floor's bounding rectangle, metres."""
    xs, ys = [p[0] for p in calibration.floor], [p[1] for p in calibration.floor]
    return (max(xs) - min(xs), max(ys) - min(ys)) if xs else (0.0, 0.0)


def _counted(ledger: Sequence[LedgerEntry]) -> str:
    states = [entry.state for entry in ledger]
    said = [f"{states.count(s)} {s}" for s in ("detailed", "placed", "deferred", "dropped") if s in states]
    return ", ".join(said)


def _figures(pictures: Mapping[str, bytes]) -> tuple[Markup, Markup]:
    """The picture beside what became of it; and all further pictures but the textures, the known ones first."""
    others = {
        n: f"Rendered through {n.removeprefix(RENDER)}" for n in pictures if n.startswith(RENDER) and n not in CAPTIONS
    }
    found = [figure(pictures.get(name), caption) for name, caption in {**CAPTIONS, **others}.items()]
    shown = [f for f in found if f is not None]
    return element("div", *shown[:2], of="pictures"), element("div", *shown[2:], of="pictures more")


def _objects(memory: Memory) -> list[Content]:
    analysis, program = memory.latest(SceneAnalysis), memory.latest(LayoutProgram)
    if analysis is None or not analysis.objects:
        return []
    ledger = {entry.id: entry for entry in program.ledger} if program else {}
    proxies = _proxies(program)
    columns = [Column("Object"), Column("Category", prose=True), Column("Stands"), Column("State")]
    columns += [Column("Width x depth x height", number=True), Column("Centre", number=True), Column("Why", prose=True)]
    rows: list[list[Content]] = []
    for item in analysis.objects:
        entry, proxy = ledger.get(item.id), proxies.pop(item.id, None)
        state = entry.state if entry else "placed" if proxy else "detected"
        stands = f"on {item.parent}" if item.parent else item.placement
        rows.append([element("code", item.id), words(item.category), stands, element("span", state, of=f"chip {state}"),
                     *_place(proxy), entry.reason if entry else ""])  # fmt: skip
    for proxy in proxies.values():
        added = element("span", "placed", of="chip placed")
        rows.append(
            [element("code", proxy.id), words(proxy.category), proxy.placement, added, *_place(proxy), "added later"]
        )
    intro = "Every object that was detected is here: placed, deferred to a later stage, or dropped with the reason."
    return [element("p", intro), table(columns, rows)]


def _proxies(program: LayoutProgram | None) -> dict[str, ProxyLine]:
    try:
        return {p.id: p for p in parse_layout(program.text).proxies} if program else {}
    except RoomError:  # a program that an artist wrote by hand may hold more than layout lines
        return {}


def _place(proxy: ProxyLine | None) -> list[Content]:
    return [numbers(proxy.size, " x "), numbers(proxy.centre)] if proxy else ["", ""]


def all_findings(memory: Memory) -> list[Finding]:
    """What every current artifact reports, and what did not come from the model; each sentence once, errors first."""
    artifacts = (
        memory.latest(SceneAnalysis),
        memory.latest(Calibration),
        memory.latest(SceneGraph),
        memory.latest(LayoutProgram, (LAYOUT_STAGE,)),
        memory.latest(LayoutProgram),
        memory.latest(SmallObjects),
        memory.latest(Materials),
        memory.latest(Textures),
        memory.latest(LightPlan),
        memory.latest(HandEdits),
    )
    findings = [finding for artifact in artifacts if artifact is not None for finding in artifact.findings]
    findings += replaced_answers(memory)
    found = {(f.severity, f.about, f.message): f for f in findings}
    order = list(_SEVERITIES)
    return sorted(found.values(), key=lambda f: order.index(f.severity))


def _findings(memory: Memory) -> list[Content]:
    found = all_findings(memory)
    if not found:
        return [element("p", "Nothing had to be repaired or doubted.")]
    parts: list[Content] = []
    for severity, title in _SEVERITIES.items():
        group = [f for f in found if f.severity == severity]
        if group:
            items = [element("li", element("code", f.about), " ", f.message) for f in group]
            parts.append(
                element("section", element("h3", f"{title} ({len(group)})"), element("ul", *items), of=severity)
            )
    return parts
