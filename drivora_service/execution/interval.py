"""Something that a loop does once in a while."""

from __future__ import annotations

import time


class Interval:
    """The time between two of them; it is over at the beginning."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._until = 0.0

    def is_over(self) -> bool:
        """Returns whether it is over; then the next one begins."""
        now = time.monotonic()
        if now < self._until:
            return False
        self._until = now + self._seconds
        return True

    def end(self) -> None:
        """Ends it at once."""
        self._until = 0.0
