"""The turns of seed scenarios in one campaign.

The next candidate is one of the seed scenario with the fewest simulations so far, the first of them
if there are several, among those whose testers have one to propose. So each gets the same share of
the budget, but for one simulation, as long as its tester proposes.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from drivora_service.errors import CampaignError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.candidate import Candidate, Reference, SpaceSource
from drivora_service.search.genes import GeneSpace
from drivora_service.search.tester import Evaluation, Proposal, Tester


class Candidates(Protocol):
    """The space of the candidates; the same values always give the same candidate."""

    @property
    def genes(self) -> GeneSpace:
        """The genes of the candidates."""
        ...

    @property
    def source(self) -> SpaceSource:
        """The space as workers get it, which decode the values."""
        ...

    def prepare(self, values: FloatArray, reference: Reference | None = None) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario, as workers do."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchPart:
    """The search from one seed scenario.

    Attributes:
        kind_of: Returns the kind of failure of a violation.
    """

    tester: Tester
    candidates: Candidates
    kind_of: Callable[[Verdict], str]


class Turn:
    """A part of a search, and what it has had.

    Its tester knows its own candidates only, numbered from 0.

    Attributes:
        place: Place of its seed scenario in the campaign, from 0.
        valid: Candidates that are not known to be invalid.
        is_dry: Whether its tester has nothing to propose at the moment.
    """

    def __init__(self, part: SearchPart, place: int) -> None:
        """Creates the record of a part of which nothing was asked yet."""
        self.part, self.place = part, place
        self.valid = 0
        self.is_dry = False
        # In eight bytes each; they only grow, so that a place is found by bisection.
        self._numbers = array("q")

    def take(self, proposal: Proposal, number: int) -> Proposal:
        """Counts a proposal of the tester; returns it with the numbers of the campaign.

        Args:
            proposal: The proposal.
            number: Its number in the campaign.

        Raises:
            CampaignError: It names a parent that the tester has not proposed before.
        """
        for parent in proposal.parents:
            if not 0 <= parent < len(self._numbers):
                raise CampaignError(
                    f"the tester proposed a child of its candidate {parent}; it has proposed "
                    f"{len(self._numbers)} before, numbered from 0"
                )
        parents = tuple(self._numbers[parent] for parent in proposal.parents)
        self._numbers.append(number)
        self.valid += 1
        return replace(proposal, parents=parents)

    def of_tester(self, evaluation: Evaluation) -> Evaluation:
        """Returns an evaluation of the campaign with the numbers of the tester."""
        proposal = evaluation.proposal
        parents = tuple(self._place_of(parent) for parent in proposal.parents)
        return replace(
            evaluation,
            number=self._place_of(evaluation.number),
            proposal=replace(proposal, parents=parents),
        )

    def _place_of(self, number: int) -> int:
        """Returns the number that the tester has for a candidate of the campaign."""
        return bisect_left(self._numbers, number)


class Turns:
    """Chooses whose turn it is; a function of what was asked and told."""

    def __init__(self, parts: Sequence[SearchPart]) -> None:
        """Creates the choice among parts of which nothing was asked yet."""
        self._turns = tuple(Turn(part, place) for place, part in enumerate(parts))

    def begin(self) -> None:
        """Records that testers have received results, and may have more to propose."""
        for turn in self._turns:
            turn.is_dry = False

    def next(self) -> Turn | None:
        """Returns whose turn it is; ``None`` if no tester has anything to propose."""
        able = [turn for turn in self._turns if not turn.is_dry]
        return min(able, key=lambda turn: (turn.valid, turn.place), default=None)
