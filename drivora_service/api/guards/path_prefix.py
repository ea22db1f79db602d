"""A path that the service is under behind a reverse proxy, such as ``/drivora``.

Everything inside sees the path of a request without it, so that no guard and no route knows of it;
what is sent to clients has it. No header of a request says where the service is: a client could
send it, too.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

_KEY = "drivora.root_path"


class PathPrefix:
    """ASGI middleware: takes the prefix off the paths of requests that have it.

    A request without it is served, too: that of a proxy that takes the prefix off itself, or of a
    probe that asks the service directly.
    """

    def __init__(self, app: ASGIApp, *, root_path: str) -> None:
        """Creates the middleware around an application.

        Args:
            app: What answers.
            root_path: The prefix: starts with a slash, does not end with one.
        """
        self._app, self._root_path = app, root_path

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] == "http":
            scope = {**scope, _KEY: self._root_path, "path": self._without(scope["path"])}
            raw = scope.get("raw_path")
            if raw is not None:
                # The prefix has no character that would be escaped.
                scope["raw_path"] = self._without(raw.decode("latin-1")).encode("latin-1")
        await self._app(scope, receive, send)

    def _without(self, path: str) -> str:
        if path == self._root_path:
            return "/"
        return (
            path.removeprefix(self._root_path) if path.startswith(f"{self._root_path}/") else path
        )


def public_path(scope: Scope) -> str:
    """Returns the path of a request as its client sees it."""
    path: str = scope.get(_KEY, "") + scope["path"]
    return path
