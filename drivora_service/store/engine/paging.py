"""Opaque page tokens over a stable order."""

from __future__ import annotations

import base64
import binascii
import hashlib
import json

from drivora_service.errors import InvalidDocument, Problem

_LARGEST = 2**63 - 1


def make_token(scope: str, last: int) -> str:
    """Returns the token of the page after ``last``; ``scope`` names its query."""
    content = json.dumps([_digest(scope), last]).encode()
    return base64.urlsafe_b64encode(content).decode().rstrip("=")


def read_token(scope: str, token: str) -> int:
    """Reads a token that :func:`make_token` made for the same query.

    Raises:
        InvalidDocument: It is a token of another query, or no token.
    """
    try:
        padded = token + "=" * (-len(token) % 4)
        found = json.loads(base64.urlsafe_b64decode(padded.encode("ascii")))
    except (ValueError, binascii.Error, RecursionError):
        found = None
    match found:
        case [str(found_scope), int(last)] if found_scope == _digest(scope):
            # A forged token may hold a value that no database can compare with.
            if last is not True and last is not False and -_LARGEST <= last <= _LARGEST:
                return last
    raise InvalidDocument(
        (
            Problem(
                pointer="/page_token",
                code="bad_page_token",
                message="this is not a page token of this query; leave it out to start again",
            ),
        )
    )


def _digest(scope: str) -> str:
    return hashlib.sha256(scope.encode()).hexdigest()[:12]
