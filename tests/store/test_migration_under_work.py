"""A database is not migrated while processes of an older version work on it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from drivora_service.errors import Conflict
from drivora_service.execution.ownership import Ownership
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.locks.postgresql_work_locks import PostgresqlWorkLocks
from drivora_service.store.locks.work_locks import LongWork, WorkKind
from drivora_service.store.migration import newest_revision, revisions, schema_version, upgrade
from tests.postgresql_server import PostgresqlServer
from tests.store.campaigns.test_campaign_repository import create as create_campaign
from tests.store.locks.test_work_locks import holding_process, wait_until

_LONGEST_S = 10.0


@pytest.fixture(params=["sqlite", "postgresql"])
def older_url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """The address of a database with the schema of the version before, of each kind."""
    if request.param == "sqlite":
        url = f"sqlite:///{tmp_path / 'drivora.sqlite3'}"
        make_older(url)
        yield url
        return
    server: PostgresqlServer = request.getfixturevalue("postgresql")
    url = server.create(migrated=False)
    make_older(url)
    yield url
    server.drop(url)


def make_older(url: str) -> None:
    """Makes an empty database one of the version before."""
    engine = create_engine(url)
    upgrade(engine, revisions()[-2])
    engine.dispose()


def older_database(url: str) -> Database:
    """The database as the version before has it open."""
    return Database(create_engine(url))


@pytest.mark.parametrize(
    "kind", [WorkKind.SERVER, WorkKind.COMMAND, WorkKind.CAMPAIGN, WorkKind.STUDY]
)
def test_work_of_an_older_version_prevents_the_migration(older_url: str, kind: WorkKind) -> None:
    old = older_database(older_url)
    held = old.locks.hold(LongWork(kind, "01a2"))
    with pytest.raises(Conflict, match=rf"process \d+.* \({kind}\); stop them, or wait"):
        open_database(older_url)
    assert schema_version(old.engine) == revisions()[-2]
    # A command that only reads holds nothing, and prevents nothing.
    held.release()
    open_database(older_url).close()
    assert schema_version(old.engine) == newest_revision()
    old.close()


def test_a_killed_process_prevents_no_migration(older_url: str) -> None:
    old = older_database(older_url)
    with holding_process(older_url, LongWork.command("01a2")) as process:
        with pytest.raises(Conflict, match=rf"process {process.pid}.* \(command\)"):
            open_database(older_url)
        process.kill()
        process.wait()
        wait_until(lambda: not old.locks.is_any_held(WorkKind.COMMAND))
    open_database(older_url).close()
    assert schema_version(old.engine) == newest_revision()
    old.close()


def test_a_command_of_the_same_version_prevents_nothing(database: Database, tmp_path: Path) -> None:
    command = Ownership(database, RetryPolicy(), CommandLocks(tmp_path), is_command=True)
    command.register()
    url = database.engine.url.render_as_string(hide_password=False)
    also = open_database(url)
    beside = Ownership(also, RetryPolicy(), CommandLocks(tmp_path), is_command=True)
    beside.register()
    assert also.locks.is_any_held(WorkKind.COMMAND)
    beside.leave(())
    command.leave(())
    assert not also.locks.is_any_held(WorkKind.COMMAND)
    also.close()


def test_a_process_that_waits_for_a_migration_is_not_refused_by_its_work(
    postgresql: PostgresqlServer,
) -> None:
    url = postgresql.create(migrated=False)
    make_older(url)
    engine = create_engine(url)
    locks = PostgresqlWorkLocks(engine)
    found: list[str] = []

    def open_meanwhile() -> None:
        opened = open_database(url)
        found.append(schema_version(opened.engine))
        opened.close()

    other = threading.Thread(target=open_meanwhile)

    def begin_work() -> None:
        """Within the migration: the work that the migrating process begins after it."""
        locks.hold(LongWork.server("01a2"))
        other.start()
        until = time.monotonic() + _LONGEST_S
        with engine.connect() as connection:
            while not connection.scalar(text("SELECT 1 FROM pg_locks WHERE NOT granted LIMIT 1")):
                assert time.monotonic() < until
                time.sleep(0.02)

    upgrade(engine, before_migration=begin_work)
    other.join()
    assert found == [newest_revision()]
    locks.close()
    engine.dispose()
    postgresql.drop(url)


def test_work_does_not_begin_on_a_database_that_was_migrated_meanwhile(
    database: Database, tmp_path: Path
) -> None:
    campaign_id = create_campaign(database)
    with database.write() as transaction:
        transaction.session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    for is_command in (False, True):
        mine = Ownership(database, RetryPolicy(), CommandLocks(tmp_path), is_command=is_command)
        with pytest.raises(Conflict, match="'9999'; use that version"):
            mine.register()
    with pytest.raises(Conflict, match="'9999'"), database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
    with database.write() as transaction:
        newest = {"newest": newest_revision()}
        transaction.session.execute(
            text("UPDATE alembic_version SET version_num = :newest"), newest
        )
