"""Keeping the order of asking and telling."""

from __future__ import annotations

from collections import deque

from drivora_service.errors import SearchError
from drivora_service.search.tester import Evaluation, Proposal


class Turn:
    """Numbers what a tester has proposed, and checks that it is told in that order.

    Testers hold one, so that a wrong order is an error and not a wrong result.
    """

    def __init__(self) -> None:
        self._next = 0
        self._open: deque[tuple[int, Proposal]] = deque()

    @property
    def waiting(self) -> int:
        """Proposals that have not been told yet."""
        return len(self._open)

    @property
    def next_number(self) -> int:
        """Number that the next proposal will have."""
        return self._next

    def propose(self, proposals: tuple[Proposal, ...], room: int) -> tuple[Proposal, ...]:
        """Notes proposals and gives them back.

        Raises:
            SearchError: If there is no room, or not enough for them.
        """
        if room < 1:
            raise SearchError(f"asked with room for {room}; ask with room for at least 1")
        if len(proposals) > room:
            raise SearchError(f"{len(proposals)} proposals were made with room for {room}")
        for proposal in proposals:
            self._open.append((self._next, proposal))
            self._next += 1
        return proposals

    def take(self, evaluation: Evaluation) -> None:
        """Notes that an evaluation was told.

        Raises:
            SearchError: If another one, or none, was expected.
        """
        if not self._open:
            raise SearchError(f"evaluation {evaluation.number} was told, but none is expected")
        number, _ = self._open[0]
        if evaluation.number != number:
            raise SearchError(
                f"evaluation {evaluation.number} was told, but it is the turn of {number}"
            )
        self._open.popleft()
