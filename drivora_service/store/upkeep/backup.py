"""A consistent copy of the database and the traces of a running server."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_folders import (
    CampaignTraces,
    FailureTraces,
    RunTraces,
    TraceFolder,
)

DATABASE_NAME = "drivora.sqlite3"


@dataclass(frozen=True, slots=True, kw_only=True)
class Backup:
    """The contents of a backup.

    Attributes:
        missing_traces: Ids of runs whose trace should have been there; of failures, the campaign's
            id and the file's name.
    """

    runs: int
    traces: int
    missing_traces: tuple[str, ...]


def back_up(
    database: Database,
    traces: RunTraces,
    target: Path,
    *,
    campaign_traces: FailureTraces | None = None,
) -> Backup:
    """Copies the database, then the traces of the runs that have ended in that copy.

    Copies the traces of campaigns' failures, too, if their folder is given.

    A trace is complete before its run ends and does not change afterwards, so the two agree.
    ``target`` then holds ``drivora.sqlite3``, ``traces`` and ``campaigns`` and can be used as a
    data folder.

    Raises:
        StoreError: The target exists and is not empty, cannot be written, or the database is not
            SQLite's, which has tools of its own.
    """
    if database.engine.dialect.name != "sqlite" or database.engine.url.database is None:
        raise StoreError(
            "only SQLite databases are backed up here; back up PostgreSQL with pg_dump, and copy "
            "the folders traces and campaigns after it"
        )
    if target.exists() and any(target.iterdir()):
        raise StoreError(f"{target} is not empty; a backup needs a folder of its own")
    try:
        target.mkdir(parents=True, exist_ok=True)
        copy = target / DATABASE_NAME
        with (
            closing(sqlite3.connect(database.engine.url.database)) as source,
            closing(sqlite3.connect(copy)) as destination,
        ):
            # One view for the whole copy: else every write of a server restarts it.
            source.execute("BEGIN").close()
            source.execute("SELECT count(*) FROM alembic_version").fetchone()
            source.backup(destination, pages=2048, sleep=0.01)
            source.rollback()
            runs = destination.execute("SELECT count(*) FROM runs").fetchone()[0]
            traced = destination.execute(
                "SELECT id, attempts FROM runs WHERE trace_sha256 != '' ORDER BY seq"
            ).fetchall()
            failures = destination.execute(
                "SELECT DISTINCT campaigns.id, failures.trace FROM failures "
                "JOIN campaigns ON campaigns.seq = failures.campaign_seq "
                "WHERE failures.trace != '' ORDER BY 1, 2"
            ).fetchall()
        copied, missing = 0, []
        into = TraceFolder(target / "traces")
        into_campaigns = CampaignTraces(target / "campaigns")
        copies = [
            *(
                (run_id, traces.path(run_id, attempt), into.path(run_id))
                for run_id, attempt in traced
            ),
            *(
                (
                    f"{campaign_id}/{name}",
                    campaign_traces.path(campaign_id, name),
                    into_campaigns.path(campaign_id, name),
                )
                for campaign_id, name in failures
                if campaign_traces is not None
            ),
        ]
        for subject, path, copy_path in copies:
            copy_path.parent.mkdir(parents=True, exist_ok=True)
            try:
                shutil.copyfile(path, copy_path)
                copied += 1
            except (FileNotFoundError, IsADirectoryError, shutil.SpecialFileError):
                missing.append(subject)
    except (OSError, sqlite3.Error) as error:
        raise StoreError(f"the backup to {target} failed: {error}") from error
    return Backup(runs=runs, traces=copied, missing_traces=tuple(missing))
