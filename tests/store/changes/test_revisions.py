"""Databases of every revision of the schema, made by the code of that revision, can be read."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import open_database
from drivora_service.store.migration import newest_revision, revisions, schema_version
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify

DATA = Path(__file__).parents[1] / "data"


def test_every_revision_has_data_made_by_it() -> None:
    """``make_revision_data.py`` makes them; commit the file together with the revision."""
    wanted = {f"revision_{revision}.sql" for revision in revisions()}
    assert wanted == {path.name for path in DATA.glob("revision_*.sql")}
    for revision in revisions():
        dump = (DATA / f"revision_{revision}.sql").read_text()
        assert f"""INSERT INTO "alembic_version" VALUES('{revision}');""" in dump


@pytest.mark.parametrize("revision", revisions())
def test_a_database_of_a_revision_is_migrated_and_read(tmp_path: Path, revision: str) -> None:
    path = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / f"revision_{revision}.sql").read_text())
    traces = TraceFolder(tmp_path / "traces")
    database = open_database(f"sqlite:///{path}")
    assert schema_version(database.engine) == newest_revision() == revisions()[-1]
    with database.read() as transaction:
        jobs = transaction.jobs.page(limit=100).items
        for job in jobs:
            report = transaction.jobs.report(job.id)
            assert (report is not None) == job.status.is_final
            assert transaction.jobs.document(job.id)
            assert len(transaction.jobs.attempts(job.id)) == job.attempts
        counts = transaction.jobs.counts()
        broken = transaction.jobs.page(JobFilter(oracle="collision")).items
        violated = transaction.jobs.page(JobFilter(violated=True, agent="idm")).items
        elsewhere = transaction.jobs.page(JobFilter(town="grid")).items
        batches = transaction.batches.page().items
        quarantined = transaction.quarantine.newest()
        campaigns = transaction.campaigns.page().items
        for campaign in campaigns:
            summaries = transaction.campaign_views.evaluations(campaign.id).items
            assert len(summaries) == campaign.counts.evaluations
            assert len(transaction.evaluations.page(campaign.id)) == len(summaries)
            failures = transaction.campaign_views.failures(campaign.id).items
            assert len(failures) == len(transaction.evaluations.failures(campaign.id))
            kinds = transaction.campaign_views.kinds(campaign.id)
            assert sum(kind.violations for kind in kinds) == len(failures)
    assert counts[RunStatus.FINISHED] == len([j for j in jobs if j.status is RunStatus.FINISHED])
    assert {job.id for job in broken} == {job.id for job in violated} != set()
    assert len(elsewhere) == 2
    assert sum(batch.size for batch in batches) + 4 == len(jobs) == 17
    assert len(quarantined) == 1
    assert len(campaigns) == (0 if revision == "0001" else 2)
    for job in jobs:
        if job.trace_sha256:
            Path(traces.prepare(job.id)).write_bytes(b"")
    assert list(verify(database, traces)) == []
    database.close()
