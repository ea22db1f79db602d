"""A search that starts from known candidates.

Every method begins with candidates that are drawn. The known ones take their places, one by one:
they are simulated as the method's own, and it learns from them as it does from candidates that were
repaired. If a method draws fewer than are known, the rest is simulated before its first bred
candidate, and it is not told about these. All of this follows from what was asked and told, so that
a campaign that is resumed repeats it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.tester import (
    REFERENCE_ORIGIN,
    Checkpoints,
    Evaluation,
    Proposal,
    Tester,
)

ORIGIN = "start"
"""Origin of the known candidates."""

_ACTORS = (Part.VEHICLE, Part.WALKER, Part.OBSTACLE)


class WarmStart:
    """Puts known candidates in place of the first ones that a tester draws."""

    def __init__(self, tester: Tester, starts: Sequence[FloatArray], space: GeneSpace) -> None:
        """Takes a tester that was not asked yet.

        Args:
            tester: The tester.
            starts: (d,) genes of each known candidate, in the order of use.
            space: The gene space.
        """
        self._tester = tester
        self._starts = deque(starts)
        self._movable = _optional_actors(space)
        self._held: deque[Proposal] = deque()
        self._asked = self._asked_inside = 0
        self._inside: dict[int, int] = {}
        self._outside: list[int] = []

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes known candidates first, then those of the tester."""
        proposals: list[Proposal] = []
        while len(proposals) < room:
            if not self._held:
                self._held.extend(self._tester.ask(room - len(proposals)))
                if not self._held:
                    break
            proposals.append(self._next())
        if room < 1:
            # The tester says what is wrong.
            self._tester.ask(room)
        return tuple(proposals)

    def tell(self, evaluation: Evaluation) -> None:
        """Tells the tester the results of its candidates, by its own numbers."""
        if evaluation.number not in self._inside and evaluation.number < self._asked:
            return
        # A number that was never asked is refused by the tester.
        number = self._inside.get(evaluation.number, evaluation.number)
        proposal = evaluation.proposal
        parents = tuple(self._inside[parent] for parent in proposal.parents)
        self._tester.tell(
            replace(evaluation, number=number, proposal=replace(proposal, parents=parents))
        )

    def _next(self) -> Proposal:
        proposal = self._held[0]
        if self._starts and proposal.origin != REFERENCE_ORIGIN:
            if not _is_drawn(proposal):
                self._asked += 1
                return Proposal(values=self._starts.popleft(), origin=ORIGIN)
            proposal = replace(
                proposal, values=self._fit(proposal), origin=ORIGIN, parents=(), redrawn=0
            )
        self._held.popleft()
        parents = tuple(self._outside[parent] for parent in proposal.parents)
        self._inside[self._asked] = self._asked_inside
        self._outside.append(self._asked)
        self._asked += 1
        self._asked_inside += 1
        return replace(proposal, parents=parents)

    def _fit(self, proposal: Proposal) -> FloatArray:
        """Returns the next known candidate, in the scene of the reference if there is one."""
        start = self._starts.popleft()
        if proposal.reference is None:
            return start
        # Only the actors beside the egos differ from the reference run.
        return np.where(self._movable, start, proposal.values)


class ShiftedCheckpoints:
    """Checkpoints of a tester that receives fewer evaluations than its campaign has."""

    def __init__(self, checkpoints: Checkpoints, shift: int) -> None:
        """Takes the checkpoints of a campaign.

        Args:
            checkpoints: The checkpoints.
            shift: Number of evaluations, at most, that the tester is not told.
        """
        self._checkpoints, self._shift = checkpoints, shift

    def last(self) -> tuple[int, bytes] | None:
        """Returns the latest checkpoint of which all evaluations are stored."""
        found = self._checkpoints.last()
        return None if found is None else (found[0] - self._shift, found[1])

    def save(self, told: int, state: bytes) -> None:
        """Stores the state after ``told`` evaluations of the tester."""
        self._checkpoints.save(told + self._shift, state)


def _is_drawn(proposal: Proposal) -> bool:
    """Returns whether a known candidate may take the place of a proposal.

    Of a method that compares with a reference run every further candidate is bred from that run,
    the first ones too.
    """
    if proposal.reference is not None:
        return True
    return not proposal.parents and proposal.generation == 0


def _optional_actors(space: GeneSpace) -> BoolArray:
    """Returns the (d,) genes of actors that may be absent, without egos."""
    movable = np.zeros(len(space), dtype=np.bool_)
    for block in space.optional_blocks:
        if block.part in _ACTORS:
            movable[block.slice] = True
    return movable
