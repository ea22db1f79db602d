"""The tables of runs and batches, of their reports and verdicts, and of the queue.

``runs`` is the status resource and the queue in one, and is kept narrow so that a million of them
stay fast to list; documents, reports and verdicts have tables of their own. A job and its run share
one row and one id. Leases are the attempts that have not ended; they last as long as their owner
(one server process) writes heartbeats.
"""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import (
    BigInteger,
    ForeignKey,
    Index,
    String,
    Text,
    text,
    true,
)
from sqlalchemy.orm import Mapped, mapped_column, relationship

from drivora_service.store.engine.base_tables import Base


class BatchRow(Base):
    """Runs that were submitted together; the unit of fairness and of pausing.

    ``queued`` counts its queued runs, ``served`` its share of the workers so far. The runs of a
    command are reserved for its own process, ``owner_id``; "" is for any server.
    """

    __tablename__ = "batches"
    __table_args__ = (
        Index(
            "ix_batches_claimable",
            "priority",
            "served",
            "seq",
            sqlite_where=text("queued > 0 AND state = 'open'"),
        ),
        Index(
            "ix_batches_owner",
            "owner_id",
            sqlite_where=text("owner_id != ''"),
        ),
        Index("ix_batches_priority", "priority", "seq"),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    priority: Mapped[int]
    state: Mapped[str] = mapped_column(String(16))
    created_at: Mapped[datetime]
    size: Mapped[int] = mapped_column(default=0)
    queued: Mapped[int] = mapped_column(default=0)
    served: Mapped[int] = mapped_column(default=0)
    owner_id: Mapped[str] = mapped_column(String(40), default="", server_default=text("''"))
    revision: Mapped[int] = mapped_column(default=0, server_default=text("0"), index=True)


class RunRow(Base):
    """One job and its run.

    ``revision`` is the count of changes at its newest one, see ``store.changes.revisions``: what
    changed since a revision is a range.
    ``facet`` is the number of its filter attributes, see ``store.runs.facets``.
    """

    __tablename__ = "runs"
    __table_args__ = (
        Index("ix_runs_facet", "facet", "seq"),
        Index("ix_runs_batch_facet", "batch_seq", "facet", "seq"),
        Index("ix_runs_document_facet", "document_sha256", "facet", "seq"),
        Index(
            "ix_runs_queued",
            "batch_seq",
            "seq",
            sqlite_where=text("status = 'queued'"),
        ),
        Index(
            "ix_runs_held",
            "not_before",
            "status",
            sqlite_where=text("not_before IS NOT NULL"),
        ),
        Index("ix_runs_ended", "ended_at", sqlite_where=text("ended_at IS NOT NULL")),
        Index(
            "ix_runs_to_cancel",
            "seq",
            sqlite_where=text("status = 'running' AND cancel_requested"),
        ),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    revision: Mapped[int] = mapped_column(index=True)
    batch_seq: Mapped[int] = mapped_column(ForeignKey("batches.seq"))
    item: Mapped[int]
    label: Mapped[str] = mapped_column(String(200))
    document_sha256: Mapped[str] = mapped_column(ForeignKey("documents.sha256"))
    town: Mapped[str] = mapped_column(String(100))
    agent: Mapped[str] = mapped_column(String(200))
    configuration: Mapped[str] = mapped_column(String(400), default="", server_default=text("''"))
    configuration_id: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    agent_override: Mapped[str] = mapped_column(String(200))
    seed_override: Mapped[int | None]
    definition: Mapped[str] = mapped_column(Text, default="", server_default=text("''"))
    feedback: Mapped[str | None] = mapped_column(Text)
    keeps_trace: Mapped[bool] = mapped_column(default=True, server_default=true())
    candidate: Mapped[str | None] = mapped_column(Text)
    status: Mapped[str] = mapped_column(String(24))
    cause: Mapped[str] = mapped_column(String(40), default="")
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    attempts: Mapped[int] = mapped_column(default=0)
    infrastructure_failures: Mapped[int] = mapped_column(default=0)
    crashes: Mapped[int] = mapped_column(default=0)
    interruptions: Mapped[int] = mapped_column(default=0)
    not_before: Mapped[datetime | None]
    violations: Mapped[int | None]
    at_fault_violations: Mapped[int | None]
    observations: Mapped[int | None]
    failures: Mapped[int | None]
    accountability: Mapped[str | None] = mapped_column(String(16))
    steps: Mapped[int | None]
    sim_time_s: Mapped[float | None]
    wall_time_s: Mapped[float | None]
    trace_sha256: Mapped[str] = mapped_column(String(64), default="")
    facet: Mapped[int] = mapped_column(BigInteger, default=0, server_default=text("0"))

    batch: Mapped[BatchRow] = relationship(lazy="raise")


class ReportRow(Base):
    """The whole report of a run as JSON; its primary key excludes a second one.

    ``candidate`` is what the genes of the run decode to, if it has any.
    """

    __tablename__ = "reports"

    run_seq: Mapped[int] = mapped_column(
        ForeignKey("runs.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    body: Mapped[str] = mapped_column(Text)
    candidate: Mapped[str | None] = mapped_column(Text)


class VerdictRow(Base):
    """A verdict that is violated or not measurable; those that passed are in the report only.

    The batch and the facet are those of its run, which has ended, so they do not change.
    """

    __tablename__ = "verdicts"
    __table_args__ = (
        Index("ix_verdicts_facet", "oracle", "outcome", "at_fault", "facet", "run_seq"),
        Index(
            "ix_verdicts_batch_facet",
            "batch_seq",
            "oracle",
            "outcome",
            "at_fault",
            "facet",
            "run_seq",
        ),
        Index("ix_verdicts_run_seq", "run_seq"),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    run_seq: Mapped[int] = mapped_column(ForeignKey("runs.seq", ondelete="CASCADE"))
    oracle: Mapped[str] = mapped_column(String(60))
    ego: Mapped[str] = mapped_column(String(200))
    outcome: Mapped[str] = mapped_column(String(16))
    severity: Mapped[str | None] = mapped_column(String(16))
    at_fault: Mapped[bool | None]
    accountability: Mapped[str | None] = mapped_column(String(16))
    time: Mapped[float | None]
    counterpart: Mapped[str] = mapped_column(String(200))
    batch_seq: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    facet: Mapped[int] = mapped_column(BigInteger, default=0, server_default=text("0"))


class OwnerRow(Base):
    """A server process that owns leases while it writes heartbeats."""

    __tablename__ = "owners"

    id: Mapped[str] = mapped_column(String(40), primary_key=True)
    host: Mapped[str] = mapped_column(String(200))
    pid: Mapped[int]
    started_at: Mapped[datetime]
    heartbeat_at: Mapped[datetime]
    ended_at: Mapped[datetime | None]


class AttemptRow(Base):
    """An attempt at a run; a lease until it has ended."""

    __tablename__ = "attempts"
    __table_args__ = (
        Index(
            "ix_attempts_leases",
            "owner_id",
            sqlite_where=text("ended_at IS NULL"),
        ),
    )

    run_seq: Mapped[int] = mapped_column(
        ForeignKey("runs.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    owner_id: Mapped[str] = mapped_column(ForeignKey("owners.id"))
    worker: Mapped[str] = mapped_column(String(100), default="")
    claimed_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    outcome: Mapped[str] = mapped_column(String(24), default="")
    cause: Mapped[str] = mapped_column(String(40), default="")
    signal: Mapped[str] = mapped_column(String(16), default="")
    log: Mapped[str] = mapped_column(Text, default="")


class SlotRow(Base):
    """The state of a worker slot at the last heartbeat of its owner."""

    __tablename__ = "slots"

    owner_id: Mapped[str] = mapped_column(
        ForeignKey("owners.id", ondelete="CASCADE"), primary_key=True
    )
    name: Mapped[str] = mapped_column(String(100), primary_key=True)
    pid: Mapped[int | None]
    run_id: Mapped[str] = mapped_column(String(40))
    phase: Mapped[str] = mapped_column(String(16))
    step: Mapped[int]
    memory_bytes: Mapped[int]
    runs: Mapped[int]
    restarts: Mapped[int]
    last_crash: Mapped[str] = mapped_column(Text)
    updated_at: Mapped[datetime]
    since: Mapped[datetime | None]
    last_crash_at: Mapped[datetime | None]


class QuarantineRow(Base):
    """A scenario that is known to crash the simulator."""

    __tablename__ = "quarantine"

    key: Mapped[str] = mapped_column(String(64), primary_key=True)
    document_sha256: Mapped[str] = mapped_column(String(64), index=True)
    run_id: Mapped[str] = mapped_column(String(40))
    cause: Mapped[str] = mapped_column(String(40))
    signal: Mapped[str] = mapped_column(String(16))
    message: Mapped[str] = mapped_column(Text)
    log: Mapped[str] = mapped_column(Text)
    created_at: Mapped[datetime]
