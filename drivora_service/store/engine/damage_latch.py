"""The knowledge that a database is damaged, which lasts until the process ends."""

from __future__ import annotations

import threading
from collections.abc import Callable

from drivora_service.errors import StoreDamaged


class DamageLatch:
    """What is damaged in a database and what to do; the first damage counts. Thread-safe.

    It is not released: pages that can be read again say nothing about the others, and writes to a
    damaged file damage more of it.
    """

    def __init__(self) -> None:
        """Creates the latch, with no damage."""
        self._found = ""
        self._on_found: Callable[[str], None] = lambda _message: None
        self._lock = threading.Lock()

    @property
    def found(self) -> str:
        """What is damaged and what to do; "" while no damage is known."""
        return self._found

    def listen(self, on_found: Callable[[str], None]) -> None:
        """Calls a function with the damage, once, at once if it is known already.

        Args:
            on_found: Called from the thread that found the damage.
        """
        with self._lock:
            self._on_found = on_found
            found = self._found
        if found:
            on_found(found)

    def note(self, message: str) -> None:
        """Keeps a damage, unless one is known.

        Args:
            message: What is damaged and what to do.
        """
        with self._lock:
            if self._found:
                return
            self._found, on_found = message, self._on_found
        on_found(message)

    def refuse(self) -> None:
        """Refuses to write to a damaged database.

        Raises:
            StoreDamaged: A damage is known.
        """
        if self._found:
            raise StoreDamaged(self._found)
