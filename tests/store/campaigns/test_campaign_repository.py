from __future__ import annotations

import hashlib
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import text

from drivora_service.errors import Conflict, InvalidDocument, UnknownName
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.store.campaigns.campaign_records import (
    CampaignRequest,
    CampaignState,
    Confirmation,
    EvaluationRecord,
    FailureFilter,
    NewCampaign,
)
from drivora_service.store.campaigns.campaign_warnings import WarningCode
from drivora_service.store.campaigns.seed_run_records import SeedRun
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_folders import CampaignTraces, TraceFolder
from drivora_service.store.upkeep.backup import back_up
from drivora_service.store.upkeep.pruning import prune
from drivora_service.store.upkeep.store_verification import verify
from tests.store.samples import new_run, only_sqlite


def create(database: Database, name: str = "search") -> str:
    campaign = NewCampaign(
        name=name,
        document='{"name":"search"}',
        tester="random",
        agent="idm",
        town="tee-town",
        network_sha256="a" * 64,
        budget=10,
        versions={"numpy": "2"},
    )
    with database.write() as transaction:
        return transaction.campaigns.create(campaign).id


def evaluation(
    number: int,
    *,
    parents: tuple[int, ...] = (),
    status: EvaluationStatus = EvaluationStatus.JUDGED,
    violated: tuple[bool | None, ...] = (),
    avoidable: Answer | None = None,
    undetermined: bool = False,
    oracle: str = "collision",
) -> EvaluationRecord:
    """An evaluation with its number as its scenario; ``violated`` has the faults."""
    verdicts = tuple(
        Verdict(
            oracle=oracle,
            ego="ego_0",
            outcome=Outcome.VIOLATED,
            message="",
            at_fault=fault,
            avoidable=avoidable,
            undetermined=undetermined,
            time=float(place),
            location=(1.0, 2.0),
            evidence={"ego_speed": 0.1 + 0.2},
        )
        for place, fault in enumerate(violated)
    )
    valid = status is not EvaluationStatus.INVALID
    report = RunReport(
        run_id=f"run-{number}",
        status=RunStatus.FINISHED if valid else RunStatus.INVALID,
        verdicts=verdicts,
        trace_sha256="7" * 64 if valid else "",
        failure=None if valid else RunFailure(cause="invalid_document", message="too near"),
    )
    return EvaluationRecord(
        number=number,
        proposal=Proposal(
            values=np.array([0.1 * number, 1.0 / 3.0, -1e-17]),
            origin="mutation" if parents else "initial",
            generation=number // 2,
            parents=parents,
        ),
        status=status,
        document_sha256=hashlib.sha256(str(number).encode()).hexdigest() if valid else "",
        report=report,
        violations=verdicts,
        failure_kinds=tuple(f"{oracle}|road a" for _ in verdicts),
        search_s=0.01,
        prepare_s=0.02,
    )


def append(database: Database, campaign_id: str, *records: EvaluationRecord) -> None:
    entries = [(record, str(record.number) if record.document_sha256 else "") for record in records]
    with database.write() as transaction:
        transaction.evaluations.append(campaign_id, entries, active_s=0.5 * len(entries))


def test_a_campaign_is_read_as_it_was_stored(database: Database) -> None:
    campaign_id = create(database)
    with database.read() as transaction:
        record = transaction.campaigns.get(campaign_id)
    assert (record.name, record.tester, record.budget) == ("search", "random", 10)
    assert record.document == {"name": "search"}
    assert record.versions == {"numpy": "2"}
    assert record.state is CampaignState.QUEUED
    assert record.counts.evaluations == 0
    assert (record.rate, record.left_s) == (None, None)


def test_counts_follow_the_evaluations(database: Database) -> None:
    campaign_id = create(database)
    append(
        database,
        campaign_id,
        evaluation(0),
        evaluation(1, status=EvaluationStatus.INVALID),
        evaluation(2, violated=(True, None)),
        evaluation(3, violated=(None,)),
        evaluation(4, status=EvaluationStatus.FAILED),
    )
    with database.read() as transaction:
        record = transaction.campaigns.get(campaign_id)
    counts = record.counts
    assert (counts.evaluations, counts.simulations) == (5, 4)
    assert (counts.judged, counts.invalid, counts.failed) == (3, 1, 1)
    assert (counts.violating, counts.at_fault) == (2, 1)
    assert record.active_s == pytest.approx(2.5)
    assert record.rate == pytest.approx(4 / 2.5)
    assert record.left_s == pytest.approx(6 / (4 / 2.5))


def test_simulations_in_which_others_are_at_fault_are_counted(database: Database) -> None:
    campaign_id = create(database)
    others = [
        replace(record, violations=(), failure_kinds=(), strongest=degree)
        for record, degree in (
            (evaluation(0), Accountability.NOT_AT_FAULT),
            (evaluation(1), Accountability.PREVENTABLE),
            (evaluation(2), None),
        )
    ]
    append(database, campaign_id, *others)
    with database.read() as transaction:
        counts = transaction.campaigns.get(campaign_id).counts
    assert (counts.violating, counts.not_at_fault, counts.preventable) == (0, 1, 1)
    assert counts.apart == ((1, "not at fault, but avoidable"), (1, "not at fault"))


def test_failures_are_counted_by_what_the_ego_is_accountable_for(database: Database) -> None:
    campaign_id = create(database)
    append(
        database,
        campaign_id,
        evaluation(0, violated=(True,), avoidable=Answer.YES),
        evaluation(1, violated=(True,), avoidable=Answer.NO),
        evaluation(2, violated=(True,), avoidable=Answer.NOT_MEASURABLE),
        evaluation(3, violated=(None,), undetermined=True),
        evaluation(4, violated=(None,)),
        evaluation(5, violated=(True, None)),
        evaluation(6),
    )
    with database.read() as transaction:
        counts = transaction.campaigns.get(campaign_id).counts
        (kind,) = transaction.campaign_views.kinds(campaign_id)
        page = transaction.campaign_views.evaluations(campaign_id)
        unavoidable = transaction.campaign_views.failures(
            campaign_id, FailureFilter(accountability=Accountability.UNAVOIDABLE)
        )
    assert (counts.violating, counts.at_fault) == (6, 4)
    assert (counts.avoidable, counts.unavoidable, counts.undetermined) == (2, 1, 1)
    assert (kind.at_fault, kind.avoidable) == (4, 2)
    assert [item.accountability for item in page.items] == [
        Accountability.AVOIDABLE,
        Accountability.UNAVOIDABLE,
        Accountability.NOT_MEASURABLE,
        Accountability.UNDETERMINED,
        Accountability.NOT_JUDGED,
        Accountability.AVOIDABLE,
        None,
    ]
    assert [failure.evaluation for failure in unavoidable.items] == [1]


def test_values_come_back_to_the_last_digit(database: Database) -> None:
    campaign_id = create(database)
    sent = evaluation(3, parents=(0, 2), violated=(True,))
    append(database, campaign_id, *(evaluation(n) for n in range(3)), sent)
    with database.read() as transaction:
        read = transaction.evaluations.get(campaign_id, 3)
        document = transaction.evaluations.document(campaign_id, 3)
    assert read.proposal.values.tobytes() == sent.proposal.values.tobytes()
    assert (read.proposal.origin, read.proposal.generation) == ("mutation", 1)
    assert read.proposal.parents == (0, 2)
    assert read.violations == sent.violations
    assert read.report == sent.report
    assert (read.search_s, read.prepare_s) == (0.01, 0.02)
    assert document == "3"


def test_pages_of_evaluations_and_the_violating_ones(database: Database) -> None:
    campaign_id = create(database)
    append(database, campaign_id, *(evaluation(n, violated=(True,) * (n % 2)) for n in range(7)))
    with database.read() as transaction:
        page = transaction.evaluations.page(campaign_id, after=2, limit=3)
        violating = transaction.evaluations.page(campaign_id, violating=True)
    assert [record.number for record in page] == [3, 4, 5]
    assert [record.number for record in violating] == [1, 3, 5]
    assert all(record.violations for record in violating)


def test_a_lineage_holds_every_ancestor_once(database: Database) -> None:
    campaign_id = create(database)
    family = {0: (), 1: (), 2: (0,), 3: (1,), 4: (2, 0), 5: (3,), 6: (4, 2)}
    append(database, campaign_id, *(evaluation(n, parents=p) for n, p in family.items()))
    with database.read() as transaction:
        lineage = transaction.campaign_views.ancestors(campaign_id, 6, most=10)
        nearest = transaction.campaign_views.ancestors(campaign_id, 6, most=2)
        none = transaction.campaign_views.ancestors(campaign_id, 1, most=10)
    assert [summary.number for summary in lineage] == [0, 2, 4]
    assert [summary.number for summary in nearest] == [2, 4]
    assert none == ()


def test_campaigns_do_not_see_each_others_evaluations(database: Database) -> None:
    one, other = create(database), create(database)
    append(database, one, evaluation(0, violated=(True,)))
    append(database, other, evaluation(0), evaluation(1))
    with database.read() as transaction:
        assert len(transaction.evaluations.failures(one)) == 1
        assert transaction.evaluations.failures(other) == ()
        assert len(transaction.evaluations.page(other)) == 2


def test_a_number_is_stored_once_and_in_turn(database: Database) -> None:
    campaign_id = create(database)
    append(database, campaign_id, evaluation(0))
    for wrong in (0, 2):
        with pytest.raises(Conflict, match="does not follow"):
            append(database, campaign_id, evaluation(wrong))
    with database.read() as transaction:
        assert transaction.campaigns.get(campaign_id).counts.evaluations == 1


def test_what_is_not_there_is_named(database: Database) -> None:
    campaign_id = create(database)
    append(database, campaign_id, evaluation(0, status=EvaluationStatus.INVALID))
    with database.read() as transaction:
        with pytest.raises(UnknownName, match="campaign 'nothing'"):
            transaction.campaigns.get("nothing")
        with pytest.raises(UnknownName, match="0 to 0"):
            transaction.evaluations.get(campaign_id, 1)
        with pytest.raises(UnknownName, match="Invalid candidates have none"):
            transaction.evaluations.document(campaign_id, 0)


def test_a_life_with_pauses(database: Database) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        campaigns = transaction.campaigns
        running = campaigns.begin(campaign_id)
        assert running.state is CampaignState.RUNNING
        asked = campaigns.ask_for(campaign_id, CampaignRequest.PAUSE)
        assert (asked.state, asked.request) == (CampaignState.RUNNING, CampaignRequest.PAUSE)
        assert campaigns.request_of(campaign_id) is CampaignRequest.PAUSE
        paused = campaigns.end(campaign_id, CampaignState.PAUSED, active_s=2.0)
        assert (paused.request, paused.active_s) == (CampaignRequest.NONE, 2.0)
        assert campaigns.queue_again(campaign_id).state is CampaignState.QUEUED
        again = campaigns.begin(campaign_id)
        assert again.started_at == running.started_at
        finished = campaigns.end(campaign_id, CampaignState.FINISHED)
        assert finished.ended_at is not None
        with pytest.raises(Conflict, match="finished"):
            campaigns.begin(campaign_id)
        with pytest.raises(Conflict, match="finished"):
            campaigns.ask_for(campaign_id, CampaignRequest.PAUSE)
        with pytest.raises(Conflict, match="finished"):
            campaigns.queue_again(campaign_id)
        same = campaigns.ask_for(campaign_id, CampaignRequest.CANCEL)
        assert same.state is CampaignState.FINISHED


@pytest.mark.parametrize(
    ("request_", "state"),
    [
        (CampaignRequest.PAUSE, CampaignState.PAUSED),
        (CampaignRequest.CANCEL, CampaignState.CANCELLED),
    ],
)
def test_a_campaign_that_waits_stops_at_once(
    database: Database, request_: CampaignRequest, state: CampaignState
) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        assert transaction.campaigns.ask_for(campaign_id, request_).state is state


def test_cancelling_is_not_weakened_to_pausing(database: Database) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
        transaction.campaigns.ask_for(campaign_id, CampaignRequest.CANCEL)
        asked = transaction.campaigns.ask_for(campaign_id, CampaignRequest.PAUSE)
        assert asked.request is CampaignRequest.CANCEL


def test_a_failed_campaign_states_the_reason_and_can_be_resumed(database: Database) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
        failed = transaction.campaigns.end(campaign_id, CampaignState.FAILED, message="no worker")
        assert failed.message == "no worker"
        again = transaction.campaigns.begin(campaign_id)
        assert (again.message, again.ended_at) == ("", None)


def test_lists_are_paged_and_filtered(database: Database) -> None:
    ids = [create(database, f"campaign {n}") for n in range(5)]
    with database.write() as transaction:
        transaction.campaigns.begin(ids[1])
        first = transaction.campaigns.page(limit=3)
        second = transaction.campaigns.page(limit=3, page_token=first.next_page_token)
        running = transaction.campaigns.page(states={CampaignState.RUNNING})
        with pytest.raises(InvalidDocument):
            transaction.campaigns.page(
                states={CampaignState.RUNNING}, page_token=first.next_page_token
            )
    assert [c.id for c in (*first.items, *second.items)] == ids[::-1]
    assert second.next_page_token == ""
    assert [c.id for c in running.items] == [ids[1]]


def test_contradictions_in_campaigns_are_found(database: Database, tmp_path: Path) -> None:
    campaign_id, other = create(database), create(database)
    append(database, campaign_id, *(evaluation(n, violated=(True,)) for n in range(4)))
    traces = CampaignTraces(tmp_path / "campaigns")
    traces.path(campaign_id, "any").parent.mkdir(parents=True)
    with database.write() as transaction:
        for number, confirmation in enumerate(
            (Confirmation.CONFIRMED, Confirmation.FLAKY, Confirmation.CONFIRMED)
        ):
            name = f"{number}.trace.parquet"
            traces.path(campaign_id, name).write_text("another trace")
            transaction.evaluations.confirm(campaign_id, number, confirmation, trace=name)
    traces.path(campaign_id, "2.trace.parquet").unlink()
    runs = TraceFolder(tmp_path / "traces")

    def kinds() -> dict[str, set[str]]:
        found: dict[str, set[str]] = {}
        for finding in verify(
            database, runs, campaign_traces=traces, hash_trace=lambda path: path.read_text()
        ):
            found.setdefault(finding.kind, set()).add(finding.subject)
        return found

    assert kinds() == {
        "damaged_trace": {f"{campaign_id}/0.trace.parquet"},
        "missing_trace": {f"{campaign_id}/2.trace.parquet"},
    }
    with database.engine.begin() as connection:
        connection.execute(text("DELETE FROM evaluations WHERE number = 1"))
        connection.execute(text("UPDATE campaigns SET invalid = 1 WHERE id = :id"), {"id": other})
    assert kinds()["wrong_count"] == {campaign_id, other}


@only_sqlite
def test_a_backup_holds_the_traces_of_failures(database: Database, tmp_path: Path) -> None:
    campaign_id = create(database)
    append(database, campaign_id, evaluation(0, violated=(True,)), evaluation(1, violated=(None,)))
    traces = CampaignTraces(tmp_path / "campaigns")
    traces.path(campaign_id, "any").parent.mkdir(parents=True)
    traces.path(campaign_id, "0.trace.parquet").write_text("trace")
    with database.write() as transaction:
        for number in range(2):
            name = f"{number}.trace.parquet"
            transaction.evaluations.confirm(campaign_id, number, Confirmation.CONFIRMED, trace=name)
    made = back_up(
        database, TraceFolder(tmp_path / "traces"), tmp_path / "copy", campaign_traces=traces
    )
    assert (made.traces, made.missing_traces) == (1, (f"{campaign_id}/1.trace.parquet",))
    copied = CampaignTraces(tmp_path / "copy" / "campaigns").path(campaign_id, "0.trace.parquet")
    assert copied.read_text() == "trace"


def test_pruning_runs_leaves_the_scenarios_of_evaluations(
    database: Database, tmp_path: Path
) -> None:
    campaign_id = create(database)
    append(database, campaign_id, evaluation(0))
    with database.write() as transaction:
        (run_id,) = transaction.jobs.submit([new_run("{1}")])
        transaction.jobs.cancel(run_id)
    soon = datetime.now(UTC) + timedelta(days=1)
    assert prune(database, TraceFolder(tmp_path / "traces"), ended_before=soon).runs == 1
    with database.read() as transaction:
        assert transaction.evaluations.document(campaign_id, 0) == "0"


def test_an_unknown_id_is_refused_with_similar_ones(database: Database) -> None:
    refused = pytest.raises(UnknownName, match=r"unknown campaign 'a'$")
    with database.read() as transaction, refused:
        transaction.campaigns.get("a")
    ids = [create(database, name) for name in ("a", "b", "b", "c", "d", "e", "f")]
    with database.read() as transaction:
        with pytest.raises(UnknownName, match=f"known: {ids[2]}, {ids[1]}. That is a name"):
            transaction.campaigns.get("b")
        newest = ", ".join(reversed(ids[2:]))
        with pytest.raises(UnknownName, match=f"known: {newest}, …$"):
            transaction.evaluations.failures("x")
        with pytest.raises(UnknownName, match=f"known: {newest}, …$"):
            transaction.campaigns.request_of("x")


def test_the_scenario_of_no_evaluation_is_refused_as_the_evaluation_is(database: Database) -> None:
    campaign_id = create(database)
    refused = pytest.raises(UnknownName, match="unknown evaluation '9'")
    with database.read() as transaction, refused:
        transaction.evaluations.document(campaign_id, 9)


def test_the_runs_of_seeds_are_kept_and_change_the_campaign(database: Database) -> None:
    campaign_id = create(database)
    violated = Verdict(oracle="collision", ego="ego_0", outcome=Outcome.VIOLATED, message="m")
    runs = (
        SeedRun(place=0, name="a", run_id="r", status=RunStatus.FINISHED, failures=(violated,)),
        SeedRun(
            place=1,
            name="b",
            run_id="s",
            status=RunStatus.AGENT_FAILED,
            error=RunFailure(cause="agent_raised", message="no camera"),
        ),
    )
    with database.read() as transaction:
        before = transaction.campaigns.get(campaign_id)
    assert (before.seed_runs, before.warnings) == ((), ())
    with database.write() as transaction:
        transaction.campaigns.keep_seed_runs(campaign_id, runs)
    with database.read() as transaction:
        after = transaction.campaigns.get(campaign_id)
        (listed,) = transaction.campaigns.page().items
    assert after.seed_runs == listed.seed_runs == runs
    assert [one.code for one in after.warnings] == [WarningCode.SEED_FAILS]
    assert after.revision > before.revision


def test_failures_of_the_ads_itself_are_counted(database: Database) -> None:
    campaign_id = create(database)
    failed = [
        replace(
            one := evaluation(number, status=EvaluationStatus.FAILED),
            report=replace(one.report, status=status),
        )
        for number, status in enumerate((RunStatus.AGENT_FAILED, RunStatus.TIMED_OUT))
    ]
    with database.write() as transaction:
        entries = [(one, str(one.number)) for one in failed]
        transaction.evaluations.append(campaign_id, entries, active_s=1.0)
    with database.read() as transaction:
        counts = transaction.campaigns.get(campaign_id).counts
    assert (counts.failed, counts.agent_failed) == (2, 1)
    # A campaign from before this was counted never gets a partial count.
    with database.write() as transaction:
        transaction.session.execute(text("UPDATE campaigns SET agent_failed = NULL"))
    with database.write() as transaction:
        later = replace(failed[0], number=2)
        transaction.evaluations.append(campaign_id, [(later, "0")], active_s=1.0)
    with database.read() as transaction:
        assert transaction.campaigns.get(campaign_id).counts.agent_failed is None
