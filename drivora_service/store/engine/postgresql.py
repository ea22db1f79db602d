"""Connections and transactions of PostgreSQL, and what its schema has in place of SQLite's."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, text
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from drivora_service.errors import StoreError

if TYPE_CHECKING:
    from psycopg import Connection as DriverConnection

DRIVER = "postgresql+psycopg"
_POOL, _OVERFLOW = 5, 15
"""Connections of one process that are kept, and more under load: a server allows about a hundred
in total, and the engine of each campaign is a process of its own."""

_STATEMENT_S = 600.0
"""Seconds after which a statement is given up, so that no thread waits for ever for a server that
hangs."""
_IDLE = "60s"
"""Time after which the server ends a transaction that writes and whose client does nothing: a
process that was stopped, or whose machine is gone, must not keep the others from writing."""

_READER_IDLE_S = 600.0
"""The same of a transaction that only reads, in seconds. A table is exported as slowly as its
client receives it, but a client that stops for this long must not keep a migration waiting."""

_CONNECTING = {
    "application_name": "drivora",
    "client_encoding": "utf8",
    "connect_timeout": 10,
    "keepalives_idle": 15,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    # While an answer is awaited, no keepalive is sent.
    "tcp_user_timeout": 30_000,
}
"""What the driver gets unless the address says it: a machine that is gone is noticed within half a
minute, not within the minutes or hours of the operating system's own limits."""

_WRITING = 0x647269766F7261
"""Number of the advisory lock of transactions that write: "drivora"."""

_ADVICE = "check DRIVORA_DATABASE_URL (postgresql+psycopg://USER:PASSWORD@HOST:PORT/DATABASE)"


def postgresql_engine(url: URL, *, patience_s: float) -> Engine:
    """Returns an engine whose connections treat values as SQLite does.

    Args:
        url: Address of a database.
        patience_s: Seconds to wait for other writers, and for a free connection.

    Raises:
        StoreError: The driver is not installed, or the server or the database cannot be used.
    """
    try:
        import psycopg  # noqa: F401 # SQLAlchemy's own error names no extra
    except ImportError as error:
        raise StoreError(
            "PostgreSQL needs the extra `postgresql`, which is not installed: "
            "pip install 'drivora[postgresql]'"
        ) from error
    engine = create_engine(
        url.set(drivername=DRIVER),
        pool_size=_POOL,
        max_overflow=_OVERFLOW,
        pool_timeout=patience_s,
        # Else each connection that a restart of the server has ended costs a request.
        pool_pre_ping=True,
        connect_args={name: it for name, it in _CONNECTING.items() if name not in url.query},
    )
    event.listen(engine, "connect", partial(_configure, patience_s))
    try:
        _check_server(engine)
    except BaseException:
        engine.dispose()
        raise
    return engine


def reading_options() -> dict[str, Any]:
    """Returns the options of transactions that only read: all their queries see one moment."""
    return {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}


def lock_writing(session: Session) -> None:
    """Locks out other transactions that write until this one has ended.

    It must be the first statement: the later ones then see all that those before have committed.
    Revisions are thereby counted in the order of the commits, see ``store.changes.revisions``.
    """
    session.connection().execute(_BEGIN_WRITING, {"idle": _IDLE, "key": _WRITING})


def lock_schema(connection: Connection) -> None:
    """Waits for other processes that migrate, however long they take, and for those that write.

    Raises:
        StoreError: The user of the database may not make tables.
    """
    for limit in ("lock_timeout", "statement_timeout"):
        connection.exec_driver_sql(f"SET LOCAL {limit} = 0")
    connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _WRITING})
    if not connection.scalar(text("SELECT has_schema_privilege(current_schema(), 'CREATE')")):
        raise StoreError(
            f"{_place(connection.engine.url)}: the user may not make tables; make it the owner of "
            "the database, or GRANT CREATE ON SCHEMA public to it"
        )


def give_types_of_sqlite(connection: Connection) -> None:
    """Changes the types of all columns, so that they hold and order values as SQLite does.

    Texts have no greatest length and are ordered by their characters' numbers, in every database;
    integers have 64 bits. Migrations need not say so.
    """
    rows = connection.execute(_OTHER_COLUMNS).all()
    tables: dict[str, list[str]] = {}
    for table, column, is_text in rows:
        kind = 'text COLLATE "C"' if is_text else "bigint"
        tables.setdefault(table, []).append(f'ALTER COLUMN "{column}" TYPE {kind}')
    for table, changes in tables.items():
        connection.exec_driver_sql(f'ALTER TABLE "{table}" {", ".join(changes)}')
    for (sequence,) in connection.execute(_SHORT_SEQUENCES).all():
        connection.exec_driver_sql(f'ALTER SEQUENCE "{sequence}" AS bigint')


_BEGIN_WRITING = text(
    "SELECT set_config('idle_in_transaction_session_timeout', :idle, true), "
    "pg_advisory_xact_lock(:key)"
)
_OTHER_COLUMNS = text(
    "SELECT table_name, column_name, data_type != 'integer' FROM information_schema.columns "
    "WHERE table_schema = current_schema() AND (data_type IN ('integer', 'character varying') "
    "OR data_type = 'text' AND collation_name IS DISTINCT FROM 'C') "
    "ORDER BY table_name, ordinal_position"
)
_SHORT_SEQUENCES = text(
    "SELECT sequencename FROM pg_sequences "
    "WHERE schemaname = current_schema() AND data_type = 'integer'::regtype"
)


def _check_server(engine: Engine) -> None:
    try:
        with engine.connect() as connection:
            encoding = connection.scalar(text("SHOW server_encoding"))
    except OperationalError as error:
        raise StoreError(
            f"PostgreSQL cannot be used: {_place(engine.url)}: {_first_line(error)}; {_ADVICE}, "
            "and that the server runs and has this database and this user"
        ) from error
    if encoding != "UTF8":
        raise StoreError(
            f"{_place(engine.url)} has the encoding {encoding}; make one with CREATE DATABASE … "
            "ENCODING 'UTF8' TEMPLATE template0"
        )


def _place(url: URL) -> str:
    """Returns what an address names, without its password."""
    return str(URL.create(DRIVER, url.username, None, url.host, url.port, url.database))


def _first_line(error: OperationalError) -> str:
    """Returns the driver's message without its hints about other attempts."""
    lines = [line.strip() for line in str(error.orig).splitlines() if line.strip()]
    return lines[0].removesuffix(":") if lines else "no reason was given"


def _configure(patience_s: float, connection: DriverConnection[Any], _record: object) -> None:
    from drivora_service.store.engine.postgresql_values import adapt_values

    adapt_values(connection.adapters)
    limits = {
        "lock_timeout": patience_s,
        "statement_timeout": _STATEMENT_S,
        "idle_in_transaction_session_timeout": _READER_IDLE_S,
    }
    with connection.cursor() as cursor:
        for name, seconds in limits.items():
            cursor.execute("SELECT set_config(%s, %s, false)", (name, f"{round(1000 * seconds)}ms"))
        cursor.execute("SET TIME ZONE 'UTC'")
    connection.commit()
