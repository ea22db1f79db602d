"""Detecting cheaply whether a database has changed."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from urllib.parse import quote

from sqlalchemy import Engine


class ChangeCounter:
    """A number that changes with every commit, of this process or of any other.

    Reading it takes some microseconds and waits for no lock, so that the event loop may do it.
    """

    def __init__(self, engine: Engine) -> None:
        file = engine.url.database if engine.dialect.name == "sqlite" else None
        self._file = Path(file).absolute() if file else None
        self._connection: sqlite3.Connection | None = None
        self._closed = False

    def value(self) -> int | None:
        """Returns the number, of no meaning by itself; ``None`` if it is not available.

        The numbers of two counters cannot be compared.
        """
        if self._file is None or self._closed:
            return None
        try:
            if self._connection is None:
                # This connection never writes: SQLite does not count a connection's own commits.
                self._connection = sqlite3.connect(
                    f"file:{quote(str(self._file))}?mode=ro",
                    uri=True,
                    timeout=0.0,
                    isolation_level=None,
                    check_same_thread=False,
                )
            (number,) = self._connection.execute("PRAGMA data_version").fetchone()
        except sqlite3.Error:
            return None
        return int(number)

    def close(self) -> None:
        """Closes its connection; from then on the value is ``None``."""
        self._closed = True
        if self._connection is not None:
            self._connection.close()
            self._connection = None
