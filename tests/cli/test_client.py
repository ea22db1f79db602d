"""The client of the commands against a server that closes connections."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest

from drivora_service.cli.client import ServiceClient
from drivora_service.errors import ServiceError

_ANSWER = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}"


@pytest.fixture
def closing_server() -> Iterator[tuple[str, list[bytes]]]:
    """A server that closes each first connection without an answer, and answers the next one."""
    asked: list[bytes] = []
    listener = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            with connection:
                asked.append(connection.recv(65536))
                if len(asked) % 2 == 0:
                    connection.sendall(_ANSWER)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{listener.getsockname()[1]}", asked
    listener.shutdown(socket.SHUT_RDWR)
    listener.close()
    thread.join(10)


def test_what_only_reads_is_asked_again_when_the_connection_was_closed(
    closing_server: tuple[str, list[bytes]],
) -> None:
    url, asked = closing_server
    with ServiceClient(url) as client:
        assert client.get("/batches/1") == {}
    assert len(asked) == 2


def test_what_changes_something_is_not_asked_twice(
    closing_server: tuple[str, list[bytes]],
) -> None:
    url, asked = closing_server
    with ServiceClient(url) as client, pytest.raises(ServiceError, match="does not answer"):
        client.act("/campaigns/1:pause")
    assert len(asked) == 1
