# SPDX-License-Identifier: GPL-3.0-or-later
"""`report.html`: what a run did, on one page that opens anywhere without a network.

It is made from what memory holds, so a report of a room that was resumed tells of every stage, not only of the last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .artifacts.analysis import Calibration, Finding, SceneAnalysis
from .artifacts.graph import SceneGraph
from .artifacts.hand import HandEdits
from .artifacts.layout import Iteration, LayoutEdit, LayoutProgram, LedgerEntry, ProxyLine
from .artifacts.surfaces import SmallObjects
from .errors import RoomError
from .memory import Entry, Memory
from .program.lines import parse_layout
from .report_page import Column, Content, Markup, bar, element, figure, page, table, together
from .run import StageReport
from .stages import all_stages

LAYOUT_STAGE = "s03_layout"
CAPTIONS = {
    "reference": "The picture",
    "overlay": "The layout drawn over the picture",
    "top": "The room through the fitted camera",
    "view": "The room from the side",
}
PARTS = {
    "coverage": "All there",
    "overlap": "Nothing overlaps",
    "bounds": "Inside the room",
    "relations": "Relations hold",
    "boxes": "Matches the picture",
    "clear": "Doors and windows free",
    "support": "All is carried",
}
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
        pictures: PNG or JPEG bytes by name: "reference", "overlay", "top", "view"; any may be missing.
        reports: what the stages of this run took; stages of earlier runs are told from memory.
        describes: one sentence on what answers now (`ModelClient.describes`).
    """
    name = memory.picture_name or "a picture"
    parts: list[Content] = [
        element("h1", f"Room from {name}"),
        element("p", "What was seen, how it was placed, and what it took.", of="lead"),
        element("p", element("strong", "Answered by: "), answered_by(memory, describes), of="answered"),
        _facts(memory),
        _figures(pictures),
        element("h2", "Stages"),
        _stages(memory, reports),
        *_rounds(memory),
        *_objects(memory),
        *_findings(memory),
        element("footer", "Made by Code-as-Room. Sizes are in metres; this page needs no network."),
    ]
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
    return "recorded answers" if client.split(":")[0] == "recorded" else client or "an unknown client"


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
    said = [f"{states.count(s)} {s}" for s in ("placed", "deferred", "dropped") if s in states]
    return ", ".join(said)


def _figures(pictures: Mapping[str, bytes]) -> Markup:
    figures = [figure(pictures.get(name), caption) for name, caption in CAPTIONS.items()]
    return element("div", *(f for f in figures if f is not None), of="pictures")


def _stages(memory: Memory, reports: Sequence[StageReport]) -> Markup:
    latest = {report.stage: report for report in reports}
    columns = [Column("Stage"), *(Column(t, number=True) for t in ("Time", "Own work", "Calls", "Tokens in", "out"))]
    columns += [Column("Cost", number=True), Column("Prompt text", number=True), Column("Notes", prose=True)]
    rows: list[list[Content]] = []
    totals = [0.0, 0, 0, 0, 0.0]
    for stage in all_stages():
        entry = memory.latest_entry(stage.writes[0].__name__, (stage.id,))
        answers = [e for e in memory.entries if e.type == "Answer" and e.stage == stage.id]
        if entry is None and not answers:
            rows.append([stage.title, *("–" for _ in range(7)), element("span", "not run", of="quiet")])
            continue
        figures = _stage_figures(entry, answers)
        totals = [a + b for a, b in zip(totals, figures, strict=True)]
        seconds, calls, told, said, cost = figures
        report = latest.get(stage.id)
        rows.append(
            [
                stage.title,
                _seconds(seconds) if entry else "–",
                _seconds(report.own_seconds) if report else "–",
                int(calls),
                int(told) or "–",
                int(said) or "–",
                f"${cost:.4f}" if cost else "–",
                f"{report.prompt_bytes / 1000:.1f} kB" if report and report.prompt_bytes else "–",
                _stage_notes(entry, report),
            ]
        )
    seconds, calls, told, said, cost = totals
    total: list[Content] = ["All", _seconds(seconds), "", int(calls), int(told) or "–", int(said) or "–"]
    rows.append([*total, f"${cost:.4f}" if cost else "–", "", ""])
    return table(columns, rows, [*[""] * (len(rows) - 1), "sum"])


def _stage_figures(entry: Entry | None, answers: Sequence[Entry]) -> list[float]:
    """Seconds of the latest run; calls, tokens in and out and known cost of all answers that memory keeps."""
    return [
        entry.meta.seconds if entry else 0.0,
        len(answers),
        sum(a.meta.prompt_tokens for a in answers),
        sum(a.meta.completion_tokens for a in answers),
        sum(a.meta.cost or 0.0 for a in answers),
    ]


def _stage_notes(entry: Entry | None, report: StageReport | None) -> Content:
    notes = list(dict.fromkeys([*(entry.meta.notes if entry else []), *(report.notes if report else ())]))
    if entry is None:
        notes.insert(0, "answered, but not finished")
    if not notes:
        return None
    more = [f"and {len(notes) - 6} more"] if len(notes) > 6 else []
    return together([element("div", note) for note in [*notes[:6], *more]])


def _seconds(value: float) -> str:
    return f"{int(value // 60)} min {value % 60:.0f} s" if value >= 60 else f"{value:.1f} s"


def _rounds(memory: Memory) -> list[Content]:
    program = memory.latest(LayoutProgram, (LAYOUT_STAGE,))
    if program is None or not program.iterations:
        return []
    columns = [Column("Round"), Column("Score"), *(Column(title) for title in PARTS.values()), Column("Model says")]
    rows = [_round(item, item.number == program.best) for item in program.iterations]
    kept = ["kept" if item.number == program.best else "" for item in program.iterations]
    explained = (
        "Each round was built, rendered and measured; the best one was kept. Every part is between 0 and 1, "
        "and 1 is best."
    )
    return [element("h2", "Layout, round by round"), element("p", explained), table(columns, rows, kept),
            *(detail for item in program.iterations for detail in _round_details(item))]  # fmt: skip


def _round(item: Iteration, kept: bool) -> list[Content]:
    score = item.score
    judged: Content = bar(score.model) if score.model is not None else "–"
    name = f"{item.number + 1}, kept" if kept else str(item.number + 1)
    return [name, bar(score.total), *(bar(getattr(score, part)) for part in PARTS), judged]


def _round_details(item: Iteration) -> list[Content]:
    """What was asked for after a round, and what of it was refused."""
    if not (item.edits or item.refused or item.remarks):
        return []
    lines = [element("li", element("code", edit.id), " ", edit_words(edit)) for edit in item.edits]
    lines += [element("li", element("code", f.about), " ", f.message, " (refused)", of="quiet") for f in item.refused]
    remark = element("p", "“", item.remarks, "”", of="quiet") if item.remarks else None
    return [element("h3", f"After round {item.number + 1}"), remark, element("ul", *lines) if lines else None]


def edit_words(edit: LayoutEdit) -> str:
    """A typed edit in plain words."""
    done = {
        "move": f"moved to {_numbers(edit.centre)} m",
        "resize": f"made {_numbers(edit.size)} m",
        "turn": f"turned to {edit.yaw or 0:.0f} degrees",
        "add": f"added as {edit.category or 'an object'}",
        "remove": "taken out",
        "recategorise": f"called {edit.category or 'something else'}",
        "rename": f"renamed to {edit.new_id or '?'}",
        "line": "changed",
        "reparent": f"put on {edit.parent or 'the ' + (edit.placement or 'floor')}",
    }[edit.op]
    resized = edit.op == "move" and edit.size is not None
    return done + (f", made {_numbers(edit.size)} m" if resized else "") + (f": {edit.reason}" if edit.reason else "")


def _numbers(values: Sequence[float] | None, between: str = ", ") -> str:
    return between.join(f"{v:.2f}" for v in values) if values else "?"


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
    return [element("h2", "Objects"), element("p", intro), table(columns, rows)]


def words(category: str) -> str:
    """A category as an artist reads it."""
    return category.replace("_", " ")


def _proxies(program: LayoutProgram | None) -> dict[str, ProxyLine]:
    try:
        return {p.id: p for p in parse_layout(program.text).proxies} if program else {}
    except RoomError:  # a program that an artist wrote by hand may hold more than layout lines
        return {}


def _place(proxy: ProxyLine | None) -> list[Content]:
    return [_numbers(proxy.size, " x "), _numbers(proxy.centre)] if proxy else ["", ""]


def all_findings(memory: Memory) -> list[Finding]:
    """What every current artifact reports, each sentence once, errors first."""
    artifacts = (
        memory.latest(SceneAnalysis),
        memory.latest(Calibration),
        memory.latest(SceneGraph),
        memory.latest(LayoutProgram, (LAYOUT_STAGE,)),
        memory.latest(LayoutProgram),
        memory.latest(SmallObjects),
        memory.latest(HandEdits),
    )
    found = {(f.severity, f.about, f.message): f for a in artifacts if a is not None for f in a.findings}
    order = list(_SEVERITIES)
    return sorted(found.values(), key=lambda f: order.index(f.severity))


def _findings(memory: Memory) -> list[Content]:
    found = all_findings(memory)
    if not found:
        return [element("h2", "Findings"), element("p", "Nothing had to be repaired or doubted.")]
    parts: list[Content] = [element("h2", "Findings")]
    for severity, title in _SEVERITIES.items():
        group = [f for f in found if f.severity == severity]
        if group:
            items = [element("li", element("code", f.about), " ", f.message) for f in group]
            parts.append(
                element("section", element("h3", f"{title} ({len(group)})"), element("ul", *items), of=severity)
            )
    return parts
