# SPDX-License-Identifier: GPL-3.0-or-later
"""The way to a service: certificates are always verified, proxies are used as set, and every fault of them is named."""

import os
import threading
import time

import pytest
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.limits import Limits, Route, checked_route
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_server import AUTHORITY, free_port, start_secure, start_tunnel, stop

KEY = "sk-test-0123456789abcdef"
SOON = 2.0

pytestmark = pytest.mark.usefixtures("no_threads_left")


@pytest.fixture(autouse=True)
def plain_environment(monkeypatch):
    """No proxy and no certificates from outside."""
    for name in ("http_proxy", "https_proxy", "all_proxy", "no_proxy", "requests_ca_bundle", "curl_ca_bundle"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


def make(url, proxy="", ca_bundle="", limits=None):
    route = checked_route(proxy, ca_bundle)
    return OpenAIStyleClient(url, "m", KEY, limits or Limits(total=20.0), RetryPolicy(1), route)


def failure(client, prompt):
    with pytest.raises(ServiceError) as caught:
        client.answer(prompt, threading.Event())
    said = str(caught.value)
    assert KEY not in said and "secretword" not in said and caught.value.fix
    return caught.value


@pytest.fixture
def secure(wire):
    """Starts TLS services with one of the certificates; they note each request's first line and headers."""
    servers = []

    def start(certificate="server", hang=None):
        def answer(connection):
            if hang is not None:
                hang.wait(10)
                return
            body = wire.event("{}") + wire.event(None, "stop") + wire.done
            head = "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n\r\n"
            connection.sendall(head.encode() + body)

        server, port, received = start_secure(answer, certificate)
        servers.append(server)
        return port, received

    yield start
    for server in servers:
        stop(server)


@pytest.fixture
def tunnel():
    """Starts proxies that lead every CONNECT to one port of this computer."""
    servers = []

    def start(port, password="", refuse="", hang=None):
        def answer(connection):
            if hang is not None:
                hang.wait(10)
            else:
                connection.sendall(f"HTTP/1.1 {refuse}\r\nConnection: close\r\n\r\n".encode())

        server, own, asked = start_tunnel(port, password, answer if refuse or hang is not None else None)
        servers.append(server)
        return own, asked

    yield start
    for server in servers:
        stop(server)


# Certificates ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "certificate, trusted, words",
    [
        ("server", "", "authority that this computer does not know"),
        ("othername", AUTHORITY, "belongs to another name"),
        ("expired", AUTHORITY, "not valid today"),
    ],
)
def test_a_certificate_that_cannot_be_trusted_is_named_and_nothing_is_sent(
    secure, a_prompt, certificate, trusted, words
):
    port, received = secure(certificate)
    error = failure(make(f"https://127.0.0.1:{port}/v1", ca_bundle=trusted), a_prompt)
    assert error.kind == "tls" and words in str(error)
    assert received == []


def test_a_ca_bundle_of_the_settings_or_the_environment_is_trusted(secure, a_prompt, monkeypatch):
    port, received = secure()
    url = f"https://127.0.0.1:{port}/v1"
    assert make(url, ca_bundle=AUTHORITY).answer(a_prompt, threading.Event()).text == "{}"
    monkeypatch.setenv("REQUESTS_CA_BUNDLE", AUTHORITY)
    assert make(url).answer(a_prompt, threading.Event()).text == "{}"
    assert len(received) == 2
    monkeypatch.setenv("REQUESTS_CA_BUNDLE", "/no/such/file.pem")
    error = failure(make(url), a_prompt)
    assert error.kind == "tls" and "cannot be found" in str(error)


def test_a_service_without_tls_is_told_apart_from_a_bad_certificate(peer, a_prompt):
    error = failure(make(f"https://127.0.0.1:{peer.port}/v1"), a_prompt)
    assert "http://" in error.fix or error.kind == "network"
    assert peer.received == []


@pytest.mark.parametrize(
    "proxy, bundle",
    [("ftp://proxy:1", ""), ("http://", ""), ("http://a b", ""), ("http://h:99999", ""), ("", "/no/such.pem")],
)
def test_a_route_that_cannot_be_right_is_refused_at_once(proxy, bundle):
    with pytest.raises(ModelError) as caught:
        checked_route(proxy, bundle)
    assert caught.value.fix


def test_a_file_without_certificates_is_refused_by_name_only(tmp_path):
    (tmp_path / "photo.pem").write_bytes(b"\x89PNG")
    with pytest.raises(ModelError, match="photo.pem") as caught:
        checked_route("", str(tmp_path / "photo.pem"))
    assert str(tmp_path) not in str(caught.value)


# Proxies --------------------------------------------------------------------------------------------------------


def test_the_proxy_of_the_settings_is_used_and_never_sees_the_key(secure, tunnel, a_prompt, monkeypatch):
    port, received = secure()
    proxy, asked = tunnel(port, password="secretword")
    monkeypatch.setenv("HTTPS_PROXY", "http://127.0.0.1:9")
    client = make("https://model.invalid/v1", f"http://user:secretword@127.0.0.1:{proxy}", AUTHORITY)
    assert client.answer(a_prompt, threading.Event()).text == "{}"
    assert asked[0][0].startswith("CONNECT model.invalid:443") and KEY not in str(asked)
    assert f"Authorization: Bearer {KEY}" in received[0] and "Proxy-Authorization" not in str(received)


def test_without_one_in_the_settings_the_environments_proxy_is_used(secure, tunnel, a_prompt, monkeypatch):
    port, _ = secure()
    proxy, asked = tunnel(port)
    monkeypatch.setenv("HTTPS_PROXY", f"http://127.0.0.1:{proxy}")
    assert make("https://model.invalid/v1", "", AUTHORITY).answer(a_prompt, threading.Event()).text == "{}"
    assert len(asked) == 1


def test_this_computer_is_asked_past_the_settings_proxy(peer, a_prompt, wire):
    peer.script = lambda received: wire.stream(received, "{}")
    assert make(peer.url, "http://127.0.0.1:9").answer(a_prompt, threading.Event()).text == "{}"


def test_a_proxy_does_not_make_an_unknown_authority_trusted(secure, tunnel, a_prompt):
    port, received = secure()
    proxy, _ = tunnel(port)
    error = failure(make("https://model.invalid/v1", f"http://127.0.0.1:{proxy}"), a_prompt)
    assert error.kind == "tls" and "authority" in str(error) and received == []


@pytest.mark.parametrize(
    "options, words",
    [
        ({"password": "secretword"}, "asks for a password"),
        ({"refuse": "403 Forbidden"}, "does not let us through to model.invalid"),
        ({"refuse": "502 Bad Gateway"}, "does not let us through to model.invalid"),
    ],
)
def test_a_proxy_that_refuses_is_named(tunnel, a_prompt, options, words):
    proxy, asked = tunnel(9, **options)
    given = f"http://user:wrong-secretword@127.0.0.1:{proxy}"
    error = failure(make("https://model.invalid/v1", given), a_prompt)
    assert error.kind == "proxy" and words in str(error) and "preferences" in str(error)
    assert KEY not in str(asked)


def test_a_proxy_that_is_not_there_is_not_taken_for_the_service(a_prompt, monkeypatch):
    port = free_port()
    error = failure(make("https://model.invalid/v1", f"http://127.0.0.1:{port}"), a_prompt)
    assert error.kind == "proxy" and "proxy of the preferences cannot be reached: nothing answers" in str(error)
    monkeypatch.setenv("HTTPS_PROXY", f"http://user:secretword@127.0.0.1:{port}")
    error = failure(make("https://model.invalid/v1"), a_prompt)
    assert error.kind == "proxy" and "HTTPS_PROXY" in str(error)


@pytest.mark.parametrize("where", ["the proxy is silent", "the service behind it is silent"])
def test_it_stops_within_a_second_behind_a_proxy(secure, tunnel, a_prompt, where):
    leave = threading.Event()
    port, _ = secure(hang=leave)
    proxy, _ = tunnel(port, hang=leave if where == "the proxy is silent" else None)
    client = make("https://model.invalid/v1", f"http://127.0.0.1:{proxy}", AUTHORITY)
    files = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    cancel, stopped = threading.Event(), []

    def stop():
        stopped.append(time.monotonic())
        cancel.set()

    timer = threading.Timer(0.4, stop)
    timer.start()
    with pytest.raises(Cancelled):
        client.answer(a_prompt, cancel)
    assert time.monotonic() - stopped[0] < SOON
    leave.set()
    timer.join()
    end = time.monotonic() + 3
    while files and len(os.listdir("/proc/self/fd")) > files + 2 and time.monotonic() < end:
        time.sleep(0.05)
    if files:
        assert len(os.listdir("/proc/self/fd")) <= files + 2


def test_the_proxys_password_is_in_no_representation():
    client = make("https://model.invalid/v1", "http://user:secretword@proxy:8080")
    assert "secretword" not in repr(client) + repr(client.__dict__) + repr(Route("http://u:secretword@p", ""))
