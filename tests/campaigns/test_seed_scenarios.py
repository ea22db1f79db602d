"""Several seed scenarios in one campaign: each has its own tester, and they take turns."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.errors import CampaignError
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.testing.gene_spaces import small_space
from tests.campaigns.analytic import Climber, Computed, Values, climber, part_of, run, sequence

INVALID = EvaluationStatus.INVALID


def three(ends_after: int = 1_000_000) -> tuple[Climber, Climber, Climber]:
    testers = climber(1), climber(2), climber(3)
    testers[1].ends_after = ends_after
    return testers


def campaign(
    testers: tuple[Climber, ...], journal: MemoryJournal, **changes: object
) -> list[EvaluationRecord]:
    parts = tuple(
        part_of(tester, Values(invalid_below=0.1 * place)) for place, tester in enumerate(testers)
    )
    run(journal, parts=parts, **changes)  # type: ignore[arg-type] # fields by name
    return list(journal.evaluations())


def simulations(records: list[EvaluationRecord]) -> Counter[int]:
    return Counter(record.seed_number for record in records if record.status is not INVALID)


def test_each_seed_gets_the_same_share_of_the_budget() -> None:
    records = campaign(three(), MemoryJournal(), budget=61)
    assert any(record.status is INVALID for record in records)
    shares = simulations(records)
    assert sum(shares.values()) == 61
    assert max(shares.values()) - min(shares.values()) <= 1


def test_seeds_are_abreast_all_the_time() -> None:
    records = [r for r in campaign(three(), MemoryJournal()) if r.status is not INVALID]
    for until in range(1, len(records)):
        shares = simulations(records[:until])
        # As many as wait for their results may be found invalid later.
        assert max(shares.values()) - min(shares[place] for place in range(3)) <= 8


def test_the_share_of_a_tester_that_ends_goes_to_the_others() -> None:
    shares = simulations(campaign(three(ends_after=5), MemoryJournal(), budget=60))
    assert sum(shares.values()) == 60
    assert shares[1] <= 5 + 8
    assert abs(shares[0] - shares[2]) <= 1


def test_a_tester_is_told_its_own_candidates_numbered_from_0() -> None:
    testers = three()
    records = campaign(testers, MemoryJournal())
    for place, tester in enumerate(testers):
        own = [record for record in records if record.seed_number == place]
        assert [e.number for e in tester.told] == list(range(len(own)))
        for evaluation, record in zip(tester.told, own, strict=True):
            assert np.array_equal(evaluation.proposal.values, record.proposal.values)
            parents = tuple(own[parent].number for parent in evaluation.proposal.parents)
            assert parents == record.proposal.parents
    assert any(record.proposal.parents for record in records)


def test_workers_and_kills_change_nothing() -> None:
    whole = campaign(three(), MemoryJournal())
    seeds = [record.seed_number for record in whole]
    for slots in (2, 3, 8):
        again = campaign(three(), MemoryJournal(), evaluator=Computed(slots=slots, seed=slots))
        assert sequence(again) == sequence(whole)
        assert [record.seed_number for record in again] == seeds
    for known in range(0, len(whole), 7):
        resumed = campaign(three(), MemoryJournal(whole[:known]))
        assert sequence(resumed) == sequence(whole)


def test_a_seed_alone_is_searched_as_without_the_others() -> None:
    alone, single = MemoryJournal(), MemoryJournal()
    campaign((climber(1),), alone)
    run(single, tester=climber(1), candidates=Values())
    assert sequence(list(alone.evaluations())) == sequence(list(single.evaluations()))


def test_a_parent_that_was_not_proposed_ends_the_campaign() -> None:
    class Orphan(Climber):
        def ask(self, room: int) -> tuple[Proposal, ...]:
            values = self.space.sample(self.random)
            return (Proposal(values=values, origin="mutation", parents=(7,)),)

        def tell(self, evaluation: Evaluation) -> None:
            raise AssertionError("nothing was run")

    orphan = Orphan(space=small_space(), random=np.random.default_rng(5))
    with pytest.raises(CampaignError, match="a child of its candidate 7; it has proposed 0 before"):
        run(MemoryJournal(), tester=orphan)
