"""Which methods a path takes: the ``Allow`` header of refusals, and HEAD wherever GET is."""

from __future__ import annotations

import re
from collections.abc import Iterable

from starlette.routing import BaseRoute, Route, compile_path
from starlette.types import ASGIApp, Receive, Scope, Send

_IS_HEAD = "drivora.is_head"


class MethodTable:
    """The methods of every path of an application.

    The router names those of the first route only that it finds, where a path has one for each
    method.
    """

    def __init__(self) -> None:
        self._entries: list[tuple[re.Pattern[str], frozenset[str]]] = []

    def add(self, routes: Iterable[BaseRoute], prefix: str = "") -> None:
        """Adds the routes that are served under a prefix."""
        for route in routes:
            if isinstance(route, Route) and route.methods:
                pattern, _, _ = compile_path(prefix + route.path)
                self._entries.append((pattern, frozenset(route.methods)))

    def allowed_methods(self, path: str) -> tuple[str, ...]:
        """Returns the methods that a path takes, in alphabetical order."""
        found: set[str] = set()
        for pattern, methods in self._entries:
            if pattern.match(path):
                found |= methods
        if "GET" in found:
            found.add("HEAD")
        return tuple(sorted(found))


def is_head(scope: Scope) -> bool:
    """Returns whether a request that is answered as GET was one for the head only."""
    return _IS_HEAD in scope


class HeadAsGet:
    """ASGI middleware: HEAD is answered as GET, and the server leaves the body out."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] == "http" and scope["method"] == "HEAD":
            scope = {**scope, "method": "GET", _IS_HEAD: True}
        await self._app(scope, receive, send)
