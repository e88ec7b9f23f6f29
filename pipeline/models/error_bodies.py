# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that come with status 200, in the body of what should be a reply: the service's own words and what they mean."""

from __future__ import annotations

from typing import Any

from .faults import Fault, error_codes, fault_for, message_in, plain

_STATUS_OF = {
    "insufficient_quota": 402,
    "billing_hard_limit_reached": 402,
    "billing_error": 402,
    "rate_limit_exceeded": 429,
    "rate_limit_error": 429,
    "resource_exhausted": 429,
    "server_error": 500,
    "internal_server_error": 500,
    "internal": 500,
    "api_error": 500,
    "unavailable": 503,
    "overloaded_error": 529,
    "timeout": 504,
    "timeout_error": 504,
    "deadline_exceeded": 504,
    "invalid_api_key": 401,
    "authentication_error": 401,
    "unauthenticated": 401,
    "permission_error": 403,
    "permission_denied": 403,
    "model_not_found": 404,
    "not_found_error": 404,
    "not_found": 404,
    "request_too_large": 413,
    "invalid_request_error": 400,
    "invalid_argument": 400,
}


def body_fault(error: Any, host: str, key: str | None) -> Fault:
    """The fault for the value of "error" in a body, by the status that its code or type stands for."""
    code = error.get("code") if isinstance(error, dict) else None
    text = str(code or "")
    status = int(text) if text.isdigit() and len(text) == 3 else _STATUS_OF.get(text.lower(), 0)
    kind = str(error.get("type") or error.get("status") or "").lower() if isinstance(error, dict) else ""
    sentence = plain(message_in(error), key)
    return fault_for(status or _STATUS_OF.get(kind, 0), sentence, error_codes(error), 0.0, host)
