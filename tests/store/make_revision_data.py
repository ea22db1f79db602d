"""Makes the data of a revision of the schema: runs of every end, batches of every state, campaigns.

It uses only what every version has had, and is run with the code of the version that wrote the
revision, which need not be this one:

    python tests/store/make_revision_data.py tests/store/data/revision_NNNN.sql
"""

from __future__ import annotations

import importlib.util
import sqlite3
import sys
import tempfile
from contextlib import closing
from pathlib import Path

from drivora_service.store.database import Database, open_database
from drivora_service.store.runs.run_records import Priority
from tests.store.samples import claim, crashed, finish, finished, lost, new_run, register, submit


def fill(database: Database) -> None:
    """Writes what a service would have written in a busy minute."""
    owner, gone = register(database), register(database)
    singles = submit(database, 3)
    runs = submit(database, 9, priority=Priority.CI)
    with database.write() as transaction:
        paused = transaction.batches.create(name="paused", priority=Priority.CAMPAIGN).id
        cancelled = transaction.batches.create(name="cancelled", priority=Priority.CAMPAIGN).id
        for batch_id in (paused, cancelled):
            transaction.jobs.submit(
                [new_run("{0}"), new_run("grid", town="grid", agent="krauss")], batch_id=batch_id
            )
        transaction.batches.pause(paused)
        transaction.batches.cancel(cancelled)
    claim(database, owner, 3)
    finish(database, owner, finished(singles[0], trace="1" * 64), finished(singles[1], "collision"))
    for _ in range(2):
        # A crash that comes again is quarantined.
        claim(database, owner, 9)
        finish(database, owner, crashed(runs[0]))
    finish(database, owner, finished(runs[1], "collision", "red_light"), lost(runs[2]))
    finish(database, owner, *(finished(run_id) for run_id in runs[3:7]))
    with database.write() as transaction:
        transaction.jobs.submit([new_run("{0}")])
        transaction.jobs.cancel(runs[7])
        transaction.workers.leave(gone)
        transaction.idempotency.reserve("key", "f" * 64)
        transaction.idempotency.complete("key", singles[0])
    claim(database, owner, 2)
    if (
        importlib.util.find_spec("drivora_service.store.campaigns.evaluation_repository")
        is not None
    ):
        _fill_campaigns(database)


def _fill_campaigns(database: Database) -> None:
    from drivora_service.search.tester import EvaluationStatus
    from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
    from tests.store.campaigns.test_campaign_repository import append, create, evaluation

    campaign_id, _ = create(database), create(database, "waiting")
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
    append(
        database,
        campaign_id,
        evaluation(0, violated=(True, None)),
        evaluation(1, status=EvaluationStatus.INVALID),
        evaluation(2, status=EvaluationStatus.FAILED),
        evaluation(3, parents=(0,), violated=(False,)),
        evaluation(4, parents=(0,), violated=(True,)),
        evaluation(5, parents=(0, 3)),
    )
    with database.write() as transaction:
        transaction.evaluations.confirm(
            campaign_id, 0, Confirmation.CONFIRMED, trace="000000.trace.parquet"
        )
        transaction.evaluations.confirm(campaign_id, 3, Confirmation.FLAKY, trace="")
        transaction.evaluations.group(campaign_id, {(0, 0): 0, (0, 1): 1, (4, 0): 0})
        transaction.campaigns.end(campaign_id, CampaignState.FINISHED, active_s=2.0)


def main() -> None:
    """Writes the database that this version makes as text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drivora.sqlite3"
        database = open_database(f"sqlite:///{path}")
        fill(database)
        database.close()
        with closing(sqlite3.connect(path)) as connection:
            Path(sys.argv[1]).write_text("\n".join(connection.iterdump()) + "\n")


if __name__ == "__main__":
    main()
