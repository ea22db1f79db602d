"""Leaving a minimisation in the middle of its own computation.

Between two runs a search checks proposals, each of them a whole scenario: of a large one hundreds,
which takes minutes. The thread that does so must not hold up the end of its process, nor the other
minimisations after a cancel.
"""

from __future__ import annotations

from collections.abc import Callable

from drivora_service.execution.interval import Interval

_LOOK_S = 0.5
"""Seconds between two looks into the database."""


class Abandoned(Exception):
    """The work on a minimisation is not to go on in this process, which is no fault of it."""


class AbandonmentCheck:
    """Called between two steps of a computation."""

    def __init__(self, is_stopping: Callable[[], bool], is_active: Callable[[], bool]) -> None:
        """Creates the check.

        Args:
            is_stopping: Returns whether the process is going to end.
            is_active: Returns whether the minimisation is still to be worked on; a query.
        """
        self._is_stopping, self._is_active = is_stopping, is_active
        self._look = Interval(_LOOK_S)
        self._look.is_over()

    def __call__(self) -> None:
        """Checks.

        Raises:
            Abandoned: The computation is not wanted any more.
        """
        if self._is_stopping() or (self._look.is_over() and not self._is_active()):
            raise Abandoned
