"""Refusing the SQLite databases of other programs, before anything in them is changed."""

from __future__ import annotations

import contextlib
import re
import sqlite3
from pathlib import Path
from urllib.parse import quote

from drivora_service.errors import StoreError
from drivora_service.store.engine.storage_faults import CHOOSE

_REVISION = re.compile("[0-9]{4}")
"""Revisions of Drivora's schema; other programs that use the same tool have others."""


def refuse_foreign_database(file: Path) -> None:
    """Refuses a database that another program has made.

    Opening it as Drivora's would make it change its journal, and would add tables. What is no
    database, or cannot be read, is left to the code that opens it.

    Args:
        file: Path of an SQLite database, which need not exist.

    Raises:
        StoreError: The database has tables, but not those of Drivora.
    """
    if not file.is_file():
        return
    with contextlib.suppress(sqlite3.Error):
        connection = sqlite3.connect(f"file:{quote(str(file))}?mode=ro", uri=True)
        try:
            sign = _find_sign(connection)
        finally:
            connection.close()
        if sign:
            raise StoreError(
                f"{file} is the database of another program ({sign}), and was left as it is; "
                f"{CHOOSE}"
            )


def _find_sign(connection: sqlite3.Connection) -> str:
    """Returns what shows that a database is of another program; "" if it may be Drivora's."""
    tables = [name for (name,) in connection.execute("SELECT name FROM sqlite_master")]
    if not tables:
        return ""
    if "alembic_version" not in tables:
        return f"it has the table {tables[0]!r}"
    for (version,) in connection.execute("SELECT version_num FROM alembic_version"):
        if not _REVISION.fullmatch(version):
            return f"its schema is {version[:40]!r}"
    return ""
