"""What a server has and a file has not: opening it, several writers, its own values."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import make_url, text
from sqlalchemy.exc import DBAPIError

from drivora_service.errors import StoreDamaged, StoreError, StoreUnavailable
from drivora_service.store.changes.revisions import latest_revision
from drivora_service.store.database import Database, database_file, open_database
from drivora_service.store.engine import postgresql as connections
from drivora_service.store.migration import newest_revision, revisions, schema_version, upgrade
from drivora_service.store.runs.run_records import JobFilter, Priority
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.backup import back_up
from drivora_service.store.upkeep.free_space import return_free_space, rewrite_database
from drivora_service.store.upkeep.store_verification import verify
from tests.postgresql_server import PASSWORD, PostgresqlServer
from tests.store.samples import claim, crashed, finish, new_run, register, submit


@pytest.fixture
def url(postgresql: PostgresqlServer) -> Iterator[str]:
    """The address of a database with the newest schema."""
    made = postgresql.create()
    yield made
    postgresql.drop(made)


@pytest.fixture
def empty_url(postgresql: PostgresqlServer) -> Iterator[str]:
    """The address of a database without tables."""
    made = postgresql.create(migrated=False)
    yield made
    postgresql.drop(made)


@pytest.fixture
def database(url: str) -> Iterator[Database]:
    opened = open_database(url)
    yield opened
    opened.close()


@pytest.fixture
def impatient(url: str) -> Iterator[Database]:
    opened = open_database(url, patience_s=0.3)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def account(postgresql: PostgresqlServer) -> str:
    """A user who may connect and make nothing; it needs :data:`PASSWORD`."""
    postgresql.execute(f"CREATE ROLE {{}} LOGIN PASSWORD '{PASSWORD}'", "guest")
    return "guest"


def test_servers_that_start_together_migrate_once(empty_url: str) -> None:
    together = threading.Barrier(4)

    def start() -> str:
        together.wait()
        opened = open_database(empty_url, patience_s=0.2)
        with opened.read() as transaction:
            epochs = transaction.session.scalar(text("SELECT count(*) FROM change_epochs"))
        version = schema_version(opened.engine)
        opened.close()
        return f"{version} {epochs}"

    with ThreadPoolExecutor(4) as pool:
        starts = [pool.submit(start) for _ in range(4)]
    assert {one.result() for one in starts} == {f"{newest_revision()} 1"}


def test_a_database_of_an_older_version_is_migrated(empty_url: str) -> None:
    engine = open_database(empty_url).engine
    with engine.begin() as connection:
        connection.execute(text("DROP SCHEMA public CASCADE"))
        connection.execute(text("CREATE SCHEMA public"))
    upgrade(engine, revisions()[4])
    asked: list[None] = []
    opened = open_database(empty_url, before_migration=lambda: asked.append(None))
    assert len(asked) == 1
    submit(opened, 2)
    opened.close()
    engine.dispose()


def test_a_newer_database_is_refused(url: str, database: Database) -> None:
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StoreError, match="'9999'"):
        open_database(url)


def refusal(url: str) -> str:
    """The message of the refusal of an address, with all that was raised on the way."""
    with pytest.raises(StoreError) as refused:
        open_database(url)
    error: BaseException | None = refused.value
    messages = []
    while error is not None:
        messages.append(str(error))
        error = None if error.__suppress_context__ and not error.__cause__ else error.__cause__
    assert PASSWORD not in "\n".join(messages)
    return messages[0]


def test_a_wrong_password_is_refused_and_no_password_is_told(
    postgresql: PostgresqlServer, account: str
) -> None:
    wrong = refusal(postgresql.url("postgres", user=account, password=f"no {PASSWORD}"))
    assert 'password authentication failed for user "guest"' in wrong
    assert "DRIVORA_DATABASE_URL" in wrong


def test_a_database_or_a_server_that_is_not_there_is_named(
    postgresql: PostgresqlServer, tmp_path: Path
) -> None:
    assert 'database "absent" does not exist' in refusal(postgresql.url("absent"))
    nowhere = replace(postgresql, folder=tmp_path).url("x", password=PASSWORD)
    assert "DRIVORA_DATABASE_URL" in refusal(nowhere)


def test_a_user_who_may_make_no_tables_is_told_so(
    postgresql: PostgresqlServer, account: str, empty_url: str
) -> None:
    name = database_name(empty_url)
    found = refusal(postgresql.url(name, user=account, password=PASSWORD))
    assert "GRANT CREATE ON SCHEMA public" in found


def test_another_encoding_is_refused(postgresql: PostgresqlServer) -> None:
    statement = "CREATE DATABASE {} ENCODING 'SQL_ASCII' TEMPLATE template0"
    postgresql.execute(statement, "ascii")
    assert "ENCODING 'UTF8'" in refusal(postgresql.url("ascii"))
    postgresql.execute("DROP DATABASE {}", "ascii")


@pytest.mark.parametrize(
    "address",
    [
        f"postgresql//drivora:{PASSWORD}@host/drivora",
        f"postgresql://drivora:{PASSWORD}@host:port/drivora",
        f"mysql://drivora:{PASSWORD}@host/drivora",
    ],
)
def test_addresses_that_cannot_work_are_refused_without_their_password(address: str) -> None:
    assert "postgresql+psycopg://USER:PASSWORD@HOST" in refusal(address)


def test_a_machine_that_is_gone_is_noticed_within_half_a_minute(database: Database) -> None:
    with database.engine.connect() as connection:
        driver: Any = connection.connection.dbapi_connection
        given = {name: str(value) for name, value in driver.info.get_parameters().items()}
    # Idle connections are asked; what was sent and is not acknowledged is given up.
    idle, interval, count = (
        int(given[f"keepalives_{name}"]) for name in ("idle", "interval", "count")
    )
    assert idle + interval * count <= 30
    assert 0 < int(given["tcp_user_timeout"]) <= 30_000


@pytest.mark.parametrize("scheme", ["postgresql", "postgres", "postgresql+psycopg2"])
def test_other_spellings_use_the_same_driver(url: str, scheme: str) -> None:
    opened = open_database(url.replace("postgresql+psycopg", scheme, 1))
    submit(opened, 1)
    opened.close()
    assert database_file(url) is None


def test_a_reader_that_saw_a_revision_misses_no_smaller_one(url: str, database: Database) -> None:
    """Several processes write; each has connections of its own."""
    stop = threading.Event()

    def write() -> None:
        own = open_database(url)
        for _ in range(25):
            submit(own, 2)
        own.close()

    def follow() -> list[int]:
        seen: list[int] = []
        while True:
            ended = stop.is_set()
            with database.read() as transaction:
                newest = latest_revision(transaction.session)
                since = {"last": seen[-1] if seen else 0}
                query = text("SELECT revision FROM runs WHERE revision > :last ORDER BY revision")
                seen += transaction.session.scalars(query, since).all()
                assert not seen or seen[-1] <= newest
            if ended:
                return seen

    with ThreadPoolExecutor(5) as pool:
        follower = pool.submit(follow)
        writers = [pool.submit(write) for _ in range(4)]
        for writer in writers:
            writer.result()
        stop.set()
        seen = follower.result()
    with database.read() as transaction:
        stored = transaction.session.scalars(text("SELECT revision FROM runs ORDER BY revision"))
        assert seen == stored.all()
    assert len(seen) == 200


def test_all_queries_of_a_reader_see_one_moment(database: Database) -> None:
    submit(database, 1)
    with database.read() as transaction:
        before = transaction.jobs.page(JobFilter(), limit=100)
        submit(database, 5)
        assert transaction.jobs.page(JobFilter(), limit=100) == before
    with database.read() as transaction:
        assert len(transaction.jobs.page(JobFilter(), limit=100).items) == 6


def test_a_reader_cannot_write(database: Database) -> None:
    with pytest.raises(StoreError), database.read() as transaction:
        transaction.jobs.submit([new_run()])


def test_a_writer_that_is_kept_waiting_gives_up(database: Database, impatient: Database) -> None:
    with database.write():
        begun = time.monotonic()
        with pytest.raises(StoreUnavailable, match="lock timeout"), impatient.write():
            raise AssertionError
        assert time.monotonic() - begun < 10
    submit(impatient, 1)


def test_a_writer_that_does_nothing_is_ended(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "_IDLE", "100ms")

    def sleep() -> None:
        with database.write() as transaction:
            transaction.jobs.submit([new_run("lost")])
            time.sleep(0.5)

    with pytest.raises(StoreUnavailable):
        sleep()
    submit(database, 1)
    with database.read() as transaction:
        # A table is exported as slowly as it is received.
        time.sleep(0.5)
        assert len(transaction.jobs.page(JobFilter(), limit=9).items) == 1


def test_a_reader_that_does_nothing_keeps_a_migration_from_nothing(
    empty_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = connections.postgresql_engine(make_url(empty_url), patience_s=1.0)
    upgrade(engine, revisions()[-2])
    count = text("SELECT count(*) FROM campaigns")
    with monkeypatch.context() as patch:
        # Of the reader alone: on a busy machine a migration, too, does nothing for a second.
        patch.setattr(connections, "_READER_IDLE_S", 1.0)
        reading = connections.postgresql_engine(make_url(empty_url), patience_s=1.0)
        reader = reading.connect()
    with reader:
        reader.execute(count)
        # Waits until the server has ended the reader.
        upgrade(engine)
        with pytest.raises(DBAPIError, match="idle-in-transaction"):
            reader.execute(count)
    assert schema_version(engine) == newest_revision()
    reading.dispose()
    engine.dispose()


def test_the_end_of_a_connection_is_noted_once_at_most(
    postgresql: PostgresqlServer, url: str, database: Database
) -> None:
    submit(database, 1)
    name = database_name(url)
    end = f"SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity WHERE datname = '{name}'"

    def lose() -> None:
        with database.write() as transaction:
            transaction.jobs.submit([new_run("lost")])
            postgresql.execute(end)

    with pytest.raises(StoreUnavailable):
        lose()
    postgresql.execute(end)
    submit(database, 1)
    with database.read() as transaction:
        assert len(transaction.jobs.page(JobFilter(), limit=9).items) == 2
    database.probe()


def test_nul_in_what_a_program_printed_loses_no_run(database: Database, tmp_path: Path) -> None:
    (run,) = submit(database, 1, priority=Priority.CI)
    owner = register(database)
    for _ in range(2):
        claim(database, owner, 1)
        end = crashed(run)
        assert end.report.failure is not None
        failure = replace(end.report.failure, message="a\0b", log="\0")
        finish(database, owner, replace(end, report=replace(end.report, failure=failure)))
    with database.read() as transaction:
        assert {one.log for one in transaction.jobs.attempts(run)} == {"�"}
        report = transaction.jobs.report(run)
    assert report is not None
    assert report.failure is not None
    # Reports are JSON, which has another notation for it.
    assert report.failure.message == "a\0b"
    assert list(verify(database, TraceFolder(tmp_path))) == []


def test_texts_are_ordered_by_their_characters_and_have_no_greatest_length(
    database: Database,
) -> None:
    agents = ["b", "B", "a", "é", "_", "Z" * 5000]
    with database.write() as transaction:
        transaction.jobs.submit([new_run(agent=agent) for agent in agents])
    with database.read() as transaction:
        found = transaction.session.scalars(text("SELECT agent FROM runs ORDER BY agent")).all()
    assert found == sorted(agents)


def test_integers_have_64_bits(database: Database) -> None:
    with database.write() as transaction:
        transaction.session.execute(text("UPDATE change_epochs SET last = 3000000000"))
    submit(database, 1)
    with database.read() as transaction:
        (job,) = transaction.jobs.page(JobFilter()).items
        session = transaction.session
        assert job.revision > 3_000_000_000
        total = session.scalar(text("SELECT sum(revision) FROM runs"))
        assert (total, type(total)) == (job.revision, int)
        mean = session.scalar(text("SELECT avg(attempts) + 0.5 FROM runs"))
        assert (mean, type(mean)) == (0.5, float)
        short = "SELECT count(*) FROM pg_sequences WHERE data_type = 'integer'::regtype"
        assert session.scalar(text(short)) == 0


def test_what_is_about_files_names_the_tool_of_the_server(
    database: Database, tmp_path: Path
) -> None:
    with pytest.raises(StoreError, match="pg_dump"):
        back_up(database, TraceFolder(tmp_path), tmp_path / "backup")
    assert return_free_space(database) == 0
    with pytest.raises(StoreError, match="VACUUM FULL"):
        rewrite_database(database)


def database_name(url: str) -> str:
    return make_url(url).database or ""


@pytest.mark.parametrize("state", ["XX001", "XX002"])
def test_damaged_data_and_indices_are_latched(url: str, state: str) -> None:
    """The server itself raises the errors: data_corrupted and index_corrupted."""
    database = open_database(url)
    statement = text(f"DO $$ BEGIN RAISE EXCEPTION 'bad page' USING ERRCODE = '{state}'; END $$")
    with (
        pytest.raises(StoreDamaged, match=r"bad page.*`pg_restore`"),
        database.read() as transaction,
    ):
        transaction.session.execute(statement)
    with pytest.raises(StoreDamaged, match="bad page"):
        database.probe()
    database.close()
