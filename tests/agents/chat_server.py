"""A chat endpoint that speaks OpenAI's protocol on the loopback interface, for tests."""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

Answer = Callable[[list[dict[str, str]]], str]
"""Returns what a model would say to a chat."""


class ChatServer:
    """Answers chats, or fails in the way that it is told to.

    Attributes:
        answer: What it says.
        failing: Answers a request in place of that, with a status and a body; raises to hang up.
        requests: The bodies that came.
        keys: What came as authorization.
    """

    def __init__(self, answer: Answer) -> None:
        self.answer = answer
        self.failing: Callable[[], tuple[int, str]] | None = None
        self.requests: list[dict[str, Any]] = []
        self.keys: list[str] = []
        self.server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(self))

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server.server_address[1]}/v1"

    def respond(self, path: str, body: dict[str, Any]) -> tuple[int, str]:
        if self.failing is not None:
            return self.failing()
        if path != "/v1/chat/completions":
            return 404, "no such place"
        message = {"role": "assistant", "content": self.answer(body["messages"])}
        return 200, json.dumps({"object": "chat.completion", "choices": [{"message": message}]})


@contextlib.contextmanager
def chat_server(answer: Answer) -> Iterator[ChatServer]:
    chat = ChatServer(answer)
    thread = threading.Thread(target=chat.server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield chat
    finally:
        chat.server.shutdown()
        chat.server.server_close()
        thread.join()


def _handler(chat: ChatServer) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            chat.requests.append(body)
            chat.keys.append(self.headers.get("Authorization", ""))
            status, text = chat.respond(self.path, body)
            data = text.encode()
            # Who did not want to wait for a slow answer is gone by now.
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                self.send_response(status)
                self.send_header("Content-Length", str(len(data)))
                self.end_headers()
                self.wfile.write(data)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the library's name
            """Prints nothing."""

    return Handler
