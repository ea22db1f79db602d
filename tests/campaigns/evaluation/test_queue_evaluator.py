from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.campaigns.evaluation.queue_evaluator import QueueEvaluator
from drivora_service.campaigns.evaluator import Answer, Evaluator, EvaluatorContext
from drivora_service.errors import Conflict
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.infrastructure import Infrastructure
from drivora_service.execution.local import LocalExecutor
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    NewCampaign,
)
from drivora_service.store.database import Database, open_database
from drivora_service.store.runs.run_records import BatchState, Priority, RunSummary
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.traces.trace_places import TracePlaces
from drivora_service.testing.evaluator_contract import EvaluatorContract
from tests.execution.owners import server
from tests.store.samples import claim, finish, finished, lost, register, statements, submit


def campaign(database: Database, name: str = "crossing") -> CampaignRecord:
    """A campaign that the service runs."""
    new = NewCampaign(
        name=name,
        document="{}",
        tester="random",
        agent="idm",
        town="tee-town",
        network_sha256="a" * 64,
        budget=10,
    )
    with database.write() as transaction:
        record = transaction.campaigns.create(new)
        transaction.campaign_runs.open(record.id)
        return transaction.campaigns.begin(record.id)


@pytest.mark.slow
class TestQueue(EvaluatorContract):
    """The contract, with a dispatcher and real workers."""

    @pytest.fixture(autouse=True)
    def served(self, tmp_path: Path) -> Iterator[None]:
        self.database = open_database(f"sqlite:///{tmp_path / 'drivora.sqlite3'}")
        self.places = TracePlaces.below(tmp_path)
        self.traces = TraceFolder(tmp_path / "traces")
        with contextlib.ExitStack() as self.stack:
            self.stack.callback(self.database.close)
            yield

    def create(self, context: EvaluatorContext) -> Evaluator:
        executor = LocalExecutor(
            slots=context.workers,
            setup=context.setup,
            folder=context.folder / "workers",
            limits=context.limits,
        )
        self.stack.callback(executor.close)
        dispatcher = Dispatcher(
            self.database,
            executor,
            self.traces,
            Infrastructure({}),
            server(self.database, context.folder),
        )
        dispatcher.start()
        self.stack.callback(dispatcher.stop)
        return QueueEvaluator(
            self.database, campaign(self.database), self.places, on_queued=dispatcher.wake
        )

    def test_a_trace_is_written_where_it_is_wanted_and_only_then(
        self, evaluator: Evaluator, tmp_path: Path
    ) -> None:
        wanted = tmp_path / "kept" / "one.parquet"
        evaluator.submit([(0, self.spec(0))])
        again = RunSpec(
            run_id="contract-1-again", document=self.document(0), trace_path=str(wanted)
        )
        evaluator.submit([(1, again)])
        first, second = sorted(self.collect(evaluator, 2), key=lambda answer: answer.number)
        assert first.report.trace_sha256 == second.report.trace_sha256
        assert second.report.measurement is None
        assert trace_sha256(read_trace(wanted)) == second.report.trace_sha256
        with self.database.read() as transaction:
            jobs = {job.id: job for job in transaction.jobs.page().items}
        assert jobs["contract-0"].trace_sha256 == ""
        assert not self.traces.path("contract-0").exists()
        assert jobs["contract-1-again"].trace_sha256 == second.report.trace_sha256


@pytest.fixture
def evaluate(database: Database, tmp_path: Path) -> QueueEvaluator:
    return QueueEvaluator(database, campaign(database), TracePlaces.below(tmp_path))


def spec(number: int, document: str = "") -> RunSpec:
    return RunSpec(
        run_id=f"campaign-{number}",
        document=document or f"{{{number}}}",
        feedback=FeedbackChoice(name="avfuzzer", parameters={"scale": 2.5}),
    )


def jobs(database: Database) -> list[RunSummary]:
    with database.read() as transaction:
        return list(transaction.jobs.page(newest_first=False).items)


def the_campaign(database: Database) -> CampaignRecord:
    with database.read() as transaction:
        return transaction.campaigns.get(transaction.campaigns.page().items[0].id)


def again(database: Database, tmp_path: Path) -> QueueEvaluator:
    """The evaluator of a process that resumes the campaign."""
    return QueueEvaluator(database, the_campaign(database), TracePlaces.below(tmp_path))


def test_runs_are_those_of_a_campaign(database: Database, evaluate: QueueEvaluator) -> None:
    evaluate.submit([(4, spec(4))])
    (job,) = jobs(database)
    assert (job.id, job.item, job.town, job.agent) == ("campaign-4", 4, "tee-town", "idm")
    with database.read() as transaction:
        batch = transaction.batches.get(job.batch_id)
    assert (batch.priority, batch.id) == (Priority.CAMPAIGN, the_campaign(database).batch_id)


def test_the_choice_of_feedback_and_of_a_trace_reach_the_worker(
    database: Database, evaluate: QueueEvaluator
) -> None:
    evaluate.submit([(0, spec(0))])
    evaluate.submit([(1, RunSpec(run_id="campaign-1", document="{1}", trace_path="/somewhere"))])
    owner = register(database)
    with database.write() as transaction:
        first, second = transaction.queue.claim(
            owner, 2, trace_path=lambda run_id, attempt: f"T {run_id} {attempt}"
        )
    assert first.feedback == spec(0).feedback
    assert first.trace_path == ""
    assert second.feedback is None
    assert second.trace_path == "T campaign-1 1"


def test_what_is_queued_runs_or_has_ended_is_not_queued_again(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    for number in range(3):
        evaluate.submit([(number, spec(number))])
    owner = register(database)
    assert claim(database, owner, 2) == ("campaign-0", "campaign-1")
    finish(database, owner, finished("campaign-1"))
    before = [(job.id, job.status, job.attempts) for job in jobs(database)]
    successor = again(database, tmp_path)
    for number in range(3):
        successor.submit([(number, spec(number))])
    assert [(job.id, job.status, job.attempts) for job in jobs(database)] == before
    assert [answer.number for answer in successor.wait(60.0)] == [1]
    finish(database, owner, finished("campaign-0"))
    assert [answer.number for answer in successor.wait(60.0)] == [0]
    assert successor.wait(0.0) == ()


@pytest.mark.parametrize("how", ["cancelled", "lost"])
def test_a_run_without_a_result_is_repeated(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path, how: str
) -> None:
    evaluate.submit([(0, spec(0))])
    owner = register(database)
    if how == "cancelled":
        with database.write() as transaction:
            transaction.jobs.cancel("campaign-0")
    else:
        for _ in range(3):
            claim(database, owner, 1)
            finish(database, owner, lost("campaign-0"))
    (answer,) = evaluate.wait(60.0)
    assert answer.report.status in (RunStatus.CANCELLED, RunStatus.INFRASTRUCTURE_FAILED)
    successor = again(database, tmp_path)
    successor.submit([(0, spec(0))])
    assert claim(database, owner, 5) == ("campaign-0",)
    finish(database, owner, finished("campaign-0", "collision"))
    (answer,) = successor.wait(60.0)
    assert answer.report.status is RunStatus.FINISHED
    assert len(jobs(database)) == 1


def test_a_run_of_another_scenario_is_no_answer(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    for number in range(3):
        evaluate.submit([(number, spec(number))])
    owner = register(database)
    claim(database, owner, 2)
    finish(database, owner, finished("campaign-0"))
    successor = again(database, tmp_path)
    successor.submit([(0, spec(0, "{new 0}"))])
    successor.submit([(2, spec(2, "{new 2}"))])
    with pytest.raises(Conflict, match="campaign-1 is running with another scenario"):
        successor.submit([(1, spec(1, "{new 1}"))])
    with database.read() as transaction:
        documents = [transaction.jobs.document(f"campaign-{number}") for number in range(3)]
    assert documents == ["{new 0}", "{1}", "{new 2}"]
    assert successor.wait(0.0) == ()


def test_no_more_runs_wait_than_the_campaign_has_workers(
    database: Database, tmp_path: Path
) -> None:
    evaluator = QueueEvaluator(database, campaign(database), TracePlaces.below(tmp_path), most=2)
    for number in range(4):
        evaluator.submit([(number, spec(number))])
    owner = register(database)
    assert claim(database, owner, 10) == ("campaign-0", "campaign-1")
    finish(database, owner, finished("campaign-0"))
    assert [answer.number for answer in evaluator.wait(60.0)] == [0]
    assert claim(database, owner, 10) == ("campaign-2",)


def test_campaigns_take_turns_and_everything_else_goes_first(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    other = QueueEvaluator(database, campaign(database, "other"), TracePlaces.below(tmp_path))
    for number in range(3):
        evaluate.submit([(number, spec(number))])
    for number in range(3):
        other.submit([(number, RunSpec(run_id=f"other-{number}", document=f"{{{number}}}"))])
    owner = register(database)
    assert sorted(claim(database, owner, 2)) == ["campaign-0", "other-0"]
    ci = submit(database, 2, priority=Priority.CI)
    assert claim(database, owner, 3)[:2] == ci


@pytest.mark.parametrize(
    ("state", "batch_state"),
    [
        (CampaignState.PAUSED, BatchState.PAUSED),
        (CampaignState.FAILED, BatchState.PAUSED),
        (CampaignState.CANCELLED, BatchState.CANCELLED),
        (CampaignState.FINISHED, BatchState.OPEN),
    ],
)
def test_the_runs_of_a_campaign_rest_and_end_with_it(
    database: Database,
    evaluate: QueueEvaluator,
    tmp_path: Path,
    state: CampaignState,
    batch_state: BatchState,
) -> None:
    evaluate.submit([(0, spec(0))])
    record = the_campaign(database)
    with database.write() as transaction:
        transaction.campaigns.end(record.id, state)
        assert transaction.batches.get(record.batch_id).state == batch_state
    if state in (CampaignState.PAUSED, CampaignState.FAILED):
        owner = register(database)
        assert claim(database, owner, 1) == ()
        again(database, tmp_path)
        assert claim(database, owner, 1) == ("campaign-0",)


def test_a_campaign_that_waits_is_cancelled_with_its_runs(
    database: Database, evaluate: QueueEvaluator
) -> None:
    evaluate.submit([(0, spec(0))])
    record = the_campaign(database)
    with database.write() as transaction:
        transaction.campaigns.end(record.id, CampaignState.PAUSED)
        transaction.campaigns.ask_for(record.id, CampaignRequest.CANCEL)
    assert [job.status for job in jobs(database)] == [RunStatus.CANCELLED]


def test_a_missing_trace_does_not_stop_the_report(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    wanted = tmp_path / "campaign" / "trace.parquet"
    evaluate.submit([(0, RunSpec(run_id="campaign-0", document="{0}", trace_path=str(wanted)))])
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished("campaign-0", trace="b" * 64))
    shutil.rmtree(tmp_path / "traces", ignore_errors=True)
    answers: tuple[Answer, ...] = evaluate.wait(60.0)
    assert [answer.number for answer in answers] == [0]
    assert not wanted.exists()


def test_runs_that_are_queued_together_take_as_many_statements_as_one(
    database: Database, evaluate: QueueEvaluator
) -> None:
    numbers = []
    for specs in ([(0, spec(0))], [(number, spec(number)) for number in range(1, 40)]):
        with statements(database) as sent:
            evaluate.submit(specs)
        numbers.append(len(sent))
    assert numbers[0] == numbers[1] > 0
    assert len(jobs(database)) == 40


def test_a_wait_reads_nothing_while_the_database_does_not_change(
    database: Database, evaluate: QueueEvaluator
) -> None:
    evaluate.submit([(0, spec(0)), (1, spec(1))])
    assert evaluate.wait(0.0) == ()
    with statements(database) as sent:
        assert evaluate.wait(0.1) == ()
    assert sent == []
    owner = register(database)
    (run,) = claim(database, owner, 1)
    finish(database, owner, finished(run))
    assert [answer.number for answer in evaluate.wait(1.0)] == [0]
