"""Keeps web pages of other sites away from a service that listens on loopback.

A page in the user's browser can send simple requests to any local port, and can have a name of its
own resolve to 127.0.0.1. So requests that change something must not come from another site, and,
where no token is asked for, the ``Host`` header must name this machine.
"""

from __future__ import annotations

from http import HTTPStatus
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.problem_details import problem_response

_LOCAL_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})
_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class OriginGuard:
    """ASGI middleware that refuses cross-site requests (403) and foreign host names (421)."""

    def __init__(self, app: ASGIApp, *, local_names_only: bool) -> None:
        self._app = app
        self._local_names_only = local_names_only

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] == "http":
            headers = Headers(scope=scope)
            host = headers.get("host", "")
            if self._local_names_only and _host_name(host) not in _LOCAL_NAMES:
                response = problem_response(
                    HTTPStatus.MISDIRECTED_REQUEST,
                    f"this service answers to localhost only, not to {host!r}",
                    instance=public_path(scope),
                )
                await response(scope, receive, send)
                return
            if scope["method"] not in _SAFE_METHODS and _is_cross_site(headers, host):
                response = problem_response(
                    HTTPStatus.FORBIDDEN,
                    "requests from pages of other sites are refused",
                    instance=public_path(scope),
                )
                await response(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _host_name(host: str) -> str:
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _is_cross_site(headers: Headers, host: str) -> bool:
    if headers.get("sec-fetch-site", "none") == "cross-site":
        return True
    origin = headers.get("origin")
    return origin is not None and _place(origin) != host


def _place(origin: str) -> str | None:
    """Returns host and port of an origin, or ``None`` if it is no address."""
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return None
