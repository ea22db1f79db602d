"""Statements for many rows, as the driver takes them."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import pytest
from sqlalchemy import bindparam, insert, select, update
from sqlalchemy.dialects import postgresql
from sqlalchemy.exc import SQLAlchemyError

from drivora_service.store.database import Database
from drivora_service.store.engine.plain_statements import _plain, execute_many
from drivora_service.store.queue.queued_runs import ATTEMPTS
from drivora_service.store.queue.run_statements import end_run
from tests.store.samples import register, submit

_NOON = datetime(2026, 1, 2, 12, 0, 0, 5, tzinfo=UTC)
_SAME = _NOON.astimezone(timezone(timedelta(hours=3)))


def _rows(owner: str, count: int) -> list[dict[str, object]]:
    return [
        {
            "run_seq": number + 1,
            "number": 1,
            "owner_id": owner,
            "claimed_at": _SAME,
            "ended_at": None if number else _NOON,
            "worker": "w",
            "outcome": "",
            "cause": "",
            "signal": "",
            "log": "",
        }
        for number in range(count)
    ]


def test_rows_are_stored_as_by_sqlalchemy(database: Database) -> None:
    submit(database, 2)
    owner = register(database)
    with database.write() as transaction:
        connection = transaction.session.connection()
        execute_many(connection, insert(ATTEMPTS), _rows(owner, 2))
        again = update(ATTEMPTS).where(ATTEMPTS.c.run_seq == bindparam("run"))
        execute_many(
            connection, again.values(worker=bindparam("worker")), [{"run": 2, "worker": "x"}]
        )
        execute_many(connection, insert(ATTEMPTS), [])
    with database.read() as transaction:
        rows = transaction.session.execute(
            select(ATTEMPTS.c.claimed_at, ATTEMPTS.c.ended_at, ATTEMPTS.c.worker)
        ).all()
    assert rows == [(_NOON, _NOON, "w"), (_NOON, None, "x")]


def test_what_the_database_refuses_is_an_error_of_the_store(database: Database) -> None:
    with pytest.raises(SQLAlchemyError), database.engine.begin() as connection:
        execute_many(connection, insert(ATTEMPTS), _rows("unknown", 1))


def test_a_driver_without_places_gets_the_names() -> None:
    dialect: Any = postgresql.dialect
    assert _plain(dialect(), end_run(), ("run",)) is None
