"""The log of an agent by step: numeric columns written in place, lines of text, planned paths."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_PLAN_POINTS = 64
"""Points of a path that are kept; longer ones are thinned."""


class AgentLog:
    """The log of one ego's agent; the episode advances ``step``.

    Attributes:
        names: Numeric columns, declared once in ``setup_env``.
        row: (K,) values of the current step, NaN until written; a view.
        events: (step, message) pairs.
        plans: (step, path) pairs, the paths (n, 2) float32.
        plan_every: Steps between two paths that are kept.
    """

    def __init__(self) -> None:
        self.names: tuple[str, ...] = ()
        self.row: NDArray[np.float64] = np.empty(0)
        self.events: list[tuple[int, str]] = []
        self.plans: list[tuple[int, NDArray[np.float32]]] = []
        self.plan_every = 1
        self.step = 0

    def declare(self, *names: str) -> None:
        """Declares the numeric columns; their values are written to ``row`` each step."""
        self.names = names
        self.row = np.full(len(names), np.nan)

    def event(self, message: str) -> None:
        """Writes a line of text at the current step."""
        self.events.append((self.step, str(message)))

    def plan(self, points: ArrayLike) -> None:
        """Records the path that is planned at the current step, for replays.

        Of a path for every step, one every 0.1 s is kept.

        Args:
            points: (n, 2) x and y in metres; further columns are ignored. A path ends before its
                first point that is not finite, and of less than two points nothing is recorded.

        Raises:
            ValueError: The points have another shape.
        """
        if self.plans and self.step - self.plans[-1][0] < self.plan_every:
            return
        path = np.asarray(points, dtype=np.float32)
        if path.ndim != 2 or path.shape[1] < 2:
            raise ValueError(f"found a plan of shape {path.shape}; allowed: (n, 2)")
        finite = np.isfinite(path[:, :2]).all(axis=1)
        path = path if finite.all() else path[: int(np.argmin(finite))]
        if len(path) < 2:
            return
        if len(path) > MOST_PLAN_POINTS:
            path = path[np.linspace(0, len(path) - 1, MOST_PLAN_POINTS).round().astype(int)]
        self.plans.append((self.step, path[:, :2].copy()))
