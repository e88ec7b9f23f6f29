# SPDX-License-Identifier: GPL-3.0-or-later
"""From an exception of requests, urllib3 or the socket to a fault that names what is wrong.

The exceptions' own texts are never shown: they may hold a proxy's password or a header.
"""

from __future__ import annotations

import ssl
from collections.abc import Iterator

import requests
import urllib3

from .faults import Fault, FaultKind, ServiceError
from .leash import Leash
from .limits import Limits

LONGER = "Raise the time limit in the settings, or choose a faster model."
_LOOK = {
    "name": "Check the spelling of the base URL, and the internet connection.",
    "refused": "Check that the service runs, and the port in the base URL.",
    "timeout": "Check the base URL, and that no firewall is in the way.",
    "network": "Check the base URL, that the service runs, and the internet connection.",
}
# Codes of OpenSSL's X509_verify_cert.
_UNKNOWN_AUTHORITY = (2, 18, 19, 20, 21, 27)
_NOT_NOW = (9, 10)
_OTHER_NAME = (62, 64)


def network_fault(error: Exception, leash: Leash, limits: Limits, host: str, own_proxy: bool) -> Fault:
    """The fault for an exchange that brought no answer.

    Args:
        own_proxy: the proxy is the one of the settings, not of the environment.
    """
    if isinstance(error, requests.exceptions.ProxyError):
        return _proxy_fault(error, leash, host, own_proxy)
    if isinstance(error, (requests.exceptions.SSLError, urllib3.exceptions.SSLError)):
        return _tls_fault(error, host)
    if leash.problem:
        kind = leash.kind
        message = f"The service at {host} cannot be reached: {leash.problem}."
        return Fault(ServiceError(message, _LOOK[kind], kind), retry=True)
    if isinstance(error, (requests.exceptions.ReadTimeout, urllib3.exceptions.ReadTimeoutError)):
        # Not tried again: the service may well be working on it, and it would be paid for twice.
        return _fault(f"The service at {host} was silent for {limits.read:g} s.", LONGER, "timeout")
    if isinstance(error, requests.exceptions.InvalidSchema) and "SOCKS" in str(error):
        return _fault(
            "The environment names a SOCKS proxy, which is not supported.", "Give an HTTP proxy instead.", "proxy"
        )
    if isinstance(error, (requests.exceptions.InvalidProxyURL,)):
        return _fault("The proxy is not a valid address.", "Check the proxy settings.", "proxy")
    if isinstance(error, (requests.exceptions.InvalidURL, requests.exceptions.InvalidSchema, UnicodeError)):
        return _fault("The base URL is not a valid address.", "Check the base URL.", "request")
    if isinstance(error, OSError) and "TLS CA certificate bundle" in str(error):
        return _fault(
            "The file with the certificates to trust cannot be found.",
            "Choose it again in the preferences, or unset REQUESTS_CA_BUNDLE.",
            "tls",
        )
    if isinstance(error, (requests.exceptions.RequestException, urllib3.exceptions.HTTPError, OSError)):
        message = f"The connection to {host} broke off."
        return _fault(message, "Check the internet connection and try again.", "network", retry=True)
    return _fault(f"The exchange with {host} failed ({type(error).__name__}).", "Try again.", "network")


def _fault(message: str, fix: str, kind: FaultKind, retry: bool = False) -> Fault:
    return Fault(ServiceError(message, fix, kind), retry=retry)


def _proxy_fault(error: Exception, leash: Leash, host: str, own_proxy: bool) -> Fault:
    where = "of the preferences" if own_proxy else "that the environment names"
    fix = (
        "Check the proxy in the preferences." if own_proxy else "Check HTTPS_PROXY, or set a proxy in the preferences."
    )
    if any(isinstance(cause, (ssl.SSLError, urllib3.exceptions.SSLError)) for cause in _causes(error)):
        return _fault(f"The connection through the proxy {where} cannot be secured.", fix, "proxy")
    if leash.problem:
        return _fault(f"The proxy {where} cannot be reached: {leash.problem}.", fix, "proxy")
    said = " ".join(str(cause) for cause in _causes(error))
    if "407" in said:
        return _fault(
            f"The proxy {where} asks for a password.", "Give it like http://name:password@proxy:8080.", "proxy"
        )
    return _fault(f"The proxy {where} does not let us through to {host}.", fix, "proxy")


def _tls_fault(error: Exception, host: str) -> Fault:
    """Certificates are always verified; this says why one is not trusted."""
    code = next((c.verify_code for c in _causes(error) if isinstance(c, ssl.SSLCertVerificationError)), 0)
    if code in _UNKNOWN_AUTHORITY:
        return _fault(
            f"The certificate of {host} was signed by an authority that this computer does not know.",
            "Behind a company proxy, choose its certificate file as CA Bundle in the preferences.",
            "tls",
        )
    if code in _NOT_NOW:
        return _fault(
            f"The certificate of {host} is not valid today.", "Check this computer's date, or ask the service.", "tls"
        )
    if code in _OTHER_NAME:
        return _fault(f"The certificate at {host} belongs to another name.", "Check the base URL.", "tls")
    if code:
        return _fault(f"The certificate of {host} cannot be verified.", "Check the base URL.", "tls")
    return _fault(
        f"No secure connection to {host} comes about.", "Check the base URL; a local service may want http://.", "tls"
    )


def _causes(error: BaseException) -> Iterator[BaseException]:
    """The exception and what lies behind it."""
    waiting: list[object] = [error]
    seen: set[int] = set()
    while waiting:
        present = waiting.pop(0)
        if not isinstance(present, BaseException) or id(present) in seen:
            continue
        seen.add(id(present))
        yield present
        waiting += [*present.args, getattr(present, "reason", None), present.__cause__, present.__context__]
