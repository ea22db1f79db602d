"""The tables of suites that were run and decided."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class SuiteRunRow(Base):
    """A suite that was run, with the decision of its gate.

    ``body`` is the rest of its record, as JSON.
    """

    __tablename__ = "suite_runs"
    __table_args__ = (Index("ix_suite_runs_suite", "suite", "seq"),)

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    suite: Mapped[str] = mapped_column(String(200))
    agent: Mapped[str] = mapped_column(String(200))
    configuration_id: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    created_at: Mapped[datetime]
    fails: Mapped[bool]
    scenarios: Mapped[int]
    passing: Mapped[int]
    body: Mapped[str] = mapped_column(Text)
    revision: Mapped[int] = mapped_column(default=0, index=True)


class SuiteOutcomeRow(Base):
    """What became of a scenario of a suite; ``failures`` are sentences, as JSON."""

    __tablename__ = "suite_outcomes"

    run_seq: Mapped[int] = mapped_column(
        ForeignKey("suite_runs.seq", ondelete="CASCADE"), primary_key=True
    )
    place: Mapped[int] = mapped_column(primary_key=True)
    scenario: Mapped[str] = mapped_column(String(400))
    state: Mapped[str] = mapped_column(String(24))
    failing: Mapped[int]
    judged: Mapped[int]
    score: Mapped[float | None]
    run_id: Mapped[str] = mapped_column(String(40))
    failures: Mapped[str] = mapped_column(Text)
