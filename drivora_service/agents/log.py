"""The log of an agent by step: numeric columns written in place, and lines of text."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class AgentLog:
    """The log of one ego's agent; the episode advances ``step``.

    Attributes:
        names: Numeric columns, declared once in ``setup_env``.
        row: (K,) values of the current step, NaN until written; a view.
        events: (step, message) pairs.
    """

    def __init__(self) -> None:
        self.names: tuple[str, ...] = ()
        self.row: NDArray[np.float64] = np.empty(0)
        self.events: list[tuple[int, str]] = []
        self.step = 0

    def declare(self, *names: str) -> None:
        """Declares the numeric columns; their values are written to ``row`` each step."""
        self.names = names
        self.row = np.full(len(names), np.nan)

    def event(self, message: str) -> None:
        """Writes a line of text at the current step."""
        self.events.append((self.step, str(message)))
