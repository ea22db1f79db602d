from __future__ import annotations

import numpy as np

from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.search_preparation import ShuffledFeedback
from drivora_service.search.tester import EvaluationStatus
from tests.campaigns.analytic import Climber, climber, run, sequence


def shuffled(tester: Climber, seed: int = 1) -> ShuffledFeedback:
    return ShuffledFeedback(tester, np.random.default_rng(seed))


def test_results_come_from_other_candidates_that_were_judged() -> None:
    tester = climber()
    journal = MemoryJournal()
    run(journal, tester=shuffled(tester))
    own = {r.number: r.report.measurement for r in journal.evaluations()}
    judged = [e for e in tester.told if e.status is EvaluationStatus.JUDGED]
    assert [e.number for e in tester.told] == list(own)
    others = [e for e in judged if e.measurement != own[e.number]]
    assert len(others) > len(judged) / 2
    for evaluation in judged:
        earlier = [own[n] for n in range(evaluation.number + 1)]
        assert evaluation.measurement in earlier


def test_all_results_come_from_the_same_candidate_and_genes_without_effect_from_its_own() -> None:
    tester = climber()
    journal = MemoryJournal()
    run(journal, tester=shuffled(tester))
    own = {r.number: r.report for r in journal.evaluations()}
    swapped = 0
    for told in (e for e in tester.told if e.status is EvaluationStatus.JUDGED):
        sources = [n for n, report in own.items() if report.measurement == told.measurement]
        assert told.verdicts in [own[n].verdicts for n in sources]
        assert told.without_effect == own[told.number].without_effect != ()
        swapped += told.verdicts != own[told.number].verdicts
    assert swapped


def test_whether_a_candidate_is_valid_is_told_as_it_is() -> None:
    tester = climber()
    journal = MemoryJournal()
    run(journal, tester=shuffled(tester))
    assert [e.status for e in tester.told] == [r.status for r in journal.evaluations()]
    assert all(
        e.measurement is None for e in tester.told if e.status is not EvaluationStatus.JUDGED
    )


def test_the_journal_holds_what_really_came_of_it_and_resuming_shuffles_alike() -> None:
    whole = MemoryJournal()
    run(whole, tester=shuffled(climber()))
    records = list(whole.evaluations())
    own = MemoryJournal()
    run(own, tester=climber())
    assert sequence(records) != sequence(list(own.evaluations()))
    for known in range(0, len(records), 7):
        journal = MemoryJournal(records[:known])
        run(journal, tester=shuffled(climber()))
        assert sequence(list(journal.evaluations())) == sequence(records)


def test_without_its_feedback_a_search_finds_less() -> None:
    def found(tester: Climber | ShuffledFeedback) -> int:
        journal = MemoryJournal()
        run(journal, tester=tester, budget=150)
        return sum(bool(r.violations) for r in journal.evaluations())

    own = sum(found(climber(seed)) for seed in range(3))
    blind = sum(found(shuffled(climber(seed))) for seed in range(3))
    assert own > 1.5 * blind
