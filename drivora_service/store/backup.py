"""A consistent copy of the database and the traces, while the server goes on."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.store.database import Database
from drivora_service.store.traces import TraceFolder

DATABASE_NAME = "drivora.sqlite3"


@dataclass(frozen=True, slots=True, kw_only=True)
class Backup:
    """What a backup holds.

    Attributes:
        missing_traces: Ids of runs whose trace should have been there.
    """

    runs: int
    traces: int
    missing_traces: tuple[str, ...]


def back_up(database: Database, traces: TraceFolder, target: Path) -> Backup:
    """Copies the database, then the traces of the runs that have ended in that copy.

    A trace is complete before its run ends and does not change afterwards, so the two agree.
    ``target`` then holds ``drivora.sqlite3`` and ``traces`` and can be used as a data folder.

    Raises:
        StoreError: The target exists and is not empty, cannot be written, or the database is not
            SQLite's, which has tools of its own.
    """
    if database.engine.dialect.name != "sqlite" or database.engine.url.database is None:
        raise StoreError("only SQLite databases are backed up here; use your database's own tool")
    if target.exists() and any(target.iterdir()):
        raise StoreError(f"{target} is not empty; a backup needs a folder of its own")
    try:
        target.mkdir(parents=True, exist_ok=True)
        copy = target / DATABASE_NAME
        with (
            closing(sqlite3.connect(database.engine.url.database)) as source,
            closing(sqlite3.connect(copy)) as destination,
        ):
            source.backup(destination, pages=2048, sleep=0.01)
            runs = destination.execute("SELECT count(*) FROM runs").fetchone()[0]
            traced = destination.execute(
                "SELECT id FROM runs WHERE trace_sha256 != '' ORDER BY seq"
            ).fetchall()
        copied, missing = 0, []
        into = TraceFolder(target / "traces")
        for (run_id,) in traced:
            try:
                shutil.copyfile(traces.path(run_id), into.prepare(run_id))
                copied += 1
            except FileNotFoundError:
                missing.append(run_id)
    except (OSError, sqlite3.Error) as error:
        raise StoreError(f"the backup to {target} failed: {error}") from error
    return Backup(runs=runs, traces=copied, missing_traces=tuple(missing))
