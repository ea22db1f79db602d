"""Scenarios, each stored once for all runs and evaluations that have it."""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from drivora_service.store.chunks import batched
from drivora_service.store.tables import DocumentRow


def store_documents(session: Session, documents: Mapping[str, str]) -> None:
    """Writes the scenarios that are not stored yet.

    Args:
        session: The transaction.
        documents: Canonical JSON texts by their hashes.
    """
    known: set[str] = set()
    for chunk in batched(list(documents)):
        query = select(DocumentRow.sha256).where(DocumentRow.sha256.in_(chunk))
        known.update(session.scalars(query))
    new = [
        {"sha256": sha256, "body": body}
        for sha256, body in documents.items()
        if sha256 not in known
    ]
    if new:
        session.execute(insert(DocumentRow), new)
