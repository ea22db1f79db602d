"""Times of answers, by operation."""

from __future__ import annotations

import time

from prometheus_client import CollectorRegistry, Histogram
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_BUCKETS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0)
"""Seconds."""


class RequestTimes:
    """Times from a request's arrival to the head of its answer.

    Attributes:
        registry: Holds them for ``/metrics``.
    """

    def __init__(self) -> None:
        self.registry = CollectorRegistry(auto_describe=False)
        self._seconds = Histogram(
            "drivora_request_seconds",
            "Seconds from a request to the head of its answer",
            labelnames=("method", "route", "status"),
            buckets=_BUCKETS,
            registry=self.registry,
        )

    def add(self, method: str, route: str, status: int, seconds: float) -> None:
        """Adds a request.

        Args:
            method: Of HTTP.
            route: The operation's path with its placeholders, so that there are few.
            status: Of the answer; counted by its class.
            seconds: From its arrival to the head of the answer.
        """
        self._seconds.labels(method, route, f"{status // 100}xx").observe(seconds)


class TimedRequests:
    """ASGI middleware that measures."""

    def __init__(self, app: ASGIApp, *, times: RequestTimes) -> None:
        self._app = app
        self._times = times

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = time.perf_counter()

        async def send_and_time(message: Message) -> None:
            if message["type"] == "http.response.start":
                # Set by the router; what no operation answers has none.
                route = getattr(scope.get("route"), "path", "none")
                seconds = time.perf_counter() - begun
                self._times.add(scope["method"], route, message["status"], seconds)
            await send(message)

        await self._app(scope, receive, send_and_time)
