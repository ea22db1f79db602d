"""Testers written as scripts: generators that yield one generation after another."""

from __future__ import annotations

from collections.abc import Generator

from drivora_service.search.tester import Evaluation, Proposal
from drivora_service.search.testers.turn import Turn

Script = Generator[tuple[Proposal, ...], tuple[Evaluation, ...], None]
"""Yields proposals and receives their evaluations, in the same order, once there are all."""


class ScriptedTester:
    """Runs a script as ask/tell; it ends when the script ends.

    A script is only advanced when the tester is asked, and a generation without proposals is
    answered at once.
    """

    def __init__(self, script: Script) -> None:
        """Creates a tester of a script that has not been started."""
        self._script = script
        self._turn = Turn()
        self._proposals: tuple[Proposal, ...] = ()
        self._asked = 0
        self._told: list[Evaluation] = []
        self._begun = False
        self._ended = False

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes the rest of the generation, or the next one once all are evaluated."""
        while len(self._told) == len(self._proposals) and not self._ended:
            self._go_on()
        proposals = self._proposals[self._asked : self._asked + max(room, 0)]
        self._asked += len(proposals)
        return self._turn.propose(proposals, room)

    def tell(self, evaluation: Evaluation) -> None:
        """Keeps the next evaluation for the script, which gets a generation at once."""
        self._turn.take(evaluation)
        self._told.append(evaluation)

    def _go_on(self) -> None:
        try:
            # A generator that has not been started accepts only ``None``.
            proposals = self._script.send(tuple(self._told)) if self._begun else next(self._script)
        except StopIteration:
            proposals, self._ended = (), True
        self._begun = True
        self._proposals, self._asked, self._told = proposals, 0, []
