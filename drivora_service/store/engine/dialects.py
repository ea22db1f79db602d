"""Statements that both databases have and SQLAlchemy declares for each."""

from __future__ import annotations

from typing import Any


def insert_class(dialect: str) -> Any:
    """Returns the class of inserts that know conflicts, of a dialect by its name.

    The dialects are slow to import, so that only the one in use is.
    """
    if dialect == "postgresql":
        from sqlalchemy.dialects import postgresql

        return postgresql.insert
    from sqlalchemy.dialects import sqlite

    return sqlite.insert
