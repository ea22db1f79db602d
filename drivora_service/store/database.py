"""The database: opening it, and transactions with one commit point."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, SQLAlchemyError
from sqlalchemy.orm import Session, sessionmaker

from drivora_service.errors import StoreError
from drivora_service.store.batches import BatchRepository
from drivora_service.store.campaign_runs import CampaignRunRepository
from drivora_service.store.campaign_views import CampaignViewRepository
from drivora_service.store.campaigns import CampaignRepository
from drivora_service.store.evaluations import EvaluationRepository
from drivora_service.store.facets import count_changes
from drivora_service.store.idempotency import IdempotencyRepository
from drivora_service.store.jobs import JobRepository
from drivora_service.store.migration import migrate
from drivora_service.store.quarantine import QuarantineRepository
from drivora_service.store.queue import QueueRepository
from drivora_service.store.workers import WorkerRepository

_BUSY_TIMEOUT_MS = 30_000


@dataclass(frozen=True, slots=True)
class Transaction:
    """All repositories within one transaction."""

    session: Session

    @property
    def jobs(self) -> JobRepository:
        """Jobs and their runs."""
        return JobRepository(self.session)

    @property
    def batches(self) -> BatchRepository:
        """Batches."""
        return BatchRepository(self.session)

    @property
    def campaigns(self) -> CampaignRepository:
        """Campaigns."""
        return CampaignRepository(self.session)

    @property
    def evaluations(self) -> EvaluationRepository:
        """What campaigns have evaluated."""
        return EvaluationRepository(self.session)

    @property
    def campaign_runs(self) -> CampaignRunRepository:
        """The runs of campaigns."""
        return CampaignRunRepository(self.session)

    @property
    def campaign_views(self) -> CampaignViewRepository:
        """Campaigns as lists show them."""
        return CampaignViewRepository(self.session)

    @property
    def queue(self) -> QueueRepository:
        """Handing out runs and taking their ends."""
        return QueueRepository(self.session)

    @property
    def quarantine(self) -> QuarantineRepository:
        """Scenarios that crash the simulator."""
        return QuarantineRepository(self.session)

    @property
    def idempotency(self) -> IdempotencyRepository:
        """Requests that must not be done twice."""
        return IdempotencyRepository(self.session)

    @property
    def workers(self) -> WorkerRepository:
        """Server processes and their slots."""
        return WorkerRepository(self.session)


class Database:
    """A migrated database. Safe to share between threads; one transaction a thread."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        # SQLite has one writer. Waiting for a lock of ours is fair and prompt, where SQLite's own
        # waiting sleeps and tries again.
        self._writing: AbstractContextManager[Any] = (
            threading.Lock() if engine.dialect.name == "sqlite" else nullcontext()
        )
        self._readers = sessionmaker(engine, expire_on_commit=False)
        self._writers = sessionmaker(
            engine.execution_options(drivora_writes=True), expire_on_commit=False
        )
        event.listen(self._writers, "before_flush", count_changes)

    @contextmanager
    def read(self) -> Iterator[Transaction]:
        """A consistent view; nothing is written.

        Raises:
            StoreError: The database cannot be used.
        """
        with _store_errors(), self._readers() as session:
            yield Transaction(session)

    @contextmanager
    def write(self) -> Iterator[Transaction]:
        """Reads and writes that are committed together at the end, or not at all.

        Raises:
            StoreError: The database cannot be used.
        """
        with _store_errors(), self._writing, self._writers() as session, session.begin():
            yield Transaction(session)

    def close(self) -> None:
        """Closes every connection."""
        self.engine.dispose()


def open_database(url: str) -> Database:
    """Opens a database, makes it if it does not exist, and migrates it to this version.

    Args:
        url: SQLAlchemy address, such as ``sqlite:////var/lib/drivora/drivora.sqlite3``.

    Raises:
        StoreError: It cannot be opened, or was written by a newer version.
    """
    try:
        parsed = make_url(url)
    except ArgumentError as error:
        raise StoreError(f"{url!r} is no database address: {error}") from error
    if parsed.get_backend_name() == "sqlite":
        if not parsed.database or parsed.database == ":memory:":
            raise StoreError("a database in memory cannot be shared by threads; give a file")
        Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
    with _store_errors():
        engine = create_engine(parsed, pool_size=16, max_overflow=48)
        if engine.dialect.name == "sqlite":
            event.listen(engine, "connect", _configure_sqlite)
            event.listen(engine, "begin", _begin_sqlite)
        try:
            migrate(engine)
        except BaseException:
            engine.dispose()
            raise
    return Database(engine)


def _configure_sqlite(connection: sqlite3.Connection, _record: object) -> None:
    # sqlite3 would begin transactions by itself, and too late for consistent reads.
    connection.isolation_level = None
    cursor = connection.cursor()
    try:
        cursor.execute("PRAGMA journal_mode = WAL")
        # FULL: what was answered with 202 also survives a loss of power.
        cursor.execute("PRAGMA synchronous = FULL")
        cursor.execute("PRAGMA foreign_keys = ON")
        cursor.execute(f"PRAGMA busy_timeout = {_BUSY_TIMEOUT_MS}")
        cursor.execute("PRAGMA cache_size = -65536")
    except sqlite3.Error:
        # The pool has not taken it yet, so that nothing else would close it.
        connection.close()
        raise
    cursor.close()


def _begin_sqlite(connection: Connection) -> None:
    # A transaction that reads first and writes later would fail if another wrote in between.
    writes = connection.get_execution_options().get("drivora_writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


@contextmanager
def _store_errors() -> Iterator[None]:
    try:
        yield
    except SQLAlchemyError as error:
        raise StoreError(f"the database cannot be used: {error}") from error
