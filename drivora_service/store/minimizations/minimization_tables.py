"""The table of minimisations. Their runs are those of their batches."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import Index, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class MinimizationRow(Base):
    """A minimisation.

    ``document`` is the scenario that it begins with, ``progress`` what it has come to, both as
    JSON. The process ``owner_id`` works on it; "" is any service.
    """

    __tablename__ = "minimizations"
    __table_args__ = (
        Index("ix_minimizations_run", "run_id", "seq"),
        Index(
            "ix_minimizations_active",
            "owner_id",
            "seq",
            sqlite_where=text("state IN ('queued', 'running')"),
        ),
    )

    seq: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    run_id: Mapped[str] = mapped_column(String(40))
    batch_id: Mapped[str] = mapped_column(String(40))
    owner_id: Mapped[str] = mapped_column(String(40))
    state: Mapped[str] = mapped_column(String(16))
    message: Mapped[str] = mapped_column(Text, default="")
    failure: Mapped[str] = mapped_column(Text)
    budget: Mapped[int]
    document: Mapped[str] = mapped_column(Text)
    progress: Mapped[str] = mapped_column(Text)
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    revision: Mapped[int] = mapped_column(default=0, index=True)
