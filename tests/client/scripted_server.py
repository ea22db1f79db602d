"""A real HTTP server that answers as a test says."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


@dataclass(frozen=True, slots=True)
class Scripted:
    """An answer.

    Attributes:
        promised: Length that the head promises; -1: the body's.
    """

    status: int
    body: bytes = b""
    headers: Mapping[str, str] = field(default_factory=dict)
    promised: int = -1


@dataclass(frozen=True, slots=True)
class Hangup:
    """The connection is closed without an answer."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A request that the server was sent."""

    method: str
    target: str
    headers: Mapping[str, str]
    body: bytes
    at: float


class ScriptedServer(ThreadingHTTPServer):
    """Returns one answer after the other; the last one again and again.

    Attributes:
        asked: The requests so far.
    """

    daemon_threads = True

    def __init__(self, answers: list[Scripted | Hangup], port: int = 0) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.answers, self.asked = answers, list[Asked]()
        self.lock = threading.Lock()

    @property
    def url(self) -> str:
        """Address of the server."""
        return f"http://127.0.0.1:{self.server_address[1]}"


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: ScriptedServer

    def _answer(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", "0")))
        with self.server.lock:
            answers, number = self.server.answers, len(self.server.asked)
            self.server.asked.append(
                Asked(
                    self.command,
                    self.path,
                    {name.lower(): value for name, value in self.headers.items()},
                    body,
                    time.monotonic(),
                )
            )
        answer = answers[min(number, len(answers) - 1)]
        if isinstance(answer, Hangup):
            self.close_connection = True
            return
        self.send_response(answer.status)
        for name, value in answer.headers.items():
            self.send_header(name, value)
        length = len(answer.body) if answer.promised < 0 else answer.promised
        self.send_header("Content-Length", str(length))
        self.end_headers()
        self.wfile.write(answer.body)
        self.close_connection = length != len(answer.body)

    do_GET = do_POST = _answer  # noqa: N815 # as http.server calls them

    def log_message(self, *_: object) -> None:
        """Writes nothing."""


@contextlib.contextmanager
def scripted(*answers: Scripted | Hangup, port: int = 0) -> Iterator[ScriptedServer]:
    """Serves some answers, in their order."""
    with ScriptedServer(list(answers), port) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


def ok(value: object, **headers: str) -> Scripted:
    """An answer with JSON."""
    return Scripted(200, json.dumps(value).encode(), {"Content-Type": "application/json"} | headers)


def problem(status: int, detail: str, problems: object = (), **headers: str) -> Scripted:
    """An answer with problem details."""
    body = {"title": "x", "status": status, "detail": detail, "problems": problems}
    form = {"Content-Type": "application/problem+json"}
    return Scripted(status, json.dumps(body).encode(), form | headers)


def page(status: int, **headers: str) -> Scripted:
    """An answer of a proxy."""
    form = {"Content-Type": "text/html"}
    return Scripted(status, b"<html><h1>Sorry</h1></html>", form | headers)


def free_port() -> int:
    """Returns a port that nothing listens at."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port: int = listener.getsockname()[1]
        return port
