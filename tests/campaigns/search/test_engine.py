from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.campaigns.evaluator import Answer
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.engine import Told
from drivora_service.errors import CampaignError, PluginError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal
from drivora_service.store.campaigns.campaign_records import CampaignRequest, EvaluationRecord
from drivora_service.testing.gene_spaces import small_space
from tests.campaigns.analytic import (
    NO_REQUEST,
    Climber,
    Computed,
    Values,
    climber,
    perform,
    run,
    sequence,
)

GENES = len(small_space())


@pytest.fixture(scope="module")
def whole() -> list[EvaluationRecord]:
    """An uninterrupted campaign on one worker."""
    journal = MemoryJournal()
    assert run(journal) is NO_REQUEST
    return list(journal.evaluations())


def test_the_budget_counts_simulations_and_not_invalid_candidates(
    whole: list[EvaluationRecord],
) -> None:
    statuses = [record.status for record in whole]
    assert statuses.count(EvaluationStatus.INVALID) > 0
    assert statuses.count(EvaluationStatus.FAILED) > 0
    assert len(statuses) - statuses.count(EvaluationStatus.INVALID) == 60
    assert [record.number for record in whole] == list(range(len(whole)))


def test_the_world_of_these_tests_has_violations_and_lineages(
    whole: list[EvaluationRecord],
) -> None:
    assert any(record.violations for record in whole)
    assert any(record.proposal.parents for record in whole)


@pytest.mark.parametrize("slots", [1, 2, 3, 8])
@pytest.mark.parametrize("order", range(3))
def test_workers_and_the_order_of_endings_change_nothing(
    whole: list[EvaluationRecord], slots: int, order: int
) -> None:
    journal = MemoryJournal()
    run(journal, evaluator=Computed(slots=slots, seed=order))
    assert sequence(list(journal.evaluations())) == sequence(whole)


def test_the_lookahead_is_part_of_the_search(whole: list[EvaluationRecord]) -> None:
    journal = MemoryJournal()
    run(journal, lookahead=1)
    assert sequence(list(journal.evaluations())) != sequence(whole)


def test_as_many_runs_are_under_way_as_may_wait() -> None:
    evaluator = Computed(slots=2)
    run(MemoryJournal(), evaluator=evaluator, candidates=Values())
    assert evaluator.most_under_way == 8


def test_resuming_after_any_evaluation_gives_the_same_campaign(
    whole: list[EvaluationRecord],
) -> None:
    for known in range(len(whole) + 1):
        journal = MemoryJournal(whole[:known])
        evaluator = Computed(slots=3, seed=known)
        assert run(journal, evaluator=evaluator) is NO_REQUEST
        assert sequence(list(journal.evaluations())) == sequence(whole)
        assert all(number >= known for number in evaluator.submitted)


def test_a_replayed_evaluation_equals_that_of_the_run(
    whole: list[EvaluationRecord],
) -> None:
    live, resumed = climber(), climber()
    run(MemoryJournal(), tester=live)
    run(MemoryJournal(whole), tester=resumed)
    assert [(e.violations, e.scores, e.measurement) for e in live.told] == [
        (e.violations, e.scores, e.measurement) for e in resumed.told
    ]


def test_only_the_campaigns_oracles_and_the_egos_own_faults_count(
    whole: list[EvaluationRecord],
) -> None:
    reports = [r.report for r in whole if r.status is EvaluationStatus.JUDGED]
    not_at_fault = [r for r in reports if any(v.at_fault is False for v in r.verdicts)]
    assert not_at_fault
    for record in whole:
        assert all(v.oracle == "collision" and v.at_fault for v in record.violations)


def test_a_tester_gets_measurements_of_judged_runs_only() -> None:
    tester = climber()
    run(MemoryJournal(), tester=tester)
    for evaluation in tester.told:
        judged = evaluation.status is EvaluationStatus.JUDGED
        assert bool(evaluation.scores) == judged
        assert (evaluation.measurement is not None) == judged


def test_values_are_told_as_they_were_repaired() -> None:
    tester = climber()
    run(MemoryJournal(), tester=tester, candidates=Values())
    assert all(
        tuple(e.proposal.values.tolist()) == Values().prepare(e.proposal.values).values
        for e in tester.told
    )


@pytest.mark.parametrize("request_", [CampaignRequest.PAUSE, CampaignRequest.CANCEL])
def test_a_request_stops_between_evaluations_and_the_campaign_can_be_resumed(
    whole: list[EvaluationRecord], request_: CampaignRequest
) -> None:
    told: list[Told] = []
    journal = MemoryJournal()
    ended = run(
        journal,
        requested=lambda: request_ if len(told) >= 11 else NO_REQUEST,
        on_told=told.append,
    )
    assert ended is request_
    assert len(list(journal.evaluations())) == 11
    run(journal)
    assert sequence(list(journal.evaluations())) == sequence(whole)


def test_callbacks_get_replayed_evaluations(whole: list[EvaluationRecord]) -> None:
    told: list[Told] = []
    run(MemoryJournal(whole[:20]), on_told=told.append)
    assert [t.replayed for t in told] == [True] * 20 + [False] * (len(whole) - 20)


class Broken:
    """A tester with invalid first proposals."""

    def __init__(self, *values: FloatArray) -> None:
        self._proposals = tuple(Proposal(values=each, origin="initial") for each in values)

    def ask(self, room: int) -> tuple[Proposal, ...]:
        return self._proposals

    def tell(self, evaluation: Evaluation) -> None:
        raise AssertionError("nothing was run")


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ((np.zeros(GENES),) * 9, "at most 8 candidates and proposed 9"),
        ((np.full(GENES, np.nan),), f"{GENES} of them not finite"),
        ((np.zeros(GENES - 1),), f"needed are {GENES} numbers"),
    ],
)
def test_invalid_proposals_end_the_campaign(values: tuple[FloatArray, ...], says: str) -> None:
    with pytest.raises(CampaignError, match=says):
        run(MemoryJournal(), tester=Broken(*values))


def test_the_testers_time_is_counted_once(
    whole: list[EvaluationRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time of telling known evaluations again is no part of the next evaluation."""
    now = 0.0

    class Slow(Climber):
        def tell(self, evaluation: Evaluation) -> None:
            nonlocal now
            now += 1.0
            super().tell(evaluation)

    # Of its thread: campaigns of one process take turns.
    monkeypatch.setattr(time, "thread_time", lambda: now)
    for known in (0, len(whole) - 10):
        journal = MemoryJournal(whole[:known])
        run(journal, tester=Slow(space=small_space(), random=np.random.default_rng(5)))
        new = list(journal.evaluations())[max(known, 1) :]
        assert [record.search_s for record in new] == [1.0] * len(new)


def test_a_campaign_ends_with_its_tester() -> None:
    tester = climber()
    tester.ends_after = 15
    journal = MemoryJournal()
    assert run(journal, tester=tester) is NO_REQUEST
    assert 15 <= len(list(journal.evaluations())) <= 15 + 8


def test_too_many_invalid_candidates_end_the_campaign() -> None:
    journal = MemoryJournal()
    with pytest.raises(CampaignError, match=r"were no valid scenarios.*too near"):
        run(journal, candidates=Values(invalid_below=1.0), budget=10)
    assert 100 < len(list(journal.evaluations())) <= 111


def test_a_campaign_without_a_judged_run_fails() -> None:
    def broken(spec: RunSpec) -> RunReport:
        failure = RunFailure(cause="agent_raised", message="no such parameter")
        return RunReport(run_id=spec.run_id, status=RunStatus.AGENT_FAILED, failure=failure)

    journal = MemoryJournal()
    with pytest.raises(CampaignError, match="no such parameter"):
        run(journal, evaluator=Computed(work=broken))
    assert [r.status for r in journal.evaluations()].count(EvaluationStatus.FAILED) == 20


@pytest.mark.parametrize("raised", [ZeroDivisionError("no gap"), SystemExit(3)])
def test_a_tester_that_raises_is_named_and_ends_the_campaign(
    raised: BaseException,
) -> None:
    class Quitter(Climber):
        def tell(self, evaluation: Evaluation) -> None:
            raise raised

    tester = Quitter(space=small_space(), random=np.random.default_rng(5))
    expected = r"the tester raised .* when it was given results: "
    with pytest.raises(PluginError, match=expected) as caught:
        run(MemoryJournal(), tester=tester)
    assert caught.value.cause == "tester_raised"
    assert "in tell" in caught.value.log


@pytest.mark.parametrize("status", [RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED])
def test_a_lost_run_does_not_become_part_of_the_search(
    whole: list[EvaluationRecord], status: RunStatus
) -> None:
    def lost(spec: RunSpec) -> RunReport:
        if spec.run_id.endswith("-23"):
            failure = RunFailure(cause="worker_lost", message="gone")
            return RunReport(run_id=spec.run_id, status=status, failure=failure)
        return perform(spec)

    journal = MemoryJournal()
    assert whole[23].status is not EvaluationStatus.INVALID
    with pytest.raises(CampaignError, match=r"evaluation 23 was lost.*gone"):
        run(journal, evaluator=Computed(work=lost))
    run(journal)
    assert sequence(list(journal.evaluations())) == sequence(whole)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: replace(r, asked_sha256="0" * 64), "other values"),
        (lambda r: replace(r, proposal=replace(r.proposal, origin="x")), "another origin"),
        (lambda r: replace(r, proposal=replace(r.proposal, parents=(0, 1))), "another origin"),
    ],
)
def test_a_journal_of_another_program_is_refused(
    whole: list[EvaluationRecord], change: object, said: str
) -> None:
    assert callable(change)
    stored = list(whole[:20])
    stored[9] = change(stored[9])
    with pytest.raises(CampaignError, match=f"evaluation 9 has {said}"):
        run(MemoryJournal(stored))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: replace(r, document_sha256="0" * 64), "another scenario"),
        (lambda r: replace(r, proposal=_rolled(r.proposal)), "other values"),
    ],
)
@pytest.mark.parametrize("number", [0, 50])
def test_a_journal_of_a_program_that_decodes_otherwise_is_refused(
    whole: list[EvaluationRecord], number: int, change: object, said: str
) -> None:
    assert callable(change)
    stored = list(whole)
    stored[number] = change(stored[number])
    with pytest.raises(CampaignError, match=f"evaluation {number} has {said}"):
        run(MemoryJournal(stored))


def _rolled(proposal: Proposal) -> Proposal:
    return replace(proposal, values=np.roll(proposal.values, 1))


def test_a_journal_without_hashes_of_proposals_is_compared_by_decoding(
    whole: list[EvaluationRecord],
) -> None:
    stored = [replace(record, asked_sha256="") for record in whole[:20]]
    journal = MemoryJournal(stored)
    run(journal)
    assert sequence(list(journal.evaluations())) == sequence(whole)
    stored[9] = replace(stored[9], proposal=_rolled(stored[9].proposal))
    with pytest.raises(CampaignError, match="evaluation 9 has other values"):
        run(MemoryJournal(stored))


def test_a_candidate_that_no_worker_has_decoded_does_not_become_part_of_the_search(
    whole: list[EvaluationRecord],
) -> None:
    class Forgetful(Computed):
        def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
            return tuple(
                replace(answer, candidate=None) if answer.number == 23 else answer
                for answer in super().wait(timeout)
            )

    journal = MemoryJournal()
    with pytest.raises(CampaignError, match="evaluation 23 has no scenario"):
        run(journal, evaluator=Forgetful())
    run(journal)
    assert sequence(list(journal.evaluations())) == sequence(whole)


def test_the_time_of_the_tester_is_measured(whole: list[EvaluationRecord]) -> None:
    assert all(record.search_s > 0.0 and record.prepare_s > 0.0 for record in whole)
