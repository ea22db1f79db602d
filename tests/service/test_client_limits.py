"""The limits of clients are those of the settings."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.forked_service import forked_service

HEAD = b"POST /api/v1/scenarios:validate HTTP/1.1\r\nHost: localhost\r\n"
NO_BODY = HEAD + b"Content-Type: application/json\r\nContent-Length: 9\r\n\r\n"
EVENTS = b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nAccept: text/event-stream\r\n\r\n"
_WAIT_S = 10.0
"""Less than the limits without settings."""


@contextmanager
def sending(url: str, data: bytes) -> Iterator[socket.socket]:
    """Opens a connection of its own and sends the beginning of a request."""
    parts = urlsplit(url)
    with socket.create_connection((parts.hostname, parts.port), timeout=_WAIT_S) as connection:
        connection.sendall(data)
        yield connection


def status(connection: socket.socket) -> int:
    """Waits for an answer and returns its status."""
    return int(connection.recv(65_536).split()[1])


def test_clients_get_what_the_settings_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {
        "HEAD_DEADLINE_S": "0.5",
        "BODY_DEADLINE_S": "2",
        "MAX_CLIENT_BODIES": "2",
        "MAX_CLIENT_CONNECTIONS": "4",
    }.items():
        monkeypatch.setenv(f"DRIVORA_{name}", value)
    with forked_service(tmp_path / "data", workers=1) as url, contextlib.ExitStack() as stack:
        with sending(url, HEAD) as slow:
            assert status(slow) == 408
        waiting = [stack.enter_context(sending(url, NO_BODY)) for _ in range(3)]
        # Of three bodies one is too many, and the others are waited for, but not for long.
        assert [status(one) for one in waiting] == [503, 408, 408]
        streams = [stack.enter_context(sending(url, EVENTS)) for _ in range(4)]
        assert [status(one) for one in streams] == [200] * 4
        with sending(url, EVENTS) as one_more:
            assert status(one_more) == 503
