"""The tables of what people have decided about groups of failures."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class FailureGroupRow(Base):
    """A group of failures about which a user has decided something.

    Failures are in the group of their name (``group_name`` in ``found_failures``), unless that name
    is in another group, or they themselves are. A group that was merged into another one keeps its
    row, so that its id still leads somewhere.
    """

    __tablename__ = "failure_groups"

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    label: Mapped[str] = mapped_column(String(200), default="")
    status: Mapped[str] = mapped_column(String(16))
    status_at: Mapped[datetime]
    assignee: Mapped[str] = mapped_column(String(100), default="")
    note: Mapped[str] = mapped_column(Text, default="")
    changed_at: Mapped[datetime]
    changed_by: Mapped[str] = mapped_column(String(250), default="")
    into_seq: Mapped[int | None] = mapped_column(
        ForeignKey("failure_groups.seq", ondelete="CASCADE"), index=True
    )
    revision: Mapped[int] = mapped_column(default=0, index=True)


class FailureGroupNameRow(Base):
    """A name of groups whose failures a user has put into another group."""

    __tablename__ = "failure_group_names"

    name: Mapped[str] = mapped_column(String(400), primary_key=True)
    group_seq: Mapped[int] = mapped_column(
        ForeignKey("failure_groups.seq", ondelete="CASCADE"), index=True
    )


class FailureGroupChangeRow(Base):
    """One change of a user's decisions about a group."""

    __tablename__ = "failure_group_changes"
    __table_args__ = (Index("ix_failure_group_changes_group", "group_seq", "seq"),)

    seq: Mapped[int] = mapped_column(primary_key=True)
    group_seq: Mapped[int] = mapped_column(ForeignKey("failure_groups.seq", ondelete="CASCADE"))
    changed_at: Mapped[datetime]
    changed_by: Mapped[str] = mapped_column(String(250))
    what: Mapped[str] = mapped_column(String(16))
    before: Mapped[str] = mapped_column(Text)
    after: Mapped[str] = mapped_column(Text)
