"""Migrating a database to the schema of this version."""

from __future__ import annotations

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine

from drivora_service.errors import StoreError


def migrate(engine: Engine) -> None:
    """Migrates to the newest schema; does nothing to a database that has it.

    Raises:
        StoreError: The database was written by a newer version.
    """
    script = ScriptDirectory.from_config(_config())
    head = script.get_current_head()
    with engine.connect() as connection:
        current = MigrationContext.configure(connection).get_current_revision()
    if current == head:
        return
    known = {revision.revision for revision in script.walk_revisions()}
    if current is not None and current not in known:
        raise StoreError(
            f"the database has schema {current!r}, which this version does not know; "
            "use the version that wrote it, or a newer one"
        )
    with engine.execution_options(drivora_writes=True).begin() as connection:
        command.upgrade(_config(connection), "head")


def revisions() -> tuple[str, ...]:
    """Returns the revisions of the schema, oldest first."""
    walked = ScriptDirectory.from_config(_config()).walk_revisions()
    return tuple(revision.revision for revision in walked)[::-1]


def schema_version(engine: Engine) -> str:
    """Returns the schema revision of a database, or "" for an empty one."""
    with engine.connect() as connection:
        return MigrationContext.configure(connection).get_current_revision() or ""


def _config(connection: Connection | None = None) -> Config:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.set_main_option("path_separator", "os")
    config.attributes["connection"] = connection
    return config
