"""The tables of campaigns.

``evaluations`` is the journal from which a campaign is resumed: rows are only appended, in the
order of their numbers. Values that are listed, counted or filtered have columns; ``report`` is the
whole report.
"""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ColumnElement, ForeignKey, Index, String, Text, false, text
from sqlalchemy.orm import InstrumentedAttribute, Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class CampaignRow(Base):
    """A campaign; the counts are those of its evaluations."""

    __tablename__ = "campaigns"
    __table_args__ = (
        Index("ix_campaigns_state", "state", "seq"),
        Index("ix_campaigns_study", "study_id", "state", "seq"),
        Index("ix_campaigns_batch", "batch_id", sqlite_where=text("batch_id != ''")),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    document: Mapped[str] = mapped_column(Text)
    tester: Mapped[str] = mapped_column(String(64))
    agent: Mapped[str] = mapped_column(String(200))
    configuration: Mapped[str] = mapped_column(String(400), default="", server_default=text("''"))
    configuration_id: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    town: Mapped[str] = mapped_column(String(100))
    network_sha256: Mapped[str] = mapped_column(String(64))
    budget: Mapped[int]
    versions: Mapped[str] = mapped_column(Text)
    state: Mapped[str] = mapped_column(String(16))
    message: Mapped[str] = mapped_column(Text, default="")
    request: Mapped[str] = mapped_column(String(16), default="")
    batch_id: Mapped[str] = mapped_column(String(40), default="", server_default=text("''"))
    claim: Mapped[str] = mapped_column(String(40), default="", server_default=text("''"))
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    updated_at: Mapped[datetime]
    active_s: Mapped[float] = mapped_column(default=0.0)
    evaluations: Mapped[int] = mapped_column(default=0)
    judged: Mapped[int] = mapped_column(default=0)
    invalid: Mapped[int] = mapped_column(default=0)
    failed: Mapped[int] = mapped_column(default=0)
    violating: Mapped[int] = mapped_column(default=0)
    at_fault: Mapped[int] = mapped_column(default=0)
    avoidable: Mapped[int | None] = mapped_column(default=0)
    unavoidable: Mapped[int | None] = mapped_column(default=0)
    undetermined: Mapped[int | None] = mapped_column(default=0)
    preventable: Mapped[int | None] = mapped_column(default=0)
    agent_failed: Mapped[int | None] = mapped_column(default=0)
    not_at_fault: Mapped[int | None] = mapped_column(default=0)
    best: Mapped[str] = mapped_column(Text, default="{}", server_default="{}")
    study_id: Mapped[str] = mapped_column(String(40), default="", server_default=text("''"))
    study_scenario: Mapped[str] = mapped_column(String(100), default="", server_default=text("''"))
    study_agent: Mapped[str] = mapped_column(String(100), default="", server_default=text("''"))
    study_method: Mapped[str] = mapped_column(String(100), default="", server_default=text("''"))
    repetition: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    revision: Mapped[int] = mapped_column(default=0, server_default=text("0"), index=True)
    seed_runs: Mapped[str] = mapped_column(Text, default="[]", server_default="[]")


class StudyRow(Base):
    """A study; its campaigns name it, and have its progress."""

    __tablename__ = "studies"

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    document: Mapped[str] = mapped_column(Text)
    request: Mapped[str] = mapped_column(String(16), default="")
    created_at: Mapped[datetime]
    revision: Mapped[int] = mapped_column(default=0, server_default=text("0"), index=True)


class EvaluationRow(Base):
    """A candidate and its result."""

    __tablename__ = "evaluations"
    __table_args__ = (
        Index("ix_evaluations_document_sha256", "document_sha256"),
        Index(
            "ix_evaluations_violating",
            "campaign_seq",
            "number",
            sqlite_where=text("violations > 0"),
        ),
        Index("ix_evaluations_status", "campaign_seq", "status", "violating", "number"),
        Index(
            "ix_evaluations_generation",
            "campaign_seq",
            "generation",
            "status",
            "violating",
            "number",
        ),
    )

    campaign_seq: Mapped[int] = mapped_column(
        ForeignKey("campaigns.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    generation: Mapped[int]
    origin: Mapped[str] = mapped_column(String(60))
    parents: Mapped[str] = mapped_column(Text)
    genes: Mapped[str] = mapped_column(Text)
    status: Mapped[str] = mapped_column(String(16))
    document_sha256: Mapped[str | None] = mapped_column(ForeignKey("documents.sha256"))
    violations: Mapped[int]
    at_fault_violations: Mapped[int]
    accountability: Mapped[str | None] = mapped_column(String(16))
    sim_time_s: Mapped[float]
    wall_time_s: Mapped[float]
    search_s: Mapped[float]
    prepare_s: Mapped[float]
    asked_sha256: Mapped[str | None] = mapped_column(String(64))
    seed_number: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    redrawn: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    told_at: Mapped[datetime]
    report: Mapped[str] = mapped_column(Text)
    violating: Mapped[bool] = mapped_column(default=False, server_default=false())


class FailureRow(Base):
    """A violation that counts as a failure.

    The index covers all filters of lists, so that these read only the verdicts that they show.
    """

    __tablename__ = "failures"
    __table_args__ = (
        Index(
            "ix_failures_filters",
            "campaign_seq",
            "number",
            "place",
            "oracle",
            "kind",
            "at_fault",
            "accountability",
            "confirmation",
        ),
    )

    campaign_seq: Mapped[int] = mapped_column(
        ForeignKey("campaigns.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    place: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    oracle: Mapped[str] = mapped_column(String(60))
    kind: Mapped[str] = mapped_column(String(400))
    at_fault: Mapped[bool | None]
    accountability: Mapped[str | None] = mapped_column(String(16))
    confirmation: Mapped[str] = mapped_column(String(16))
    group: Mapped[int | None] = mapped_column("group_number")
    trace: Mapped[str] = mapped_column(Text, default="")
    verdict: Mapped[str] = mapped_column(Text)


class FailureKindRow(Base):
    """Counts of the failures of one kind; see ``campaign_records.FailureKind``."""

    __tablename__ = "failure_kinds"

    campaign_seq: Mapped[int] = mapped_column(
        ForeignKey("campaigns.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    kind: Mapped[str] = mapped_column(String(400), primary_key=True)
    failures: Mapped[int]
    violations: Mapped[int]
    at_fault: Mapped[int]
    avoidable: Mapped[int]
    confirmed: Mapped[int]
    flaky: Mapped[int]
    first: Mapped[int]
    groups: Mapped[int]


def is_campaign_of(batch_id: InstrumentedAttribute[str]) -> ColumnElement[bool]:
    """Returns the condition that a campaign is the one whose runs are in a batch."""
    # The second condition is that of the index.
    return (CampaignRow.batch_id == batch_id) & (CampaignRow.batch_id != "")
