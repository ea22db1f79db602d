"""The database: opening it, and transactions with one commit point."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import Engine, event, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError
from sqlalchemy.orm import Session, sessionmaker

from drivora_service.errors import StoreDamaged, StoreError, StoreUnavailable
from drivora_service.store.campaigns.campaign_repository import CampaignRepository
from drivora_service.store.campaigns.campaign_rows import CampaignRowRepository
from drivora_service.store.campaigns.campaign_runs import CampaignRunRepository
from drivora_service.store.campaigns.campaign_views import CampaignViewRepository
from drivora_service.store.campaigns.evaluation_repository import EvaluationRepository
from drivora_service.store.campaigns.study_repository import StudyRepository
from drivora_service.store.changes.change_counter import ChangeCounter
from drivora_service.store.changes.change_lists import ChangeRepository
from drivora_service.store.changes.revisions import revise
from drivora_service.store.engine.checkpoints import CHECKPOINT_S, Checkpoints
from drivora_service.store.engine.damage_latch import DamageLatch
from drivora_service.store.engine.file_watch import FileWatch
from drivora_service.store.engine.foreign_databases import refuse_foreign_database
from drivora_service.store.engine.postgresql import lock_writing, postgresql_engine, reading_options
from drivora_service.store.engine.sqlite import sqlite_engine
from drivora_service.store.engine.storage_faults import CHOOSE
from drivora_service.store.engine.store_errors import store_errors
from drivora_service.store.failures.failure_lists import FoundRepository
from drivora_service.store.failures.group_decisions import DecisionRepository
from drivora_service.store.failures.group_lists import GroupRepository
from drivora_service.store.locks.file_work_locks import FileWorkLocks
from drivora_service.store.locks.postgresql_work_locks import PostgresqlWorkLocks
from drivora_service.store.locks.work_locks import WorkLocks, refuse_while_used
from drivora_service.store.migration import migrate
from drivora_service.store.minimizations.minimization_repository import MinimizationRepository
from drivora_service.store.queue.idempotent_requests import IdempotencyRepository
from drivora_service.store.queue.quarantine import QuarantineRepository
from drivora_service.store.queue.run_queue import QueueRepository
from drivora_service.store.queue.worker_repository import WorkerRepository
from drivora_service.store.runs.batch_repository import BatchRepository
from drivora_service.store.runs.facets import count_changes
from drivora_service.store.runs.job_repository import JobRepository
from drivora_service.store.runs.run_results import ResultRepository
from drivora_service.store.suites.suite_runs import SuiteRunRepository
from drivora_service.store.upkeep.network_use import NetworkUse, network_use
from drivora_service.store.upkeep.store_figures import FigureRepository

PATIENCE_S = 30.0
"""Default of the seconds to wait for other writers."""

_ADDRESSES = "use sqlite:///FILE or postgresql+psycopg://USER:PASSWORD@HOST:PORT/DATABASE"

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
        damage: What is known to be damaged; nothing is written from then on.
        file: File of an SQLite database; ``None``: it is none.
        locks: Locks on pieces of long work.
    """

    def __init__(
        self,
        engine: Engine,
        *,
        patience_s: float = PATIENCE_S,
        checkpoint_s: float = CHECKPOINT_S,
    ) -> None:
        self.engine = engine
        self.damage = DamageLatch()
        self._checkpoints = Checkpoints(engine, every_s=checkpoint_s)
        self.file = _file_of(engine)
        self._watch = None if self.file is None else FileWatch(self.file)
        self.changes = ChangeCounter(engine)
        self._is_postgresql = engine.dialect.name == "postgresql"
        self.locks = _work_locks(engine)
        # A database has one writer. Waiting for this lock is fair and prompt, while SQLite's own
        # waiting sleeps and tries again, and PostgreSQL's takes a connection.
        self._writing = threading.Lock()
        self._patience_s = patience_s
        self._counting = threading.Lock()
        self._waiting = 0
        self._writing_since = 0.0
        reading = reading_options() if self._is_postgresql else {}
        self._readers = sessionmaker(engine.execution_options(**reading), expire_on_commit=False)
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
        with store_errors(self.file, self.damage), self._readers() as session:
            yield Transaction(session)

    @contextmanager
    def write(self) -> Iterator[Transaction]:
        """Opens a transaction that is committed at the end, or rolled back.

        Raises:
            StoreDamaged: The database is damaged.
            StoreUnavailable: Another writer is not done in time, or the disk is full or gone.
            StoreError: The database cannot be used.
        """
        self.damage.refuse()
        self._check_file()
        with (
            self._turn_to_write(),
            store_errors(self.file, self.damage),
            self._writers() as session,
            session.begin(),
        ):
            if self._is_postgresql:
                lock_writing(session)
            yield Transaction(session)
        self._checkpoints.make_if_due()

    def checkpoint(self) -> None:
        """Moves all commits from the write-ahead log into the file of the database.

        For moments without other transactions, for whose end it would wait.
        """
        self._checkpoints.make(truncates=True)

    def probe(self) -> None:
        """Commits a write that changes nothing; a storage without a fault allows it.

        Raises:
            StoreDamaged: The database is damaged, or its files were moved or removed.
            StoreUnavailable: Nothing can be written now.
            StoreError: The database cannot be used.
        """
        with self.write() as transaction:
            transaction.session.execute(
                text("UPDATE alembic_version SET version_num = version_num")
            )
            # A file system without shared memory has no such log: SQLite then does without one.
            if self._watch is not None and _has_log(transaction.session):
                lost = self._watch.describe_lost_log()
                if lost:
                    self.damage.note(lost)
        self.damage.refuse()

    def _check_file(self) -> None:
        """Refuses to write if the file is no longer at its path; another one there is a damage."""
        if self._watch is None:
            return
        try:
            self._watch.check()
        except StoreDamaged as error:
            self.damage.note(str(error))
            raise

    @contextmanager
    def _turn_to_write(self) -> Iterator[None]:
        """Waits for the other writing threads, for a limited time.

        Else every thread of the service could end up waiting here while another process has locked
        the database, and none would be left for reading.
        """
        if not self._acquire():
            raise StoreUnavailable("the database is busy with other writes; try again")
        self._writing_since = time.monotonic()
        try:
            yield
        finally:
            self._writing.release()

    def _acquire(self) -> bool:
        """Waits for the lock; gives up early if many threads wait for a stuck writer."""
        until = time.monotonic() + self._patience_s
        with self._counting:
            self._waiting += 1
        try:
            while (left := until - time.monotonic()) > 0:
                if self._writing.acquire(timeout=min(left, _POLL_S)):
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
        self.locks.close()
        self.engine.dispose()


def _has_log(session: Session) -> bool:
    """Returns whether a database of SQLite has a write-ahead log."""
    return bool(session.scalar(text("PRAGMA journal_mode")) == "wal")


def _work_locks(engine: Engine) -> WorkLocks:
    if engine.dialect.name == "postgresql":
        return PostgresqlWorkLocks(engine)
    return FileWorkLocks(Path(engine.url.database or "").parent / "locks")


def _file_of(engine: Engine) -> Path | None:
    """Returns the file of an engine's database; ``None`` if it is none of SQLite."""
    is_sqlite = engine.dialect.name == "sqlite"
    return Path(engine.url.database or "") if is_sqlite else None


def database_file(url: str) -> Path | None:
    """Returns the file of a database; ``None`` if it is none of SQLite.

    Raises:
        StoreError: The address cannot be used.
    """
    parsed = _parse_url(url)
    return Path(parsed.database or "") if parsed.get_backend_name() == "sqlite" else None


def open_database(
    url: str,
    *,
    patience_s: float = PATIENCE_S,
    before_migration: Callable[[], None] = lambda: None,
) -> Database:
    """Opens a database, makes it if it does not exist, and migrates it to this version.

    Args:
        url: SQLAlchemy address, such as ``sqlite:////var/lib/drivora/drivora.sqlite3`` or
            ``postgresql+psycopg://drivora:secret@db.example/drivora``.
        patience_s: Seconds to wait for other writing threads, and as long again for other
            processes.
        before_migration: Called before a database of an older version is migrated; raises to
            prevent that.

    Raises:
        Conflict: It is to be migrated, and a server or a command works on it.
        StoreError: It cannot be opened, or was written by a newer version or another program.
    """
    parsed = _parse_url(url)
    file = database_file(url)
    if file is not None:
        make_data_folder(file.parent)
        refuse_foreign_database(file)
    make_engine = postgresql_engine if file is None else sqlite_engine
    with store_errors(file):
        engine = make_engine(parsed, patience_s=patience_s)

        def check() -> None:
            before_migration()
            refuse_while_used(_work_locks(engine))

        try:
            is_migrated = migrate(engine, before_migration=check)
        except BaseException:
            engine.dispose()
            raise
    database = Database(engine, patience_s=patience_s)
    if is_migrated:
        database.checkpoint()
    return database


def make_data_folder(folder: Path) -> None:
    """Creates a folder for data, for its owner only; an existing one stays as it is.

    Raises:
        StoreError: It cannot be made.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"the data folder {folder} cannot be made: {error.strerror}; {CHOOSE}"
        ) from error


def _parse_url(url: str) -> URL:
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        # Without the cause, which quotes the address with its password.
        raise StoreError(
            f"{_without_password(url)!r} is no database address; {_ADDRESSES}"
        ) from None
    backend = parsed.get_backend_name() if parsed.drivername else ""
    if backend == "sqlite" and parsed.database in (None, "", ":memory:"):
        raise StoreError("a database in memory cannot be shared by threads; give a file")
    if backend not in ("sqlite", "postgresql", "postgres"):
        raise StoreError(f"databases of {parsed.drivername!r} are not supported; {_ADDRESSES}")
    return parsed


def _without_password(url: str) -> str:
    return re.sub(r"(?<=//)[^/]*@|(?<=[?&])(password|sslpassword)=[^&]*", "…@", url)
