"""How often long work is reported where standard error is no terminal."""

from __future__ import annotations

import time
from collections.abc import Callable

_FIRST_S = 5.0
_SELDOM_S = 300.0


class LogPace:
    """Says when a line is due: after 5 s, and then in pauses that double, up to 5 minutes.

    So a short run prints nothing, one of minutes is not silent, and one of hours fills no log.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Begins now.

        Args:
            clock: Returns seconds of a clock that never goes back.
        """
        self._clock = clock
        self._pause = _FIRST_S
        self._next = clock() + self._pause

    def is_due(self) -> bool:
        """Returns whether to print a line now; then the next one is due later."""
        now = self._clock()
        if now < self._next:
            return False
        self._pause = min(2.0 * self._pause, _SELDOM_S)
        self._next = now + self._pause
        return True
