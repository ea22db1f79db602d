"""The table of failures of all campaigns and batches."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String, text, true
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class FoundRow(Base):
    """A failure of a campaign, or a violation that counts of a run outside campaigns.

    Rows are narrow and in the order in which they were found, so that lists read them from their
    end whatever the filter. A failure of a campaign is named by campaign, number and place; a
    violation of a run by the run and the place of its verdict in the report.
    """

    __tablename__ = "found_failures"
    __table_args__ = (
        Index("ix_found_failures_campaign", "campaign_seq", "number", "place"),
        Index("ix_found_failures_run", "run_seq"),
        Index("ix_found_failures_group_seq", "group_seq"),
        # It has all columns of filters and of groups, so that these need no rows and no sorting.
        Index(
            "ix_found_failures_group",
            "group_name",
            "group_seq",
            "accountability",
            "campaign_seq",
            "town",
            "oracle",
            "agent",
            "at_fault",
            "confirmation",
            "batch_seq",
            "found_at",
            "configuration_id",
            "is_counted",
            "is_violation",
        ),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    found_at: Mapped[datetime]
    campaign_seq: Mapped[int | None] = mapped_column(
        ForeignKey("campaigns.seq", ondelete="CASCADE")
    )
    number: Mapped[int | None]
    run_seq: Mapped[int | None] = mapped_column(ForeignKey("runs.seq", ondelete="CASCADE"))
    batch_seq: Mapped[int | None]
    place: Mapped[int]
    oracle: Mapped[str] = mapped_column(String(60))
    group: Mapped[str] = mapped_column("group_name", String(400))
    group_seq: Mapped[int | None]
    """The group that a user has put it into, whatever its name; ``None``: that of its name."""
    agent: Mapped[str] = mapped_column(String(200))
    configuration: Mapped[str] = mapped_column(String(400), default="", server_default=text("''"))
    configuration_id: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    town: Mapped[str] = mapped_column(String(100))
    at_fault: Mapped[bool | None]
    accountability: Mapped[str | None] = mapped_column(String(16))
    is_counted: Mapped[bool] = mapped_column(default=True, server_default=true())
    """Whether the definition of its run, or of its campaign, counts it."""
    is_violation: Mapped[bool] = mapped_column(default=True, server_default=true())
    """Whether the default definition looks at it: no observation, and follows from nothing."""
    confirmation: Mapped[str] = mapped_column(String(16), default="", server_default=text("''"))
