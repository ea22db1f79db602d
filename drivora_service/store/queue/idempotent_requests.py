"""Requests that must not be done twice."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

from sqlalchemy import delete
from sqlalchemy.orm import Session

from drivora_service.store.engine.base_tables import IdempotencyRow
from drivora_service.store.runs.run_records import Reservation


class IdempotencyRepository:
    """Idempotency keys of clients' requests.

    The caller reserves a key in a transaction of its own, does the work, and completes the key in
    the transaction that stores the work, so that both are kept or neither.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def reserve(self, key: str, fingerprint: str) -> Reservation:
        """Reserves a key, or returns its existing reservation."""
        row = self._session.get(IdempotencyRow, key)
        if row is not None:
            return Reservation(fresh=False, fingerprint=row.fingerprint, reference=row.reference)
        self._session.add(
            IdempotencyRow(
                key=key, fingerprint=fingerprint, reference=None, created_at=datetime.now(UTC)
            )
        )
        return Reservation(fresh=True, fingerprint=fingerprint, reference=None)

    def complete(self, key: str, reference: str) -> None:
        """Stores the answer to the request of a reserved key."""
        row = self._session.get_one(IdempotencyRow, key)
        row.reference = reference

    def give_up(self, key: str) -> None:
        """Releases the key of a request that could not be done."""
        self._session.execute(
            delete(IdempotencyRow).where(
                IdempotencyRow.key == key, IdempotencyRow.reference.is_(None)
            )
        )

    def clean(self, *, unfinished: bool, older_than: timedelta = timedelta(days=1)) -> None:
        """Removes old keys and, at the start of the only server, those of interrupted requests.

        Args:
            unfinished: Whether keys without an answer are removed at any age.
            older_than: Age from which a key is removed.
        """
        old = IdempotencyRow.created_at < datetime.now(UTC) - older_than
        which = old | IdempotencyRow.reference.is_(None) if unfinished else old
        self._session.execute(delete(IdempotencyRow).where(which))
