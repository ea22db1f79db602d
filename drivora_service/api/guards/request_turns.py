"""Turns of requests: those of many clients begin a few at a time, those about health first."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable

MOST_A_TURN = 16
"""Requests that one turn of the event loop begins; some milliseconds of work."""


def urgent_requests(root_path: str = "") -> tuple[bytes, ...]:
    """Returns how requests start that ask for the service's health.

    Args:
        root_path: Path that the service is under; they may come with and without it.
    """
    return tuple(
        f"{method} {root}{prefix}/{name}".encode()
        for method in ("GET", "HEAD")
        for root in dict.fromkeys(("", root_path))
        for prefix in ("", "/api/v1")
        for name in ("healthz", "readyz")
    )


class Turns:
    """A queue of requests that have come and are to be begun.

    Else one turn of the event loop begins all that have come, hundreds where there are as many
    clients, and whatever comes next waits for all of them, several times over: to be connected, to
    be read and to be answered.
    """

    def __init__(self, most: int = MOST_A_TURN) -> None:
        """Creates an empty queue.

        Args:
            most: Requests that are begun before others get their turn.
        """
        self._most = most
        self._loop: asyncio.AbstractEventLoop | None = None
        self._begun = 0
        self._waiting: deque[Callable[[], None]] = deque()

    def begin(self, start: Callable[[], None]) -> None:
        """Calls ``start`` at once, or in a later turn, after the requests that came before."""
        loop = asyncio.get_running_loop()
        if loop is not self._loop:
            self._loop, self._begun = loop, 0
            self._waiting.clear()
        if self._begun == 0:
            loop.call_soon(self._next_turn)
        if self._begun >= self._most:
            self._waiting.append(start)
            return
        self._begun += 1
        start()

    def _next_turn(self) -> None:
        self._begun = 0
        while self._waiting and self._begun < self._most:
            if self._begun == 0:
                asyncio.get_running_loop().call_soon(self._next_turn)
            self._begun += 1
            self._waiting.popleft()()
