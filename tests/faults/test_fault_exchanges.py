# SPDX-License-Identifier: GPL-3.0-or-later
"""Some thousand faulty exchanges: each ends as a result, as a clear sentence with the next step, or as a clean stop."""

from __future__ import annotations

import base64
import traceback
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import fault_bodies
import fault_cases
import pytest
from code_as_room.pipeline.errors import ModelError, ReplyError, RoomError
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_cases import Case, good
from fault_envelopes import KEY, VENDORS, Vendor, a_prompt
from fault_server import Peer, start_peer

TWICE = RetryPolicy(tries=2, first_pause=0.001)
SIDE_BY_SIDE = 12
FAMILIES: dict[str, Callable[..., Iterable[Case]]] = {
    "statuses": fault_cases.statuses,
    "waits": fault_cases.waits,
    "money": fault_cases.money,
    "errors inside": fault_cases.errors_inside,
    "redirects": lambda vendor: fault_cases.redirects(vendor, "http://127.0.0.1:9"),
    "times": fault_cases.times,
    "sizes": fault_cases.sizes,
    "broken off": fault_bodies.broken_off,
    "not quite http": fault_bodies.not_quite_http,
    "coded": fault_bodies.coded,
    "other types": fault_bodies.other_types,
    "letters": fault_bodies.letters,
    "other values": fault_bodies.other_values,
    "echoes": fault_bodies.echoes,
}
_HIDDEN = (KEY.lower(), base64.b64encode(KEY.encode()).decode().rstrip("=").lower(), "bearer sk-")
_JARGON = ("traceback", "0x", "httpconnectionpool", "urllib3", "errno", "exception", "none.")


def told(error: BaseException) -> str:
    """Everything that an error could show anywhere."""
    return "".join(traceback.format_exception(error)) + repr(error) + repr(getattr(error, "__dict__", ""))


def clear(error: RoomError) -> Iterator[str]:
    """What is wrong with the error's words; nothing where they are a sentence and a next step without the key."""
    shown, everything = str(error), told(error).lower()
    if not error.message.rstrip('"').endswith(".") or not error.fix.endswith("."):
        yield f"no sentence with a next step: {shown!r}"
    if any(hidden in everything for hidden in _HIDDEN):
        yield f"the key is shown: {shown!r}"
    if len(shown) > 800 or not shown.isprintable():
        yield f"not to be shown: {shown[:300]!r}"
    ours = error.message.partition(' It says: "')[0].lower()
    if any(word in ours for word in _JARGON):
        yield f"jargon: {shown!r}"


def outcome(vendor: type[Vendor], case: Case, url: str) -> tuple[str, Any]:
    """ "result" or "error" with what came; anything else that is raised is a bug."""
    try:
        client = vendor.make(url, limits=case.limits, retries=TWICE)
        return "result", vendor.ask(client, a_prompt())
    except ModelError as error:
        return "error", error
    except BaseException as error:
        return "raised", error


def wrong(vendor: type[Vendor], case: Case, ended: str, came: Any, requests: int) -> Iterator[str]:
    """What is wrong with how an exchange ended."""
    if ended == "raised":
        yield "".join(traceback.format_exception(came))
        return
    if ended not in case.may:
        yield f"ended as {ended}: {str(came)[:300]!r}"
    if ended == "error":
        yield from clear(came)
        kind = came.kind if isinstance(came, ServiceError) else "reply" if isinstance(came, ReplyError) else ""
        if case.kinds and kind not in case.kinds:
            yield f"of kind {kind!r}: {came}"
        if case.says and case.says not in str(came):
            yield f"does not say it: {came}"
    else:
        expected = good(vendor) if case.expected == () else case.expected
        if expected is not None and came != expected:
            yield f"another result: {str(came)[:200]!r}"
        if vendor.chat and (KEY in came or came.encode().decode() != came):
            yield f"a result that cannot be kept: {came[:200]!r}"
    if case.requests and requests != case.requests:
        yield f"{requests} requests"


def perform(peer: Peer, vendor: type[Vendor], cases: Iterable[Case]) -> list[str]:
    """Run them side by side; what went wrong, with the case's name."""

    def one(numbered: tuple[int, Case]) -> list[str]:
        number, case = numbered
        place = peer.place(f"{vendor.name}-{case.family.replace(' ', '-')}-{number}", case.script)
        ended, came = outcome(vendor, case, place.url)
        return [f"{case.name}: {what}" for what in wrong(vendor, case, ended, came, len(place.received))]

    with ThreadPoolExecutor(SIDE_BY_SIDE) as pool:
        return [what for found in pool.map(one, enumerate(cases)) for what in found]


@pytest.mark.parametrize("vendor", VENDORS, ids=lambda vendor: vendor.name)
@pytest.mark.parametrize("family", [name for name in FAMILIES if name != "redirects"])
def test_every_faulty_exchange_ends_well(family: str, vendor: type[Vendor], peer: Peer) -> None:
    problems = perform(peer, vendor, FAMILIES[family](vendor))
    assert not problems, "\n".join(problems)


@pytest.mark.parametrize("vendor", VENDORS, ids=lambda vendor: vendor.name)
def test_no_redirect_leads_to_another_place(vendor: type[Vendor], peer: Peer, keep: Callable[[Any], Any]) -> None:
    stranger, server = start_peer()
    keep((server,))
    stranger.script = lambda received: received.reply(200, vendor.whole(good(vendor)))
    problems = perform(peer, vendor, fault_cases.redirects(vendor, f"http://127.0.0.1:{stranger.port}"))
    assert not problems, "\n".join(problems)
    assert stranger.received == []


def test_there_are_some_thousand() -> None:
    count = sum(len(list(family(vendor))) for vendor in VENDORS for family in FAMILIES.values())
    assert count > 4000
