"""Refusal of requests while nothing can be stored."""

from __future__ import annotations

from collections.abc import Callable
from http import HTTPStatus

from starlette.types import ASGIApp, Receive, Scope, Send

from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.problem_details import problem_response
from drivora_service.api_paths import PREFIX

RETRY_AFTER = {"Retry-After": "5"}
"""Header of refusals: when to ask again."""

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class WriteGate:
    """ASGI middleware: 503 for requests that change something while nothing can be stored.

    It needs neither a thread nor the database, so that no request waits while a fault lasts.
    Validation is always possible. Cancelling and pausing are tried even then: they need less
    storage than the refused requests, and may end the fault.
    """

    def __init__(
        self, app: ASGIApp, *, storage_fault: Callable[[], str], stopping: Callable[[], bool]
    ) -> None:
        """Creates the middleware around an application.

        Args:
            app: Application for the requests that pass.
            storage_fault: Returns why nothing can be stored and what to do, "" if it can.
            stopping: Whether the service takes no more work because it is being stopped.
        """
        self._app, self._storage_fault, self._stopping = app, storage_fault, stopping

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        detail = ""
        if scope["type"] == "http" and scope["method"] not in _SAFE_METHODS:
            detail = self._refusal(scope["path"])
        if not detail:
            await self._app(scope, receive, send)
            return
        # The rest of the body, so that the client reads the answer instead of losing it.
        message = await receive()
        while message["type"] == "http.request" and message.get("more_body", False):
            message = await receive()
        response = problem_response(
            HTTPStatus.SERVICE_UNAVAILABLE, detail, instance=public_path(scope), headers=RETRY_AFTER
        )
        await response(scope, receive, send)

    def _refusal(self, path: str) -> str:
        action = path.rpartition(":")[2]
        # A user signs in to look at something, or signs out; neither is work.
        if action == "validate" or path == f"{PREFIX}/session":
            return ""
        if self._stopping():
            return "the service is being stopped and takes no more work; ask again later"
        if action in ("cancel", "pause"):
            return ""
        fault = self._storage_fault()
        return f"nothing can be stored now: {fault}" if fault else ""
