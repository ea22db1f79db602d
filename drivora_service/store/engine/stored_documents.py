"""Scenarios, each stored once for all runs and evaluations that have it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, cast

from sqlalchemy import Table
from sqlalchemy.orm import Session

from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.engine.dialects import insert_class

_DOCUMENTS = cast("Table", DocumentRow.__table__)


def store_documents(session: Session, documents: Mapping[str, str]) -> None:
    """Writes the scenarios that are not stored yet.

    Args:
        session: The transaction.
        documents: Canonical JSON texts by their hashes.
    """
    if documents:
        connection = session.connection()
        connection.execute(
            _make_insert(connection.dialect.name),
            [{"sha256": sha256, "body": body} for sha256, body in documents.items()],
        )


@cache
def _make_insert(dialect: str) -> Any:
    return insert_class(dialect)(_DOCUMENTS).on_conflict_do_nothing(index_elements=["sha256"])
