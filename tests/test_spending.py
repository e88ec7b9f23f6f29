# SPDX-License-Identifier: GPL-3.0-or-later
"""What a room costs: estimates, the running total, and the cap that holds before the request that would pass it."""

import io
import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from code_as_room.pipeline.errors import Cancelled, ReplyError, RoomError
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.prices import Price, PriceList, bundled_prices, load_prices, save_own_price
from code_as_room.pipeline.models.registry import ClientSettings
from code_as_room.pipeline.spending import (
    CappedClient,
    Meter,
    SpendingError,
    begin_total,
    estimate_prompt,
    estimate_run,
    metered,
    money,
    picture_tokens,
)
from PIL import Image

PRICE = Price(2.0, 10.0, "2026-11")
SERVICE = ClientSettings(kind="openai", base_url="https://api.example.com/v1", model="m")
PROMPT = Prompt("s01_analysis", "01", "word " * 2000, (), "Answer", {"type": "object"}, "h")


class Client:
    """Answers with a fixed number of tokens."""

    name, describes = "openai:m", "The model m"

    def __init__(self, error=None, gate=None, cost=None):
        self.asked, self._error, self._gate, self._cost = 0, error, gate, cost

    def answer(self, prompt, cancel, progress=None):
        self.asked += 1
        if progress:
            progress("waiting for the model")
        if self._gate:
            self._gate.wait(5)
        if self._error:
            raise self._error
        return Reply("{}", "m", 1_000, 5_000, self._cost)


def capped(client, cap=0.0, spent=0.0, price=PRICE):
    return CappedClient(client, Meter(cap, spent), lambda stage, pictures: ("m", price))


def ask(client, prompt=PROMPT):
    return client.answer(prompt, threading.Event())


def test_an_answers_cost_follows_from_its_tokens_unless_the_service_says_it():
    client = capped(Client())
    assert ask(client).cost == pytest.approx(0.002 + 0.05) and client.meter.spent == pytest.approx(0.052)
    assert client.meter.tokens == (1_000, 5_000)
    assert ask(capped(Client(cost=0.5))).cost == 0.5


def test_the_cap_stops_before_the_request_that_would_pass_it():
    inner = Client()
    client = capped(inner, cap=0.30)
    with pytest.raises(SpendingError, match="spending cap") as caught:
        for _ in range(100):
            ask(client)
    assert "$0.30" in str(caught.value) and caught.value.fix
    assert inner.asked >= 3 and client.meter.spent <= 0.30
    # Raised by the artist in the middle of a run, it goes on.
    client.meter.cap = 1.0
    ask(client)


def test_what_the_room_cost_before_counts():
    inner = Client()
    with pytest.raises(SpendingError):
        ask(capped(inner, cap=1.0, spent=0.99))
    assert inner.asked == 0


def test_requests_side_by_side_cannot_pass_the_cap_together():
    gate = threading.Event()
    inner = Client(gate=gate)
    client = capped(inner, cap=0.25)
    with ThreadPoolExecutor(8) as pool:
        futures = [pool.submit(ask, client) for _ in range(8)]
        while sum(future.done() for future in futures) + inner.asked < 8:
            time.sleep(0.01)
        gate.set()
    refused = [future for future in futures if isinstance(future.exception(), SpendingError)]
    assert refused and inner.asked == 8 - len(refused) and client.meter.spent <= 0.25


def test_without_a_cap_nothing_is_refused_and_an_unknown_price_stays_unknown():
    client = capped(Client(), price=None)
    assert ask(client).cost is None
    assert client.meter.unpriced == ("m",) and client.meter.spent == 0.0


def test_with_a_cap_nothing_is_sent_to_a_model_without_a_price():
    inner = Client()
    with pytest.raises(SpendingError, match="price of m is not known"):
        ask(capped(inner, cap=5.0, price=None))
    assert inner.asked == 0


@pytest.mark.parametrize(
    "error, paid",
    [
        (ReplyError("cut"), True),
        (Cancelled(), True),
        (ServiceError("silent", "", "timeout"), True),
        (ServiceError("no key", "", "key", 401), False),
        (ServiceError("refused", "", "refused"), False),
    ],
)
def test_what_failed_counts_where_it_was_paid_for_and_frees_what_was_set_aside(error, paid):
    client = capped(Client(error=error), cap=10.0)
    with pytest.raises(type(error)):
        ask(client)
    assert (client.meter.spent > 0) is paid
    client.meter.reserve(10.0 - client.meter.spent)


def test_a_longer_answer_than_expected_raises_the_next_estimate():
    first = estimate_prompt(PROMPT, PRICE)
    assert estimate_prompt(PROMPT, PRICE, 50_000).dollars > first.dollars
    assert estimate_prompt(PROMPT, None).dollars is None


def test_pictures_count_by_their_size():
    def encoded(side):
        data = io.BytesIO()
        Image.new("RGB", (side, side)).save(data, "PNG")
        return data.getvalue()

    small, large = picture_tokens(encoded(200)), picture_tokens(encoded(1568))
    assert 200 < small < 400 and 2_500 < large < 5_000
    assert picture_tokens(b"no picture") >= large
    with_picture = replace(PROMPT, images=(encoded(1568),))
    assert estimate_prompt(with_picture, PRICE).prompt_tokens - estimate_prompt(PROMPT, PRICE).prompt_tokens == large


def test_an_estimate_before_a_run_gives_a_range_and_names_what_has_no_price():
    stages = ["s01_analysis", "s02_graph", "s03_layout", "s04_auxiliary"]
    estimate = estimate_run(stages, 5, lambda stage: ("m", PRICE))
    low, high = estimate.dollars
    assert 0 < low < high < 5 and estimate.calls[0] < estimate.calls[1] and "$" in estimate.sentence()
    unknown = estimate_run(stages, 5, lambda stage: ("m", None))
    assert unknown.dollars is None and "price of m is not known" in unknown.sentence()
    free = estimate_run(stages, 5, lambda stage: ("m", Price(0, 0)))
    assert free.sentence().endswith("free")


def test_each_stages_model_is_priced_and_only_services_are_metered():
    prices = PriceList([{"host": "api.example.com", "model": "m", "input": 1, "output": 1}])
    prices = prices.with_price(SERVICE.base_url, "eyes", Price(100.0, 100.0))
    settings = replace(SERVICE, models={"seeing": "eyes"}, spending_cap=50.0)
    client = metered(Client(), settings, None, prices)
    dear, cheap = ask(client).cost, ask(client, replace(PROMPT, stage="s03_layout")).cost
    assert dear == pytest.approx(100 * cheap) and client.meter.cap == 50.0
    begin_total(client, 49.9999)
    with pytest.raises(SpendingError):
        ask(client)
    plain = Client()
    assert metered(plain, ClientSettings()) is plain


# Prices ---------------------------------------------------------------------------------------------------------


def test_the_bundled_prices_are_dated_and_plausible():
    entries = bundled_prices().entries()
    assert len(entries) > 10
    for entry in entries:
        assert len(entry["date"]) >= 7 and 0 < entry["input"] <= entry["output"] <= 200, entry


@pytest.mark.parametrize(
    "model, known",
    [
        ("gpt-5", True),
        ("gpt-5-2026-08-07", True),
        ("GPT-5-latest", True),
        ("gpt-5-mini", True),
        ("gpt-5-huge", False),
        ("gpt-55", False),
        ("gpt-5.9", False),
        ("", False),
    ],
)
def test_a_price_is_never_guessed_from_a_similar_name(model, known):
    prices = PriceList(
        [
            {"host": "api.openai.com", "model": "gpt-5", "input": 1, "output": 2},
            {"host": "api.openai.com", "model": "gpt-5-mini", "input": 0.1, "output": 0.2},
        ]
    )
    found = prices.find("https://api.openai.com/v1", model)
    assert (found is not None) is known
    if model == "gpt-5-mini":
        assert found.input == 0.1
    assert prices.find("https://elsewhere.example/v1", model) is None


@pytest.mark.parametrize(
    "url",
    ["http://localhost:1234/v1", "http://192.168.1.5:8000/v1", "http://workstation:8000/v1", "http://nas.local/v1"],
)
def test_ones_own_network_costs_nothing_unless_a_price_is_set(url):
    assert PriceList().find(url, "any").is_free
    assert PriceList().with_price(url, "any", PRICE).find(url, "any") == PRICE


def test_own_prices_go_first_and_are_kept(tmp_path):
    save_own_price(tmp_path, "https://api.openai.com/v1", "gpt-5", Price(9.0, 9.0, "2027-01-01", own=True))
    save_own_price(tmp_path, "https://api.example.com/v1", "x", Price(1.0, 1.0, own=True))
    prices = load_prices(tmp_path)
    assert prices.find("https://api.openai.com/v1", "gpt-5").input == 9.0
    assert prices.find("https://api.example.com/v1", "x").output == 1.0
    assert bundled_prices().find("https://api.openai.com/v1", "gpt-5").input != 9.0


def test_a_broken_list_of_own_prices_is_told_and_left_alone(tmp_path):
    (tmp_path / "prices.json").write_text("{broken", encoding="utf-8")
    for attempt in (load_prices, lambda folder: save_own_price(folder, "https://a.example", "m", PRICE)):
        with pytest.raises(RoomError, match="not readable"):
            attempt(tmp_path)
    assert (tmp_path / "prices.json").read_text(encoding="utf-8") == "{broken"


def test_impossible_prices_are_unknown_not_free():
    for wrong in ("1", None, -1, 1e9, float("nan"), True):
        entry = json.loads(json.dumps({"host": "h.example", "model": "m", "input": wrong, "output": 1}))
        assert PriceList([entry]).find("https://h.example", "m") is None


def test_amounts_read_well():
    assert [money(v) for v in (0, 0.0001, 0.042, 1.3)] == ["$0.00", "less than $0.001", "$0.042", "$1.30"]
