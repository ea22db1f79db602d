"""Migrating a database to the schema of this version."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import (
    Column,
    Connection,
    Engine,
    MetaData,
    PrimaryKeyConstraint,
    String,
    Table,
    insert,
    inspect,
    text,
)
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict, StoreError
from drivora_service.store.changes.revisions import new_epoch
from drivora_service.store.engine.base_tables import Base, EpochRow
from drivora_service.store.engine.postgresql import give_types_of_sqlite, lock_schema
from drivora_service.store.engine.storage_faults import CHOOSE

if TYPE_CHECKING:
    from alembic.config import Config
    from alembic.script import ScriptDirectory

_VERSION = Table(
    "alembic_version",
    MetaData(),
    Column("version_num", String(32), nullable=False),
    PrimaryKeyConstraint("version_num", name="alembic_version_pkc"),
)
"""Where the migrations keep the revision of the schema."""

_VERSIONS = Path(__file__).parent / "migrations" / "versions"


def migrate(engine: Engine, *, before_migration: Callable[[], None] = lambda: None) -> bool:
    """Migrates to the newest schema; does nothing to a database that has it.

    Args:
        engine: Of the database.
        before_migration: Called before a database of an older version is changed; raises to
            prevent that.

    Returns:
        Whether a database of an older version was changed.

    Raises:
        StoreError: The database was written by a newer version.
    """
    current = schema_version(engine)
    if current == newest_revision():
        return False
    if not current and engine.dialect.name == "sqlite" and _make_schema_if_empty(engine):
        return False
    script = _scripts()
    known = {revision.revision for revision in script.walk_revisions()}
    if current and current not in known:
        raise StoreError(
            f"the database {_place(engine)} has schema {current!r}, which this version does not "
            f"know (its own is {newest_revision()!r}); use the version that wrote it, or a newer "
            f"one, or {CHOOSE}"
        )
    upgrade(engine, before_migration=before_migration)
    return True


def upgrade(
    engine: Engine,
    revision: str = "head",
    *,
    before_migration: Callable[[], None] = lambda: None,
) -> None:
    """Migrates the database to a revision.

    Args:
        engine: Of the database.
        revision: The revision.
        before_migration: As :func:`migrate` says.
    """
    # Imported here: it takes a third of a second, and most databases have the newest schema.
    from alembic import command

    with engine.execution_options(drivora_writes=True).begin() as connection:
        is_postgresql = connection.dialect.name == "postgresql"
        if is_postgresql:
            lock_schema(connection)
        # Another process may have done it meanwhile, and work on it already.
        if _version_of(connection) not in ("", newest_revision()):
            # No process can write now: what takes its lock after this check finds the new schema
            # with its first transaction, see `refuse_other_schema`.
            before_migration()
        command.upgrade(_config(connection), revision)
        if is_postgresql:
            give_types_of_sqlite(connection)


def _make_schema_if_empty(engine: Engine) -> bool:
    """Creates the newest schema in an empty database; returns whether it was empty.

    It is that which all migrations lead to, up to the order of columns, in a tenth of the time.
    Only for SQLite, of which every test and many a command makes a database.
    """
    with engine.execution_options(drivora_writes=True).begin() as connection:
        # Another process may have made it meanwhile.
        if inspect(connection).get_table_names():
            return False
        Base.metadata.create_all(connection)
        connection.execute(insert(EpochRow).values(id=new_epoch(), last=0))
        _VERSION.create(connection)
        connection.execute(_VERSION.insert().values(version_num=newest_revision()))
    return True


def newest_revision() -> str:
    """Returns the newest revision of the schema: the first four digits of its file's name."""
    return max(path.name[:4] for path in _VERSIONS.glob("[0-9]*.py"))


def revisions() -> tuple[str, ...]:
    """Returns the revisions of the schema, oldest first."""
    return tuple(revision.revision for revision in _scripts().walk_revisions())[::-1]


def schema_version(engine: Engine) -> str:
    """Returns the schema revision of a database, or "" for an empty one."""
    with engine.connect() as connection:
        return _version_of(connection)


def refuse_other_schema(session: Session) -> None:
    """Refuses to begin long work on a database that was migrated after it was opened.

    For the first transaction after a lock of ``store.locks.work_locks`` was taken: a migration
    looks for these locks, and a process takes its lock some time after it has opened the database.

    Raises:
        Conflict: A newer version has migrated it.
    """
    found = session.scalar(text("SELECT version_num FROM alembic_version"))
    if found != newest_revision():
        raise Conflict(
            f"a newer version of Drivora has just migrated the database to schema {found!r}; "
            "use that version"
        )


def _place(engine: Engine) -> str:
    """Returns what names the database, without a password."""
    url = engine.url
    return url.database or "" if engine.dialect.name == "sqlite" else repr(url)


def _version_of(connection: Connection) -> str:
    if not inspect(connection).has_table("alembic_version"):
        return ""
    return connection.scalar(text("SELECT version_num FROM alembic_version")) or ""


def _scripts() -> ScriptDirectory:
    from alembic.script import ScriptDirectory

    return ScriptDirectory.from_config(_config())


def _config(connection: Connection | None = None) -> Config:
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(_VERSIONS.parent))
    config.set_main_option("path_separator", "os")
    config.attributes["connection"] = connection
    return config
