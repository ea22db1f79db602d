"""Runs and their ends for the tests of the store."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime

import pytest
from sqlalchemy import event

from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_identity import FailureIdentity
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.database import Database
from drivora_service.store.minimizations.minimization_records import NewMinimization
from drivora_service.store.runs.run_records import NewRun, Priority

POLICY = RetryPolicy()

only_sqlite = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)
"""For tests of SQLite's file, or of how it plans queries."""

slow_on_postgresql = pytest.mark.parametrize(
    "database_url",
    ["sqlite", pytest.param("postgresql", marks=pytest.mark.slow)],
    indirect=True,
)
"""For tests with so many transactions that the ways to a server and back take the most time."""


def new_run(text: str = "{}", **changes: object) -> NewRun:
    fields: dict[str, object] = {
        "document": text,
        "scenario_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "town": "tee-town",
        "agent": "idm",
    }
    return NewRun(**(fields | changes))  # type: ignore[arg-type] # the test names the fields


def new_minimization(**changes: object) -> NewMinimization:
    """A minimisation of a collision with a walker."""
    failure = FailureIdentity(
        oracle="collision",
        ego="ego",
        accountability=Accountability.AVOIDABLE,
        counterpart_role="npc_walker",
        location=(4.5, 47.0),
        radius_m=10.0,
    )
    plain = NewMinimization(run_id="r" * 24, failure=failure, budget=100, document="{}")
    return replace(plain, **changes)  # type: ignore[arg-type] # names of its fields


def submit(database: Database, count: int, *, priority: Priority | None = None) -> tuple[str, ...]:
    """Queues ``count`` runs, in a batch of their own if a priority is given."""
    with database.write() as transaction:
        batch_id = ""
        if priority is not None:
            batch_id = transaction.batches.create(name="batch", priority=priority).id
        runs = [new_run(f"{{{number}}}") for number in range(count)]
        return transaction.jobs.submit(runs, batch_id=batch_id)


def register(database: Database) -> str:
    with database.write() as transaction:
        return transaction.workers.register()


def no_trace(run_id: str, attempt: int) -> str:
    """Returns the address of a trace that no worker writes."""
    del run_id, attempt
    return ""


def claim(database: Database, owner: str, limit: int) -> tuple[str, ...]:
    with database.write() as transaction:
        specs = transaction.queue.claim(owner, limit, trace_path=no_trace)
    return tuple(spec.run_id for spec in specs)


def finish(database: Database, owner: str, *ends: AttemptEnd) -> tuple[RunReport, ...]:
    with database.write() as transaction:
        return transaction.queue.finish(owner, ends, POLICY)


def ended(report: RunReport, signal: str = "") -> AttemptEnd:
    now = datetime.now(UTC)
    return AttemptEnd(report=report, worker="slot-0", started=now, ended=now, signal=signal)


def finished(
    run_id: str,
    *violated: str,
    trace: str = "",
    severity: Severity = Severity.MAJOR,
    avoidable: Answer | None = None,
    faults: tuple[bool, ...] = (True,),
) -> AttemptEnd:
    """The end of a run in which each oracle named was violated, once a fault, by another ego each.

    Args:
        run_id: The run.
        violated: The oracles.
        trace: Its hash.
        severity: Of each.
        avoidable: Of each.
        faults: Whether that was the ego's fault.
    """
    verdicts = [
        Verdict(oracle="arrival", ego="ego", outcome=Outcome.PASSED, message="arrived"),
        *(
            Verdict(
                oracle=o,
                ego=f"ego{number or ''}",
                outcome=Outcome.VIOLATED,
                message=o,
                severity=severity,
                at_fault=fault,
                avoidable=avoidable,
                time=1,
            )
            for o in violated
            for number, fault in enumerate(faults)
        ),
    ]
    return ended(
        RunReport(
            run_id=run_id,
            status=RunStatus.FINISHED,
            verdicts=tuple(verdicts),
            metrics={"speed": 3.0, "gap": None},
            trace_sha256=trace,
            steps=10,
        )
    )


def crashed(run_id: str) -> AttemptEnd:
    failure = RunFailure(cause="signal", message="died of SIGSEGV", log="last line")
    report = RunReport(run_id=run_id, status=RunStatus.SIMULATOR_CRASHED, failure=failure)
    return ended(report, signal="SIGSEGV")


def lost(run_id: str) -> AttemptEnd:
    failure = RunFailure(cause="worker_lost", message="gone")
    return ended(RunReport(run_id=run_id, status=RunStatus.INFRASTRUCTURE_FAILED, failure=failure))


@contextmanager
def statements(database: Database) -> Iterator[list[str]]:
    """Collects the statements that are sent to the database."""
    sent: list[str] = []

    def note(_: object, __: object, statement: str, *___: object) -> None:
        sent.append(statement)

    event.listen(database.engine, "before_cursor_execute", note)
    try:
        yield sent
    finally:
        event.remove(database.engine, "before_cursor_execute", note)
