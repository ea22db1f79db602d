from __future__ import annotations

import pytest

from drivora_service.errors import InvalidDocument, UnknownName
from drivora_service.oracles.verdict import Answer, Severity
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import JobFilter, Page, Priority, RunSummary
from tests.store.campaigns.test_campaign_repository import append, create, evaluation
from tests.store.samples import claim, finish, finished, new_run, only_sqlite, register, submit
from tests.store.test_query_plans import plan, queries, refuse_unbounded


def test_pages_cover_everything_once_while_the_table_grows(database: Database) -> None:
    runs = submit(database, 10)
    seen: list[str] = []
    token = ""
    while True:
        with database.read() as transaction:
            page = transaction.jobs.page(limit=3, page_token=token)
        seen += [job.id for job in page.items]
        token = page.next_page_token
        if not token:
            break
        submit(database, 1)
    assert seen == list(reversed(runs))


@only_sqlite
def test_a_run_of_a_campaign_names_its_evaluation(database: Database) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        batch_id = transaction.campaign_runs.open(campaign_id)
        runs = [
            new_run("{}", run_id=f"{campaign_id}-7", item=7),
            new_run("{}", run_id=f"{campaign_id}-7-again", item=7),
        ]
        transaction.jobs.submit(runs, batch_id=batch_id)
        other = transaction.batches.create(name="b", priority=Priority.CI)
        (in_batch,) = transaction.jobs.submit([new_run("{}")], batch_id=other.id)
    (alone,) = submit(database, 1)
    append(database, campaign_id, evaluation(0))
    owner = register(database)
    finish(database, owner, *map(finished, claim(database, owner, 1)))
    with queries(database) as asked, database.read() as transaction:
        of_run = {
            run_id: (run.campaign_id, run.evaluation)
            for run_id in (*(run.run_id for run in runs), in_batch, alone)
            for run in [transaction.jobs.detail(run_id)]
        }
        without_job = transaction.campaign_views.run(EvaluationId(campaign_id, 0))
    evaluations = {run.run_id: (campaign_id, 7) for run in runs}
    assert of_run == {**evaluations, in_batch: ("", None), alone: ("", None)}
    assert (without_job.campaign_id, without_job.evaluation) == (campaign_id, 0)
    steps = [step for query in asked for step in plan(database, *query)]
    refuse_unbounded(steps)
    assert not [step for step in steps if step.startswith("SCAN campaigns")]


def test_a_token_of_another_query_is_refused(database: Database) -> None:
    submit(database, 3)
    with database.read() as transaction:
        token = transaction.jobs.page(limit=1).next_page_token
        for wrong in (token + "x", "!!!", "bm9uc2Vuc2U"):
            with pytest.raises(InvalidDocument, match="page token"):
                transaction.jobs.page(limit=1, page_token=wrong)
        with pytest.raises(InvalidDocument, match="page token"):
            transaction.jobs.page(JobFilter(town="x"), limit=1, page_token=token)


def test_filters(database: Database) -> None:
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI)
        crash, clean, other = transaction.jobs.submit(
            [new_run("a"), new_run("b", agent="krauss"), new_run("c", town="grid")],
            batch_id=batch.id,
        )
    (alone,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 9)
    finish(database, owner, finished(crash, "collision", "red_light"), finished(clean))

    def found(**wanted: object) -> set[str]:
        with database.read() as transaction:
            page: Page[RunSummary] = transaction.jobs.page(
                JobFilter(**wanted)  # type: ignore[arg-type] # the test names the fields
            )
        return {job.id for job in page.items}

    assert found() == {crash, clean, other, alone}
    assert found(batch_id=batch.id) == {crash, clean, other}
    assert found(batch_id="nothing") == set()
    assert found(statuses=frozenset({RunStatus.FINISHED})) == {crash, clean}
    assert found(agent="krauss") == {clean}
    assert found(town="grid") == {other}
    assert found(oracle="red_light") == {crash}
    assert found(oracle="red_light", at_fault=False) == set()
    assert found(violated=True) == {crash}
    assert found(violated=False) == {clean}
    assert found(scenario_sha256=new_run("c").scenario_sha256) == {other}
    with database.read() as transaction:
        record = transaction.batches.get(batch.id)
    assert record.counts == {RunStatus.FINISHED: 2, RunStatus.RUNNING: 1}
    assert (record.size, record.violated_runs, record.done) == (3, 1, False)


@pytest.mark.parametrize("faults", [(True, True, True), (True, False), (False, True, True)])
def test_a_run_with_several_verdicts_of_an_oracle_is_listed_once(
    database: Database, faults: tuple[bool, ...]
) -> None:
    with database.write() as transaction:
        # Each agent's runs are counted apart.
        runs = [new_run(f"{{{number}}}", agent=f"agent-{number % 25}") for number in range(60)]
        ids = transaction.jobs.submit(runs)
    owner = register(database)
    claim(database, owner, 60)
    finish(database, owner, *(finished(run, "collision", faults=faults) for run in ids))
    wanted = [JobFilter(oracle="collision")]
    wanted += [JobFilter(oracle="collision", at_fault=fault) for fault in set(faults)]
    for each in wanted:
        for limit in (1, 2, 11, 17, 50):
            listed: list[str] = []
            token = ""
            with database.read() as transaction:
                while True:
                    page = transaction.jobs.page(each, limit=limit, page_token=token)
                    listed += [job.id for job in page.items]
                    if not (token := page.next_page_token):
                        break
                    assert len(page.items) == limit
            assert listed == list(reversed(ids))


def test_observations_are_no_violations_and_runs_are_found_by_accountability(
    database: Database,
) -> None:
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI)
        hit, unavoidable, harsh = transaction.jobs.submit(
            [new_run("a"), new_run("b"), new_run("c")], batch_id=batch.id
        )
    owner = register(database)
    claim(database, owner, 9)
    finish(
        database,
        owner,
        finished(hit, "collision", avoidable=Answer.YES),
        finished(unavoidable, "collision", avoidable=Answer.NO),
        finished(harsh, "discomfort", severity=Severity.OBSERVATION),
    )
    with database.read() as transaction:
        jobs = {job.id: job for job in transaction.jobs.page(JobFilter()).items}
        found = transaction.jobs.page(JobFilter(accountability=Accountability.UNAVOIDABLE))
        batch = transaction.batches.get(batch.id)
    assert [job.id for job in found.items] == [unavoidable]
    assert (jobs[hit].violations, jobs[hit].observations) == (1, 0)
    assert jobs[hit].accountability is Accountability.AVOIDABLE
    assert (jobs[harsh].violations, jobs[harsh].observations) == (0, 1)
    assert jobs[harsh].accountability is None
    assert batch.violated_runs == 2


def test_documents_are_kept_once_and_given_back(database: Database) -> None:
    with database.write() as transaction:
        ids = transaction.jobs.submit([new_run("same"), new_run("same"), new_run("other")])
    with database.read() as transaction:
        assert [transaction.jobs.document(job_id) for job_id in ids] == ["same", "same", "other"]
        hashes = [transaction.jobs.get(job_id).scenario_sha256 for job_id in ids]
        found = transaction.jobs.documents([*hashes, "unknown"])
        assert found == {hashes[0]: "same", hashes[2]: "other"}


def test_unknown_ids_are_named(database: Database) -> None:
    with database.write() as transaction:
        for ask in (
            transaction.jobs.get,
            transaction.jobs.document,
            transaction.jobs.report,
            transaction.jobs.cancel,
            transaction.batches.get,
            transaction.batches.cancel,
        ):
            with pytest.raises(UnknownName, match="'nobody'"):
                ask("nobody")


def test_nothing_is_kept_of_a_transaction_that_fails(database: Database) -> None:
    with pytest.raises(UnknownName), database.write() as transaction:  # noqa: PT012 # as a whole
        transaction.jobs.submit([new_run()])
        transaction.jobs.get("nobody")
    with database.read() as transaction:
        assert transaction.jobs.page().items == ()
