"""Real damage of SQLite files: bytes of their pages are overwritten."""

from __future__ import annotations

import contextlib
import random
import sqlite3
from pathlib import Path


def page_of(file: Path, name: str) -> tuple[int, int]:
    """Returns offset and size of the first page of a table or an index, in bytes.

    What is in the write-ahead log is moved into the file first.
    """
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA wal_checkpoint").fetchall()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
        query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
        (number,) = connection.execute(query, (name,)).fetchone()
    return (number - 1) * size, size


def overwrite_bytes(file: Path, offset: int, size: int) -> None:
    """Overwrites some bytes of a file with random ones, and leaves its length as it is."""
    with file.open("r+b") as handle:
        handle.seek(offset)
        handle.write(random.Random(offset).randbytes(size))


def overwrite_page(file: Path, name: str) -> None:
    """Overwrites the first page of a table or an index."""
    overwrite_bytes(file, *page_of(file, name))
