"""The socket of a server, and what is said of an address that cannot be used."""

from __future__ import annotations

import os
import socket
import threading
from collections.abc import Iterator
from contextlib import closing
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from drivora_service.errors import AddressTaken, ConfigurationError
from drivora_service.server_socket import bind_address, start_listening

HOST = "127.0.0.1"


class Answering(BaseHTTPRequestHandler):
    """A server that answers as the class attribute says."""

    body = b"hello"

    def do_GET(self) -> None:
        self.send_response(200)
        self.end_headers()
        self.wfile.write(self.body)

    def log_message(self, *_: object) -> None:
        """Prints nothing."""


@pytest.fixture
def port(request: pytest.FixtureRequest) -> Iterator[int]:
    """The port of a server that answers with the parameter."""
    handler = type("Handler", (Answering,), {"body": request.param})
    with HTTPServer((HOST, 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_address[1]
        server.shutdown()


@pytest.mark.parametrize(
    ("port", "holder"),
    [
        (b'{"status":"ok","version":"0.1.0"}', "a service of Drivora 0.1.0"),
        (b"<html>a page</html>", "another program"),
        (b'["version"]', "another program"),
    ],
    indirect=["port"],
)
def test_an_address_in_use_says_by_which_process(port: int, holder: str) -> None:
    with pytest.raises(AddressTaken) as raised:
        bind_address(HOST, port)
    message = str(raised.value)
    assert message.startswith(
        f"port {port} of {HOST} is in use by {holder} (process {os.getpid()},"
    )
    assert "choose another port with --port or DRIVORA_PORT" in message


def test_a_server_that_does_not_answer_is_another_program() -> None:
    with (
        closing(socket.create_server((HOST, 0))) as silent,
        pytest.raises(AddressTaken, match="in use by another program"),
    ):
        bind_address(HOST, silent.getsockname()[1])


def test_of_two_that_start_at_once_the_second_is_refused() -> None:
    with closing(bind_address(HOST, 0)) as first:
        port = first.getsockname()[1]
        with closing(bind_address(HOST, port)) as second:
            start_listening(first, HOST)
            with pytest.raises(AddressTaken, match=f"port {port} of {HOST} is in use"):
                start_listening(second, HOST)


@pytest.mark.parametrize("host", ["192.0.2.1", "two words"])
def test_an_address_of_another_machine_is_refused(host: str) -> None:
    with pytest.raises(ConfigurationError, match="name an address of this machine") as raised:
        bind_address(host, 0)
    assert host in str(raised.value)
