"""Random operations on a database: counters equal a recount, lists equal a plain search."""

from __future__ import annotations

import tempfile
from collections import Counter
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from sqlalchemy import text

from drivora_service.oracles.verdict import Answer, Outcome, Severity
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.runs.run_records import BatchState, JobFilter, Priority, RunSummary
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.pruning import prune
from drivora_service.store.upkeep.store_verification import verify
from tests.postgresql_server import PostgresqlServer
from tests.store.samples import (
    POLICY,
    claim,
    crashed,
    ended,
    finish,
    finished,
    lost,
    new_run,
    register,
)

AGENTS = ("idm", "krauss")
TOWNS = ("tee-town", "grid")
ORACLES = ("collision", "red_light")

filters = st.builds(
    JobFilter,
    statuses=st.frozensets(st.sampled_from(RunStatus), max_size=3),
    agent=st.sampled_from(("", *AGENTS)),
    town=st.sampled_from(("", *TOWNS)),
    oracle=st.sampled_from(("", "", *ORACLES)),
    outcome=st.sampled_from((Outcome.VIOLATED, Outcome.VIOLATED, Outcome.NOT_MEASURABLE)),
    at_fault=st.sampled_from((None, None, True, False)),
    accountability=st.sampled_from((None, None, *Accountability)),
    violated=st.sampled_from((None, None, True, False)),
    scenario_sha256=st.sampled_from(("", "", new_run("0").scenario_sha256)),
)


class Store(RuleBasedStateMachine):
    """A service with two owners of leases and runs with every kind of end."""

    def __init__(self, url: str = "") -> None:
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        path = Path(self.folder.name)
        self.database: Database = open_database(url or f"sqlite:///{path / 'x.sqlite3'}")
        self.traces = TraceFolder(path / "traces")
        self.owner = register(self.database)
        self.batches: list[str] = []
        self.running: list[str] = []
        self.broken: dict[str, tuple[str, ...]] = {}

    def teardown(self) -> None:
        self.database.close()
        self.folder.cleanup()

    @rule(
        agents=st.lists(st.sampled_from(AGENTS), min_size=1, max_size=5),
        town=st.sampled_from(TOWNS),
        where=st.sampled_from(("alone", "new", "old")),
        invalid=st.booleans(),
    )
    def submit(self, agents: list[str], town: str, where: str, invalid: bool) -> None:
        report = RunReport(
            run_id="",
            status=RunStatus.INVALID,
            failure=RunFailure(cause="invalid_document", message="no"),
        )
        with self.database.write() as transaction:
            batch_id = ""
            if where == "new" or (where == "old" and not self.batches):
                batch_id = transaction.batches.create(name="b", priority=Priority.CI).id
                self.batches.append(batch_id)
            elif where == "old":
                batch_id = self.batches[-1]
                if transaction.batches.get(batch_id).state is BatchState.CANCELLED:
                    return
            runs = [
                new_run(
                    str(number % 3),
                    agent=agent,
                    town=town,
                    report=report if invalid and number == 0 else None,
                )
                for number, agent in enumerate(agents)
            ]
            transaction.jobs.submit(runs, batch_id=batch_id)

    @rule(number=st.integers(1, 6))
    def claim(self, number: int) -> None:
        self.running += claim(self.database, self.owner, number)

    @precondition(lambda self: self.running)
    @rule(
        ends=st.lists(
            st.sampled_from(
                ("clean", "violated", "avoidable", "observed", "crash", "lost", "agent")
            )
        )
    )
    def finish(self, ends: list[str]) -> None:
        made = [self._end(run_id, end) for run_id, end in zip(self.running, ends, strict=False)]
        del self.running[: len(made)]
        finish(self.database, self.owner, *made)

    def _end(self, run_id: str, kind: str) -> AttemptEnd:
        match kind:
            case "clean":
                return finished(run_id)
            case "violated":
                self.broken[run_id] = ("collision",)
                return finished(run_id, "collision")
            case "avoidable":
                self.broken[run_id] = ORACLES
                return finished(run_id, *ORACLES, avoidable=Answer.NO)
            case "observed":
                self.broken[run_id] = ("red_light",)
                return finished(run_id, "red_light", severity=Severity.OBSERVATION)
            case "crash":
                return crashed(run_id)
            case "lost":
                return lost(run_id)
        failure = RunFailure(cause="agent_raised", message="no")
        return ended(RunReport(run_id=run_id, status=RunStatus.AGENT_FAILED, failure=failure))

    @rule()
    def release(self) -> None:
        with self.database.write() as transaction:
            transaction.queue.release(self.owner, self.running)
        self.running = []

    @rule()
    def reclaim(self) -> None:
        with self.database.write() as transaction:
            transaction.queue.reclaim(self.owner, POLICY)
        self.running = []

    @rule(place=st.integers(0, 30))
    def cancel(self, place: int) -> None:
        jobs = self._jobs()
        if jobs:
            with self.database.write() as transaction:
                transaction.jobs.cancel(jobs[place % len(jobs)].id)

    @precondition(lambda self: self.batches)
    @rule(place=st.integers(0, 5), what=st.sampled_from(("cancel", "pause", "resume")))
    def change_batch(self, place: int, what: str) -> None:
        batch_id = self.batches[place % len(self.batches)]
        with self.database.write() as transaction:
            batches = transaction.batches
            if what == "cancel":
                batches.cancel(batch_id)
            elif batches.get(batch_id).state is not BatchState.CANCELLED:
                (batches.pause if what == "pause" else batches.resume)(batch_id)

    @rule(place=st.integers(0, 30), text=st.sampled_from("01"))
    def put_again(self, place: int, text: str) -> None:
        """Submits the queued runs of a resumed campaign again."""
        jobs = [
            job
            for job in self._jobs()
            if job.status is not RunStatus.RUNNING
            and (job.status.is_final or job.scenario_sha256 != new_run(text).scenario_sha256)
        ]
        if jobs:
            job = jobs[place % len(jobs)]
            run = new_run(text, run_id=job.id, town=job.town, agent=job.agent)
            with self.database.write() as transaction:
                transaction.campaign_runs.put(job.batch_id, run)
                if transaction.jobs.get(job.id).status is RunStatus.QUEUED:
                    self.broken.pop(job.id, None)

    @rule()
    def leave_quarantine(self) -> None:
        with self.database.write() as transaction:
            for record in transaction.quarantine.newest():
                transaction.quarantine.release(record.scenario_sha256)
                break

    @rule(keep_violated=st.booleans())
    def prune(self, keep_violated: bool) -> None:
        soon = datetime.now(UTC) + timedelta(days=1)
        prune(self.database, self.traces, ended_before=soon, keep_violated=keep_violated)
        with self.database.read() as transaction:
            known = {batch.id for batch in transaction.batches.page(limit=500).items}
        self.batches = [batch for batch in self.batches if batch in known]

    @rule(
        wanted=filters,
        in_batch=st.booleans(),
        limit=st.integers(1, 4),
        newest_first=st.booleans(),
    )
    def list_jobs(self, wanted: JobFilter, in_batch: bool, limit: int, newest_first: bool) -> None:
        if in_batch and self.batches:
            fields = {name: getattr(wanted, name) for name in JobFilter.__slots__}
            wanted = JobFilter(**fields | {"batch_id": self.batches[-1]})
        jobs = self._jobs() if newest_first else self._jobs()[::-1]
        expected = [job.id for job in jobs if self._is_wanted(job, wanted)]
        listed: list[str] = []
        token = ""
        while True:
            with self.database.read() as transaction:
                page = transaction.jobs.page(
                    wanted, limit=limit, page_token=token, newest_first=newest_first
                )
            assert len(page.items) <= limit
            listed += [job.id for job in page.items]
            token = page.next_page_token
            if not token:
                break
        assert listed == expected

    def _is_wanted(self, job: RunSummary, wanted: JobFilter) -> bool:
        said = wanted.outcome is Outcome.VIOLATED and wanted.at_fault is not False
        broken = self.broken.get(job.id, ()) if job.status is RunStatus.FINISHED else ()
        return (
            wanted.batch_id in ("", job.batch_id)
            and (not wanted.statuses or job.status in wanted.statuses)
            and wanted.agent in ("", job.agent)
            and wanted.town in ("", job.town)
            and wanted.scenario_sha256 in ("", job.scenario_sha256)
            and wanted.accountability in (None, job.accountability)
            and (not wanted.oracle or (said and wanted.oracle in broken))
            and (
                wanted.at_fault is None
                or wanted.oracle != ""
                or (
                    job.accountability is not None
                    and bool(job.at_fault_violations) == wanted.at_fault
                )
            )
            and (
                wanted.violated is None
                or (job.violations is not None and (job.violations > 0) == wanted.violated)
            )
        )

    def _jobs(self) -> list[RunSummary]:
        with self.database.read() as transaction:
            return list(transaction.jobs.page(limit=10_000).items)

    @invariant()
    def counters_equal_a_recount(self) -> None:
        jobs = self._jobs()
        with self.database.read() as transaction:
            counts = transaction.jobs.counts()
            queued = transaction.jobs.count_queued_runs()
            batches = transaction.batches.page(limit=500).items
        recount = Counter(job.status for job in jobs)
        assert counts == {status: recount[status] for status in RunStatus}
        assert queued == recount[RunStatus.QUEUED]
        for batch in batches:
            own = [job for job in jobs if job.batch_id == batch.id]
            assert batch.size == len(own)
            assert batch.counts == Counter(job.status for job in own)
            assert batch.violated_runs == sum(bool(job.violations) for job in own)

    @invariant()
    def nothing_contradicts(self) -> None:
        assert list(verify(self.database, self.traces)) == []


TestStore = Store.TestCase
TestStore.settings = settings(
    max_examples=15,
    stateful_step_count=25,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)


@pytest.mark.slow
def test_the_same_on_postgresql(postgresql: PostgresqlServer) -> None:
    class OnPostgresql(Store):
        def __init__(self) -> None:
            super().__init__(postgresql.create())

    run_state_machine_as_test(OnPostgresql, settings=settings(TestStore.settings, max_examples=6))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE facets SET runs = runs + 1", "the counter says 4 runs; there are 3"),
        ("UPDATE batch_facets SET runs = 7", "the batch says 7 queued runs"),
        ("DELETE FROM batch_facets", "the batch says 0 queued runs"),
        ("UPDATE runs SET status = 'running' WHERE seq = 1", "that it does not have"),
    ],
)
def test_wrong_counters_are_named(
    database: Database, tmp_path: Path, change: str, message: str
) -> None:
    with database.write() as transaction:
        transaction.jobs.submit([new_run(str(number)) for number in range(3)])
    traces = TraceFolder(tmp_path / "traces")
    assert list(verify(database, traces)) == []
    with database.engine.begin() as connection:
        connection.execute(text(change))
    found = [f for f in verify(database, traces) if f.kind in ("wrong_count", "wrong_facet")]
    assert any(message in finding.message for finding in found)
