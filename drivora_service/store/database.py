"""The database: opening it, and transactions with one commit point."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.orm import Session, sessionmaker

from drivora_service.errors import StoreError, StoreUnavailable
from drivora_service.store.batches import BatchRepository
from drivora_service.store.campaign_rows import CampaignRowRepository
from drivora_service.store.campaign_runs import CampaignRunRepository
from drivora_service.store.campaign_views import CampaignViewRepository
from drivora_service.store.campaigns import CampaignRepository
from drivora_service.store.change_lists import ChangeRepository
from drivora_service.store.changes import ChangeCounter
from drivora_service.store.evaluations import EvaluationRepository
from drivora_service.store.facets import count_changes
from drivora_service.store.figures import FigureRepository
from drivora_service.store.found_lists import FoundRepository
from drivora_service.store.group_decisions import DecisionRepository
from drivora_service.store.group_lists import GroupRepository
from drivora_service.store.idempotency import IdempotencyRepository
from drivora_service.store.jobs import JobRepository
from drivora_service.store.migration import migrate
from drivora_service.store.minimizations import MinimizationRepository
from drivora_service.store.network_use import NetworkUse, network_use
from drivora_service.store.quarantine import QuarantineRepository
from drivora_service.store.queue import QueueRepository
from drivora_service.store.results import ResultRepository
from drivora_service.store.revisions import lock_count, revise
from drivora_service.store.studies import StudyRepository
from drivora_service.store.suite_runs import SuiteRunRepository
from drivora_service.store.workers import WorkerRepository

PATIENCE_S = 30.0
"""Default of the seconds to wait for other writers."""

_POLL_S, _STUCK_S, _MOST_WAITING = 0.25, 1.0, 6
"""Seconds after which a thread that waits to write checks whether the current write takes too long;
then only this many threads wait for its end, and the others are left for reading."""


@dataclass(frozen=True, slots=True)
class Transaction:
    """All repositories within one transaction."""

    session: Session

    @property
    def jobs(self) -> JobRepository:
        """Jobs and their runs."""
        return JobRepository(self.session)

    @property
    def results(self) -> ResultRepository:
        """The results of many runs."""
        return ResultRepository(self.session)

    @property
    def batches(self) -> BatchRepository:
        """Batches."""
        return BatchRepository(self.session)

    @property
    def campaigns(self) -> CampaignRepository:
        """Campaigns."""
        return CampaignRepository(self.session)

    @property
    def studies(self) -> StudyRepository:
        """Studies."""
        return StudyRepository(self.session)

    @property
    def evaluations(self) -> EvaluationRepository:
        """Evaluations of campaigns."""
        return EvaluationRepository(self.session)

    @property
    def campaign_runs(self) -> CampaignRunRepository:
        """The runs of campaigns."""
        return CampaignRunRepository(self.session)

    @property
    def campaign_views(self) -> CampaignViewRepository:
        """Campaigns for lists."""
        return CampaignViewRepository(self.session)

    @property
    def minimizations(self) -> MinimizationRepository:
        """Minimisations."""
        return MinimizationRepository(self.session)

    @property
    def suite_runs(self) -> SuiteRunRepository:
        """Suites that were run, with the decisions of their gates."""
        return SuiteRunRepository(self.session)

    def network_use(self, name: str) -> NetworkUse:
        """Counts the unfinished work on a road network."""
        return network_use(self.session, name)

    @property
    def changes(self) -> ChangeRepository:
        """The changes of runs, batches, campaigns, studies and minimisations."""
        return ChangeRepository(self.session)

    @property
    def campaign_rows(self) -> CampaignRowRepository:
        """Campaigns for tables."""
        return CampaignRowRepository(self.session)

    @property
    def found(self) -> FoundRepository:
        """The failures of all campaigns and batches."""
        return FoundRepository(self.session)

    @property
    def groups(self) -> GroupRepository:
        """Groups of these failures."""
        return GroupRepository(self.session)

    @property
    def decisions(self) -> DecisionRepository:
        """What people decide about groups of failures."""
        return DecisionRepository(self.session)

    @property
    def queue(self) -> QueueRepository:
        """The queue of runs."""
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
    def figures(self) -> FigureRepository:
        """Counts and sizes of the whole store."""
        return FigureRepository(self.session)

    @property
    def workers(self) -> WorkerRepository:
        """Server processes and their slots."""
        return WorkerRepository(self.session)


class Database:
    """A migrated database. Thread-safe; one transaction a thread.

    Attributes:
        changes: Counter that changes with every commit.
    """

    def __init__(self, engine: Engine, *, patience_s: float = PATIENCE_S) -> None:
        self.engine = engine
        self.changes = ChangeCounter(engine)
        # SQLite has one writer. Waiting for this lock is fair and prompt, while SQLite's own
        # waiting sleeps and tries again.
        self._writing = threading.Lock() if engine.dialect.name == "sqlite" else None
        self._patience_s = patience_s
        self._counting = threading.Lock()
        self._waiting = 0
        self._writing_since = 0.0
        self._readers = sessionmaker(engine, expire_on_commit=False)
        self._writers = sessionmaker(
            engine.execution_options(drivora_writes=True), expire_on_commit=False
        )
        event.listen(self._writers, "before_flush", count_changes)
        event.listen(self._writers, "before_flush", revise)

    @contextmanager
    def read(self) -> Iterator[Transaction]:
        """Opens a read-only transaction with a consistent view.

        Raises:
            StoreError: The database cannot be used.
        """
        with _store_errors(), self._readers() as session:
            yield Transaction(session)

    @contextmanager
    def write(self) -> Iterator[Transaction]:
        """Opens a transaction that is committed at the end, or rolled back.

        Raises:
            StoreUnavailable: Another writer is not done in time, or the disk is full or gone.
            StoreError: The database cannot be used.
        """
        with (
            self._turn_to_write(),
            _store_errors(),
            self._writers() as session,
            session.begin(),
        ):
            if self._writing is None:
                lock_count(session)
            yield Transaction(session)

    def probe(self) -> None:
        """Makes a write that changes nothing.

        Raises:
            StoreUnavailable: Nothing can be written now.
            StoreError: The database cannot be used.
        """
        with self.write() as transaction:
            transaction.session.execute(
                text("UPDATE alembic_version SET version_num = version_num")
            )

    @contextmanager
    def _turn_to_write(self) -> Iterator[None]:
        """Waits for the other writing threads, for a limited time.

        Else every thread of the service could end up waiting here while another process has locked
        the database, and none would be left for reading.
        """
        if self._writing is None:
            yield
            return
        if not self._acquired(self._writing):
            raise StoreUnavailable("the database is busy with other writes; try again")
        self._writing_since = time.monotonic()
        try:
            yield
        finally:
            self._writing.release()

    def _acquired(self, writing: threading.Lock) -> bool:
        """Waits for the lock; gives up early if many threads wait for a stuck writer."""
        until = time.monotonic() + self._patience_s
        with self._counting:
            self._waiting += 1
        try:
            while (left := until - time.monotonic()) > 0:
                if writing.acquire(timeout=min(left, _POLL_S)):
                    return True
                stuck = time.monotonic() - self._writing_since > _STUCK_S
                if stuck and self._waiting > _MOST_WAITING:
                    return False
            return False
        finally:
            with self._counting:
                self._waiting -= 1

    def close(self) -> None:
        """Closes every connection."""
        self.changes.close()
        self.engine.dispose()


def database_file(url: str) -> Path | None:
    """Returns the file of a database; ``None`` if it is none of SQLite.

    Raises:
        StoreError: The address cannot be used.
    """
    parsed = _parsed(url)
    return Path(parsed.database or "") if parsed.get_backend_name() == "sqlite" else None


def open_database(
    url: str,
    *,
    patience_s: float = PATIENCE_S,
    before_migration: Callable[[], None] = lambda: None,
) -> Database:
    """Opens a database, makes it if it does not exist, and migrates it to this version.

    Args:
        url: SQLAlchemy address, such as ``sqlite:////var/lib/drivora/drivora.sqlite3``.
        patience_s: Seconds to wait for other writing threads, and as long again for other
            processes.
        before_migration: Called before a database of an older version is migrated; raises to
            prevent that.

    Raises:
        StoreError: It cannot be opened, or was written by a newer version.
    """
    parsed = _parsed(url)
    file = database_file(url)
    if file is not None:
        make_data_folder(file.parent)
    with _store_errors():
        engine = create_engine(parsed, pool_size=16, max_overflow=48)
        if engine.dialect.name == "sqlite":
            event.listen(engine, "connect", partial(_configure_sqlite, patience_s))
            event.listen(engine, "begin", _begin_sqlite)
        try:
            migrate(engine, before_migration=before_migration)
        except BaseException:
            engine.dispose()
            raise
    return Database(engine, patience_s=patience_s)


def make_data_folder(folder: Path) -> None:
    """Makes a folder for data, for its owner only; an existing one stays as it is.

    Raises:
        StoreError: It cannot be made.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"the data folder {folder} cannot be made: {error.strerror}; choose another with "
            "--data-dir or DRIVORA_DATA_DIR"
        ) from error


def _parsed(url: str) -> URL:
    try:
        parsed = make_url(url)
    except ArgumentError as error:
        raise StoreError(f"{url!r} is no database address: {error}") from error
    if parsed.get_backend_name() == "sqlite" and parsed.database in (None, "", ":memory:"):
        raise StoreError("a database in memory cannot be shared by threads; give a file")
    return parsed


def _configure_sqlite(patience_s: float, connection: sqlite3.Connection, _record: object) -> None:
    # sqlite3 itself would begin transactions too late for consistent reads.
    connection.isolation_level = None
    cursor = connection.cursor()
    try:
        # Before the first write, else only a rewritten file could shrink; later it is a write, for
        # which a reader must not wait.
        if cursor.execute("PRAGMA page_count").fetchone() == (0,):
            cursor.execute("PRAGMA auto_vacuum = INCREMENTAL")
        cursor.execute("PRAGMA journal_mode = WAL")
        # FULL: what was answered with 202 also survives a loss of power.
        cursor.execute("PRAGMA synchronous = FULL")
        cursor.execute("PRAGMA foreign_keys = ON")
        cursor.execute(f"PRAGMA busy_timeout = {round(1000 * patience_s)}")
        cursor.execute("PRAGMA cache_size = -65536")
    except sqlite3.Error:
        # The pool does not own the connection yet, so nothing else would close it.
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
        if _passes(error):
            raise StoreUnavailable(f"the database cannot be used now: {_reason(error)}") from error
        raise StoreError(f"the database cannot be used: {error}") from error


def _passes(error: SQLAlchemyError) -> bool:
    """Returns whether an error is due to the storage or to concurrent users of the database."""
    if not isinstance(error, OperationalError):
        return isinstance(error, PoolTimeoutError)
    # SQLite reports a wrong statement by the same class, as plain SQLITE_ERROR.
    return getattr(error.orig, "sqlite_errorname", "") != "SQLITE_ERROR"


def _reason(error: SQLAlchemyError) -> str:
    """Returns the driver's message, without the statement and its values."""
    return str(error.orig) if isinstance(error, OperationalError) else str(error)
