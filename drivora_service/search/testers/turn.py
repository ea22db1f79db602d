"""Checking the order of ask and tell."""

from __future__ import annotations

from collections import deque

from drivora_service.errors import SearchError
from drivora_service.search.tester import Evaluation, Proposal


class Turn:
    """Numbers the proposals of a tester, and checks that evaluations come in that order.

    Testers hold one, so that a wrong order is an error and not a wrong result.
    """

    def __init__(self) -> None:
        self._next = 0
        self._open: deque[tuple[int, Proposal]] = deque()

    @property
    def waiting(self) -> int:
        """Number of proposals without an evaluation."""
        return len(self._open)

    @property
    def next_number(self) -> int:
        """Number of the next proposal."""
        return self._next

    def propose(self, proposals: tuple[Proposal, ...], room: int) -> tuple[Proposal, ...]:
        """Numbers proposals and returns them.

        Raises:
            SearchError: There is not enough room for them.
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
        """Checks the number of a told evaluation.

        Raises:
            SearchError: Another one, or none, was expected.
        """
        if not self._open:
            raise SearchError(f"evaluation {evaluation.number} was told, but none is expected")
        number, _ = self._open[0]
        if evaluation.number != number:
            raise SearchError(f"evaluation {evaluation.number} was told, but {number} is expected")
        self._open.popleft()
