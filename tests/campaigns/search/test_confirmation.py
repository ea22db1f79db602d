from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search import confirmation
from drivora_service.campaigns.search.confirmation import confirm_failures, group_failures
from drivora_service.errors import CampaignError
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignRequest, Confirmation
from tests.campaigns.analytic import Computed, perform, run


@pytest.fixture
def journal() -> MemoryJournal:
    """A campaign whose search is over."""
    made = MemoryJournal()
    run(made)
    return made


def failing(journal: MemoryJournal) -> list[int]:
    return sorted({failure.evaluation for failure in journal.failures()})


def test_another_trace_or_none_is_flaky(journal: MemoryJournal) -> None:
    other, none, *rest = failing(journal)

    def work(spec: RunSpec) -> RunReport:
        report = perform(spec)
        if spec.run_id == f"test-{other}-again":
            return replace(report, trace_sha256="f" * 64)
        if spec.run_id == f"test-{none}-again":
            failure = RunFailure(cause="agent_hung", message="too slow")
            return RunReport(run_id=spec.run_id, status=RunStatus.AGENT_FAILED, failure=failure)
        return report

    answers: dict[int, Confirmation] = {}
    confirm_failures(
        journal,
        Computed(work=work),
        run_prefix="test",
        trace_address=None,
        on_confirmed=answers.__setitem__,
    )
    assert answers[other] is answers[none] is Confirmation.FLAKY
    assert {answers[number] for number in rest} == {Confirmation.CONFIRMED}
    assert {f.evaluation: f.confirmation for f in journal.failures()} == answers
    group_failures(journal)
    ungrouped = {f.evaluation for f in journal.failures() if f.group is None}
    assert ungrouped == {other, none}


def test_traces_are_asked_for_and_named(journal: MemoryJournal, tmp_path: Path) -> None:
    asked: dict[str, str] = {}

    def work(spec: RunSpec) -> RunReport:
        asked[spec.run_id] = spec.trace_path
        return perform(spec)

    folder = tmp_path / "traces"
    confirm_failures(
        journal,
        Computed(work=work),
        run_prefix="test",
        trace_address=lambda name: str(folder / name),
    )
    for failure in journal.failures():
        assert asked[f"test-{failure.evaluation}-again"] == str(folder / failure.trace)


def test_a_request_stops_it_and_the_rest_is_done_later(journal: MemoryJournal) -> None:
    answered: list[int] = []
    request = confirm_failures(
        journal,
        Computed(),
        run_prefix="test",
        trace_address=None,
        requested=lambda: CampaignRequest.PAUSE if answered else CampaignRequest.NONE,
        on_confirmed=lambda number, _: answered.append(number),
    )
    assert request is CampaignRequest.PAUSE
    assert len(answered) == 1
    rest = Computed()
    confirm_failures(journal, rest, run_prefix="test", trace_address=None)
    assert sorted(rest.submitted + answered) == failing(journal)


def test_a_lost_run_is_no_answer(journal: MemoryJournal) -> None:
    def lost(spec: RunSpec) -> RunReport:
        failure = RunFailure(cause="worker_lost", message="gone")
        status = RunStatus.INFRASTRUCTURE_FAILED
        return RunReport(run_id=spec.run_id, status=status, failure=failure)

    with pytest.raises(CampaignError, match="was lost"):
        confirm_failures(journal, Computed(work=lost), run_prefix="test", trace_address=None)
    assert {f.confirmation for f in journal.failures()} == {Confirmation.OPEN}


def test_few_runs_are_held_at_the_same_time(
    journal: MemoryJournal, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(confirmation, "_AT_ONCE", 4)
    evaluator = Computed()
    assert len(failing(journal)) > 8
    confirm_failures(journal, evaluator, run_prefix="test", trace_address=None)
    assert sorted(evaluator.submitted) == failing(journal)
    assert evaluator.most_under_way == 4
    assert journal.open_numbers() == frozenset()
