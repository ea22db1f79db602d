"""Scenarios that are known to crash the simulator."""

from __future__ import annotations

import hashlib
from datetime import UTC, datetime

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.runs.run_records import QuarantineRecord
from drivora_service.store.runs.run_tables import QuarantineRow


def quarantine_key(scenario_sha256: str, agent_override: str, seed_override: int | None) -> str:
    """Returns the key of a scenario with the agent and the seed that override its own."""
    if not agent_override and seed_override is None:
        return scenario_sha256
    return hashlib.sha256(
        f"{scenario_sha256}\n{agent_override}\n{seed_override}".encode()
    ).hexdigest()


def make_quarantine_report(run_id: str, record: QuarantineRecord) -> RunReport:
    """Returns the report of a run that is not started because its scenario is quarantined."""
    return RunReport(
        run_id=run_id,
        status=RunStatus.SIMULATOR_CRASHED,
        failure=RunFailure(
            cause="quarantined",
            message=f"not run again: it crashed the simulator in run {record.run_id} "
            f"({record.message})",
            log=record.log,
        ),
    )


class QuarantineRepository:
    """Reads and writes the quarantine."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def find(self, keys: frozenset[str]) -> dict[str, QuarantineRecord]:
        """Returns those of ``keys`` that are quarantined."""
        found: dict[str, QuarantineRecord] = {}
        wanted = sorted(keys)
        for start in range(0, len(wanted), 500):
            chunk = wanted[start : start + 500]
            rows = self._session.scalars(select(QuarantineRow).where(QuarantineRow.key.in_(chunk)))
            found.update((row.key, _record(row)) for row in rows)
        return found

    def newest(self, limit: int = 100) -> tuple[QuarantineRecord, ...]:
        """Returns the newest entries first."""
        query = select(QuarantineRow).order_by(QuarantineRow.created_at.desc()).limit(limit)
        return tuple(_record(row) for row in self._session.scalars(query))

    def add(
        self, key: str, *, scenario_sha256: str, run_id: str, signal: str, failure: RunFailure
    ) -> None:
        """Quarantines a scenario; an existing entry is kept."""
        if self._session.get(QuarantineRow, key) is None:
            self._session.add(
                QuarantineRow(
                    key=key,
                    document_sha256=scenario_sha256,
                    run_id=run_id,
                    cause=failure.cause,
                    signal=signal,
                    message=failure.message,
                    log=failure.log,
                    created_at=datetime.now(UTC),
                )
            )

    def release(self, scenario_sha256: str) -> int:
        """Releases a scenario with every agent and seed; returns the number of removed entries.

        Raises:
            UnknownName: It is not quarantined.
        """
        statement = delete(QuarantineRow).where(QuarantineRow.document_sha256 == scenario_sha256)
        removed = len(self._session.scalars(statement.returning(QuarantineRow.key)).all())
        if not removed:
            raise UnknownName("quarantined scenario", scenario_sha256, ())
        return removed


def _record(row: QuarantineRow) -> QuarantineRecord:
    return QuarantineRecord(
        key=row.key,
        scenario_sha256=row.document_sha256,
        run_id=row.run_id,
        cause=row.cause,
        signal=row.signal,
        message=row.message,
        log=row.log,
        created_at=row.created_at,
    )
