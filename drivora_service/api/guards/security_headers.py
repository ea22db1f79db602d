"""Headers by which browsers protect readers of answers, on every answer that lacks them."""

from __future__ import annotations

from collections.abc import Mapping

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from drivora_service.api_paths import PREFIX

SVG_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'; sandbox"
)
"""Content security policy of pictures: one that is opened by itself is a document, with scripts."""
_DATA_POLICY = "default-src 'none'; frame-ancestors 'none'"
"""Content security policy of what is not meant to be rendered."""

_HEADERS: Mapping[str, str] = {
    # A browser would else take the text of a user for a page or a script.
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    # Pages of other sites may not embed pictures of runs, or run answers as scripts.
    "Cross-Origin-Resource-Policy": "same-origin",
    # For browsers that do not know `frame-ancestors`.
    "X-Frame-Options": "DENY",
}
_OWN_PATHS = (PREFIX, "/healthz", "/readyz", "/metrics")
"""Beginnings of paths whose answers no cache may keep unasked."""


class SecurityHeaders:
    """ASGI middleware that adds the headers."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                add_security_headers(MutableHeaders(scope=message), scope["path"])
            await send(message)

        await self._app(scope, receive, send_with_headers)


def add_security_headers(headers: MutableHeaders, path: str) -> None:
    """Adds what the headers of an answer lack.

    Args:
        headers: Those of the answer.
        path: Path of the request.
    """
    for name, value in _HEADERS.items():
        headers.setdefault(name, value)
    if headers.get("content-type", "").startswith("image/svg"):
        headers["Content-Security-Policy"] = SVG_POLICY
    else:
        headers.setdefault("Content-Security-Policy", _DATA_POLICY)
    if path.startswith(_OWN_PATHS):
        kept = "private, no-cache" if "etag" in headers else "no-store"
        headers.setdefault("Cache-Control", kept)
