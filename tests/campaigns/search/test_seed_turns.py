"""The numbers of candidates in a campaign and of its testers."""

from __future__ import annotations

import tracemalloc

import numpy as np

from drivora_service.campaigns.search.seed_turns import Turn
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal
from tests.campaigns.analytic import climber, search_of

MANY = 20_000
MOST_BYTES = 16
"""Of each candidate; two integers in a list and a dictionary were 130."""


def proposal(*parents: int) -> Proposal:
    return Proposal(values=np.zeros(2), origin="mutant" if parents else "initial", parents=parents)


def test_numbers_of_the_campaign_and_of_the_tester() -> None:
    turn = Turn(search_of(climber()).parts[0], 0)
    for number in (3, 4, 9):
        turn.take(proposal(), number)
    taken = turn.take(proposal(2, 0), 20)
    assert taken.parents == (9, 3)
    evaluation = Evaluation(number=20, proposal=taken, status=EvaluationStatus.FAILED)
    told = turn.of_tester(evaluation)
    assert told.number == 3
    assert told.proposal.parents == (2, 0)


def test_little_is_kept_of_a_candidate() -> None:
    turn = Turn(search_of(climber()).parts[0], 0)
    one = proposal()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        for number in range(MANY):
            turn.take(one, number)
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < MOST_BYTES * MANY
