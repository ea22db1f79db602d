"""Something that a loop does once in a while."""

from __future__ import annotations

import time


class Interval:
    """An interval between two times of doing something; the first one is over at once."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._until = 0.0

    def is_over(self) -> bool:
        """Returns whether the interval is over; if it is, the next one begins."""
        now = time.monotonic()
        if now < self._until:
            return False
        self._until = now + self._seconds
        return True

    def end(self) -> None:
        """Ends the interval at once: the next :meth:`is_over` returns true."""
        self._until = 0.0
